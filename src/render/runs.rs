//! Pixels of a band as runs along its rows, sorted by rows and columns.

use super::tiles::Run;

/// Keeps of runs what is within the columns of each row: beyond the rim of a fisheye is nothing.
pub(super) fn keep(runs: &mut Vec<Run>, columns: impl Fn(usize) -> (usize, usize)) {
    runs.retain_mut(|run| {
        let (from, to) = columns(run.row as usize);
        (run.from, run.to) = (run.from.max(from as u32), run.to.min(to as u32));
        run.from < run.to
    });
}

/// Collects the pixels of rows that are in no run; runs are sorted and do not overlap.
pub(super) fn complement(runs: &[Run], (width, rows): (u32, u32), rest: &mut Vec<Run>) {
    rest.clear();
    let mut runs = runs.iter().peekable();
    for row in 0..rows {
        let mut from = 0;
        while let Some(run) = runs.next_if(|run| run.row == row) {
            if run.from > from {
                let to = run.from;
                rest.push(Run { row, from, to });
            }
            from = from.max(run.to);
        }
        if from < width {
            let to = width;
            rest.push(Run { row, from, to });
        }
    }
}

/// Collects the pixels of runs that are not among others; both are sorted.
pub(super) fn without(runs: &[Run], others: &[Run], rest: &mut Vec<Run>) {
    rest.clear();
    let mut others = others.iter().peekable();
    for &Run { row, mut from, to } in runs {
        while let Some(other) = others.next_if(|other| (other.row, other.from) < (row, to)) {
            if other.row == row && other.to > from {
                if other.from > from {
                    let to = other.from;
                    rest.push(Run { row, from, to });
                }
                from = other.to;
            }
        }
        if from < to {
            rest.push(Run { row, from, to });
        }
    }
}

/// Collects the runs of one order in a row.
pub(super) fn runs_of(orders: &[u8], order: u8, row: usize, runs: &mut Vec<Run>) {
    let mut column = 0;
    while let Some(from) = orders[column..].iter().position(|&o| o == order) {
        let from = column + from;
        let length = orders[from..].iter().position(|&o| o != order);
        let to = length.map_or(orders.len(), |length| from + length);
        runs.push(Run {
            row: row as u32,
            from: from as u32,
            to: to as u32,
        });
        column = to;
    }
}
