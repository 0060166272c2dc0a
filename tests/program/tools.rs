//! Programs that tests run beside this one.

use std::env;
use std::process::Command;

/// Whether a tool is there. One that is not is passed over, unless `DARKNESS_TOOLS` names it; the system's own folders are looked
/// through too.
pub(crate) fn has(tool: &str) -> bool {
    let path = env::var("PATH").unwrap_or_default();
    let found = Command::new("sh")
        .args(["-c", &format!("command -v {tool}")])
        .env("PATH", format!("{path}:/usr/sbin:/sbin"))
        .output();
    if found.is_ok_and(|found| found.status.success()) {
        return true;
    }
    let needed = env::var("DARKNESS_TOOLS").unwrap_or_default();
    let is_needed = needed.split_whitespace().any(|needed| needed == tool);
    assert!(!is_needed, "{tool} is not installed");
    eprintln!("{tool} is not installed: passed over");
    false
}
