//! Every measured point as a row of CSV.

use std::io::{self, Write};

use super::{Chart, machine};

/// The columns.
const HEADER: &str =
    "panel,method,setting,ns_per_ray,ratio_to_rk4,error_p50,error_p99,error_max,failures,count";

/// Writes the chart: a line that begins with `#` and says what the numbers mean, the header, a row for each point. A
/// field is empty where nothing was measured.
///
/// # Errors
/// What `out` returns.
pub fn write_csv(chart: &Chart, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "# darkness {} on {}; ratio_to_rk4 = time of RK4 in steps of h={} (whose error_p99 in panel rays is 1e-6) / time of this method, taken in each of the interleaved rounds, their median: above 1 is faster than RK4; errors in radians (panel scene: in pixels, times per pixel)",
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
