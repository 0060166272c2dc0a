//! Bounds over runs of cells: those of each cell, of each two neighbours, of each four, so that any run is two of them.

/// Least and greatest values over runs of neighbouring cells.
#[derive(Debug, Clone)]
pub(super) struct Runs {
    /// For runs of `2^k` cells, one after the other for k = 0, 1, …: from each cell on that is followed by so many.
    bounds: Vec<(f64, f64)>,
    cells: usize,
}

impl Runs {
    /// From the bounds of each cell.
    pub(super) fn new(cells: impl ExactSizeIterator<Item = (f64, f64)>) -> Self {
        let count = cells.len();
        let levels = count
            .checked_ilog2()
            .map_or(0, |levels| levels as usize + 1);
        let mut bounds = Vec::with_capacity(count * levels);
        bounds.extend(cells);
        let mut start = 0;
        for level in 1..levels {
            let (runs, half) = (count + 1 - (1 << level), 1 << (level - 1));
            for i in start..start + runs {
                bounds.push(both(bounds[i], bounds[i + half]));
            }
            start += count + 1 - half;
        }
        Self {
            bounds,
            cells: count,
        }
    }

    /// The bounds of the cells from `first` to `last`.
    pub(super) fn over(&self, first: usize, last: usize) -> (f64, f64) {
        let level = (last + 1 - first).ilog2();
        // Σ (cells + 1 − 2^k) over the levels before.
        let start = level as usize * (self.cells + 1) - ((1 << level) - 1);
        both(
            self.bounds[start + first],
            self.bounds[start + last + 1 - (1 << level)],
        )
    }
}

fn both(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_their_cells() {
        let cells: Vec<(f64, f64)> = (0..37)
            .map(|i| {
                (
                    libm::sin(f64::from(i * i)),
                    2.0 + libm::cos(f64::from(i * i)),
                )
            })
            .collect();
        for count in [1, 2, 3, 4, 31, 32, 37] {
            let runs = Runs::new(cells[..count].iter().copied());
            for first in 0..count {
                for last in first..count {
                    let truth = cells[first..=last].iter().copied().reduce(both).unwrap();
                    assert_eq!(
                        runs.over(first, last),
                        truth,
                        "{first} to {last} of {count}"
                    );
                }
            }
        }
    }
}
