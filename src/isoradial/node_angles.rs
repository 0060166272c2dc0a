//! The orbit angles of a quarter turn's nodes.

use super::quarter_turn::x_at;

/// The angles of one quarter turn's nodes from its start, for each number of cells. All orders and both edges share
/// them.
#[derive(Debug)]
pub(super) struct NodeAngles {
    x: (f64, f64),
    /// The angles for the fewest cells, for twice as many, and so on.
    levels: Vec<Vec<f64>>,
}

impl NodeAngles {
    /// Creates the angles of nodes between two x.
    ///
    /// Nodes need a distance, but a camera on the disk's axis meets the plane at one angle only. So the two x are moved
    /// apart until they are `2e-6` from each other.
    pub(super) fn new(x: (f64, f64)) -> Self {
        const CLOSEST: f64 = 1e-6;
        let middle = (0.5 * (x.0 + x.1)).clamp(CLOSEST, 1.0 - CLOSEST);
        Self {
            x: (x.0.min(middle - CLOSEST), x.1.max(middle + CLOSEST)),
            levels: Vec::new(),
        }
    }

    /// Returns the least and the greatest x.
    pub(super) fn x(&self) -> (f64, f64) {
        self.x
    }

    /// Returns the angles of the nodes of so many cells. The first call sets the fewest cells; later calls ask for
    /// doublings of it.
    pub(super) fn nodes(&mut self, cells: usize) -> &[f64] {
        let fewest = self.levels.first().map_or(cells, |level| level.len() - 1);
        let index = (cells / fewest).trailing_zeros() as usize;
        while self.levels.len() <= index {
            let cells = fewest << self.levels.len();
            let coarser = self.levels.last();
            let angle = |i: usize| match coarser {
                Some(coarser) if i.is_multiple_of(2) => coarser[i / 2],
                _ => self.angle(i, cells),
            };
            let next = (0..=cells).map(angle).collect();
            self.levels.push(next);
        }
        &self.levels[index]
    }

    /// Returns the angle of node i, from `tan(φ − start) = x/(1 − x)`.
    fn angle(&self, i: usize, cells: usize) -> f64 {
        let x = x_at(self.x, i as f64 / cells as f64);
        libm::atan2(x, 1.0 - x)
    }
}
