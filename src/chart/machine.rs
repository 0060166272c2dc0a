//! The machine on which times are measured.

use std::fs;

/// Returns the processor's name and the number of cores available to this program, without commas.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let plural = if cores == 1 { "" } else { "s" };
    format!("{} ({cores} core{plural})", processor())
}

/// Returns the processor's model if `/proc/cpuinfo` names it, else the architecture.
fn processor() -> String {
    let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model(&cpuinfo).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo
        .lines()
        .find(|line| line.starts_with("model name"))?;
    let (_, name) = line.split_once(':')?;
    let name = name.replace([',', '"'], " ");
    let words: Vec<_> = name.split_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_is_read_from_cpuinfo() {
        let cpuinfo = "processor\t: 0\nmodel name\t: Some CPU,  v2 @ 2 GHz\nflags\t: fpu\n";
        assert_eq!(model(cpuinfo).as_deref(), Some("Some CPU v2 @ 2 GHz"));
        assert_eq!(model("processor : 0\n"), None);
        assert_eq!(model("model name : \n"), None);
    }
}
