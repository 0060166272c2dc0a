//! Antialiased frames: each pixel is the share of its square that the disk covers.
//!
//! # Derivation
//! Over one pixel an edge is a straight line: where `g`, linear in the pixel's neighbourhood with the value and the
//! gradient that it has at the centre (see [`Patch`]), is 0. The share on one side of it is known in closed form, so
//! that a straight edge is drawn exactly, and rings thinner than a pixel keep their light. The disk is the union of its
//! orders' bands: where edges of several orders share a pixel its square is clipped at all of them.
//!
//! A pixel over which an edge bends, where the whole ring is some pixels across, is cut into four, and those again
//! where they must be: so are pixels that look at the hole.

use super::area::{share_beside, share_of_union};
use super::tiles::{Filler, fill_frame, is_straight};
use super::{RenderError, blank};
use crate::isoradial::{Bundle, Isoradials, Open, Patch, Uniform, Verdict};
use crate::scene::View;

/// What is not linear of the edges over a tile, in pixels, below which it is cut into rows: measured as the cheapest.
pub(super) const STRAIGHT_TILE: f64 = 0.4;

/// What is not linear of an edge over a pixel, in pixels, beyond which the pixel is cut up.
const STRAIGHT: f64 = 0.25;

/// How often a pixel is cut at most: into parts of a sixteenth of its side.
const CUTS: u32 = 4;

/// The frame's pixels, row by row from the top, on all threads of the current rayon pool.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let mut pixels = blank(view)?;
    render_into(view, curves, &mut pixels, view.width() as usize)?;
    Ok(pixels)
}

/// The frame, drawn into a caller's buffer: row j begins at `j stride`, whatever lies between the rows' ends is left
/// as it is. Nothing is allocated.
///
/// # Errors
/// [`RenderError::Buffer`] for a stride or a buffer that the frame does not fit.
pub fn render_into(
    view: &View,
    curves: &Isoradials,
    pixels: &mut [u8],
    stride: usize,
) -> Result<(), RenderError> {
    let shares = Shares { view, curves };
    let filler = Filler {
        view,
        curves,
        reach: 0.5,
        straight: STRAIGHT_TILE,
        pixel: |column: usize, row: usize, open: Option<&Open>| shares.value(column, row, open),
    };
    fill_frame(&filler, pixels, stride)
}

/// The same pixels, each found by itself.
///
/// # Errors
/// [`RenderError::Memory`]
pub fn render_every_pixel(view: &View, curves: &Isoradials) -> Result<Vec<u8>, RenderError> {
    let shares = Shares { view, curves };
    super::each_pixel(view, |column, row| shares.value(column, row, None))
}

/// What of a pixel is the disk.
struct Shares<'a> {
    view: &'a View,
    curves: &'a Isoradials,
}

impl Shares<'_> {
    /// The value of a pixel; `open` are edges among which are all that are open over it.
    fn value(&self, column: usize, row: usize, open: Option<&Open>) -> u8 {
        let (left, top) = (column as f64, row as f64);
        let share = self.share((left, left + 1.0), (top, top + 1.0), open, CUTS);
        (255.0 * share + 0.5) as u8
    }

    /// The share of a rectangle.
    fn share(&self, columns: (f64, f64), rows: (f64, f64), open: Option<&Open>, cuts: u32) -> f64 {
        let side = columns.1 - columns.0;
        let Some(patch) = Patch::new(self.view, self.curves, columns, rows) else {
            return if let Some(share) = self.share_of_both(columns, rows) {
                share
            } else if cuts == 0 {
                let middle = |(from, to): (f64, f64)| 0.5 * (from + to);
                f64::from(super::mask::sees(
                    self.view,
                    self.curves,
                    (middle(columns), middle(rows)),
                ))
            } else {
                self.quarters(columns, rows, None, cuts)
            };
        };
        let half = (0.5 * side, 0.5 * side);
        match self.curves.patched(&patch, half, open) {
            Err(Uniform::Hit) => 1.0,
            Err(Uniform::Miss) => 0.0,
            Ok(open) if is_straight(&open, half, STRAIGHT * side) => {
                share_of_union(open.bands(), side)
            }
            // Edges that bend this much may be far from their tangents, and show where no tile lets them.
            Ok(open) if cuts == 0 => {
                let bundle = Bundle::new(self.view, columns, rows);
                match bundle.map_or(Verdict::Mixed, |bundle| self.curves.verdict(&bundle)) {
                    Verdict::Hit => 1.0,
                    Verdict::Miss => 0.0,
                    Verdict::Mixed => share_of_union(open.bands(), side),
                }
            }
            Ok(open) => self.quarters(columns, rows, Some(&open), cuts),
        }
    }

    /// The share of a rectangle whose rays meet the plane in both quarter turns, which a straight line divides; if its
    /// edges are straight.
    fn share_of_both(&self, columns: (f64, f64), rows: (f64, f64)) -> Option<f64> {
        let side = columns.1 - columns.0;
        let half = (0.5 * side, 0.5 * side);
        let border = Patch::border(self.view, columns, rows);
        let mut share = 0.0;
        for (quarter, border) in [border, border.opposite()].into_iter().enumerate() {
            let patch = Patch::in_quarter(self.view, self.curves, columns, rows, quarter)?;
            share += match self.curves.patched(&patch, half, None) {
                Err(Uniform::Hit) => share_beside(&border, &[], side),
                Err(Uniform::Miss) => 0.0,
                Ok(open) if is_straight(&open, half, STRAIGHT * side) => {
                    share_beside(&border, open.bands(), side)
                }
                Ok(_) => return None,
            };
        }
        Some(share.min(1.0))
    }

    /// The share of a rectangle, from its four quarters'.
    fn quarters(
        &self,
        columns: (f64, f64),
        rows: (f64, f64),
        open: Option<&Open>,
        cuts: u32,
    ) -> f64 {
        let (column, row) = (0.5 * (columns.0 + columns.1), 0.5 * (rows.0 + rows.1));
        let mut sum = 0.0;
        for rows in [(rows.0, row), (row, rows.1)] {
            for columns in [(columns.0, column), (column, columns.1)] {
                sum += self.share(columns, rows, open, cuts - 1);
            }
        }
        0.25 * sum
    }
}
