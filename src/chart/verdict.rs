//! The chart's verdict in one sentence: how long the table takes on this machine for frames that are right, and how
//! long RK4 takes.

use super::data::ChartData;
use super::light::LitFrame;
use super::measurement::ComparedMethod;
use super::number_format::two_significant;

/// The largest relative error of a redshift that is right.
const REDSHIFT: f64 = 1e-6;

/// The verdict's two parts: on edges, and on colours. Joined by a space they are one sentence.
pub(super) fn verdict(chart: &ChartData) -> [String; 2] {
    let (scene, light) = (&chart.scene, &chart.light);
    let edges = scene.points.iter().filter_map(|point| {
        let is_right = point.displacement() <= scene.tolerance;
        is_right.then_some((point.method, point.milliseconds))
    });
    let colours = light.points.iter().filter_map(|point| {
        let error = point.redshift.error?.max;
        // The table's frame is drawn as the first one of a film is.
        let is_told = point.frame == LitFrame::NewRadius || point.method == ComparedMethod::Rk4;
        (is_told && error <= REDSHIFT).then_some((point.method, point.milliseconds))
    });
    let [edges, colours] = [edges.collect::<Vec<_>>(), colours.collect()].map(|right| race(&right));
    [
        format!(
            "{} at {} × {} on one thread: edges right to {:?} pixels: {edges};",
            scene.name, scene.size.0, scene.size.1, scene.tolerance
        ),
        format!("in colour, redshifts right to {REDSHIFT:e}: {colours}."),
    ]
}

/// Compares the fastest frame by a table and by RK4 among those that are right.
fn race(right: &[(ComparedMethod, f64)]) -> String {
    let fastest = |is_of: fn(ComparedMethod) -> bool| {
        let of = right.iter().filter(|(method, _)| is_of(*method));
        of.map(|(_, time)| *time).min_by(f64::total_cmp)
    };
    let table = fastest(|method| {
        matches!(
            method,
            ComparedMethod::TableDraft | ComparedMethod::TableStandard | ComparedMethod::TableFine
        )
    });
    let rk4 = fastest(|method| method == ComparedMethod::Rk4);
    match (table, rk4) {
        (Some(table), Some(rk4)) => {
            let (times, table, rk4) =
                (two_significant(rk4 / table), duration(table), duration(rk4));
            format!("table {table}, RK4 {rk4}, {times} ×")
        }
        (Some(table), None) => format!("table {}, RK4 at no step tried", duration(table)),
        (None, Some(rk4)) => format!("no table, RK4 {}", duration(rk4)),
        (None, None) => "neither a table nor RK4".to_owned(),
    }
}

/// Formats a time with two significant digits.
fn duration(milliseconds: f64) -> String {
    if milliseconds < 1000.0 {
        format!("{} ms", two_significant(milliseconds))
    } else {
        format!("{} s", two_significant(milliseconds / 1000.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_right_frames_are_told() {
        use ComparedMethod::{Adaptive, Rk4, TableDraft, TableFine};
        let both = [
            (Rk4, 9000.0),
            (TableFine, 3.0),
            (Rk4, 5000.0),
            (TableDraft, 1.13),
        ];
        assert_eq!(race(&both), "table 1.1 ms, RK4 5.0 s, 4,400 ×");
        assert_eq!(
            race(&[(TableFine, 12.3), (Adaptive, 1.0)]),
            "table 12 ms, RK4 at no step tried"
        );
        assert_eq!(race(&[(Rk4, 250.0)]), "no table, RK4 250 ms");
        assert_eq!(race(&[]), "neither a table nor RK4");
    }
}
