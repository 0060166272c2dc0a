//! The measured points as a CSV file.

use std::io::{self, Write};

use super::data::ChartData;
use super::machine::machine;

/// The column names.
const HEADER: &str =
    "panel,method,setting,ns_per_ray,ratio_to_rk4,error_p50,error_p99,error_max,failures,count";

/// Writes a comment line that starts with `#` and explains the numbers, the header, and one row per measured point.
/// Fields that were not measured are empty.
///
/// # Errors
/// Returns the errors of `out`.
pub fn write_csv(chart: &ChartData, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "# darkness {} on {}; ratio_to_rk4 = time of RK4 in steps of h={} (whose error_p99 in panel rays is 1e-6) / \
         time of this method, the median over interleaved rounds: above 1 is faster than RK4; \
         ns_per_ray = RK4's median time / ratio_to_rk4; errors in radians \
         (panel scene: in pixels; panel light: relative for redshifts, and the hottest ring's luminance is 1; in both \
         times per pixel)",
        env!("CARGO_PKG_VERSION"),
        machine(),
        chart.rays.baseline_step,
    )?;
    writeln!(out, "{HEADER}")?;
    for row in chart.measurements() {
        let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.4e}"));
        let (time, error) = (row.time, row.error);
        writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{}",
            row.panel,
            row.method,
            row.setting,
            number(time.map(|time| time.nanoseconds)),
            number(time.map(|time| time.ratio_to_rk4)),
            number(error.map(|error| error.p50)),
            number(error.map(|error| error.p99)),
            number(error.map(|error| error.max)),
            row.failures,
            row.count,
        )?;
    }
    Ok(())
}
