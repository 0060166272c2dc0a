//! Other programs that tests run.

use std::env;
use std::process::Command;

/// Returns whether Python has a module, as [`has`] does for tools.
#[allow(
    dead_code,
    reason = "of the two test binaries that share this file one has modules"
)]
pub(crate) fn has_module(module: &str) -> bool {
    let imported = Command::new("python3")
        .args(["-c", &format!("import {module}")])
        .output();
    is_there(
        module,
        imported.is_ok_and(|imported| imported.status.success()),
    )
}

/// Returns whether a tool is installed, in the system's own folders too. Panics if it is not and `DARKNESS_TOOLS` names
/// it.
pub(crate) fn has(tool: &str) -> bool {
    let path = env::var("PATH").unwrap_or_default();
    let found = Command::new("sh")
        .args(["-c", &format!("command -v {tool}")])
        .env("PATH", format!("{path}:/usr/sbin:/sbin"))
        .output();
    is_there(tool, found.is_ok_and(|found| found.status.success()))
}

fn is_there(tool: &str, is_there: bool) -> bool {
    if is_there {
        return true;
    }
    let needed = env::var("DARKNESS_TOOLS").unwrap_or_default();
    let is_needed = needed.split_whitespace().any(|needed| needed == tool);
    assert!(!is_needed, "{tool} is not installed");
    eprintln!("{tool} is not installed: the test is skipped");
    false
}
