//! What the times were taken on.

use std::fs;

/// The processor and how many cores there are for this program, in words without commas.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let plural = if cores == 1 { "" } else { "s" };
    format!("{} ({cores} core{plural})", processor())
}

/// The processor's model where the system tells it, else its architecture.
fn processor() -> String {
    let told = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    model(&told).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
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
    fn the_model_is_read_where_it_is_told() {
        let told = "processor\t: 0\nmodel name\t: Some CPU,  v2 @ 2 GHz\nflags\t: fpu\n";
        assert_eq!(model(told).as_deref(), Some("Some CPU v2 @ 2 GHz"));
        assert_eq!(model("processor : 0\n"), None);
        assert_eq!(model("model name : \n"), None);
    }
}
