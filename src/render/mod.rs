//! Frames: which pixels see the disk.
//!
//! [`Renderer`] draws a scene in one call. The rest of this module is what it is made of, and the slower methods that
//! it is tested against:
//!
//! | module | what it does |
//! |---|---|
//! | [`needs`] | finds the smallest table and the fewest curves that a scene's tolerance allows |
//! | [`frame`] | draws a frame from isoradial curves, with smooth or hard edges |
//! | [`batch`] | draws many frames of an animation side by side |
//! | [`mask`], [`coverage`] | draw one frame from given curves, with hard and with smooth edges |
//! | [`pixelwise`] | draws a frame by following every pixel's ray, by any method |
//!
//! # How a frame is drawn
//! ```text
//! curves ──in this view──▶ path ──────────▶ cells ────────────▶ rows of pixels
//! isoradial/outline.rs     path.rs, arc.rs  cover.rs, cross.rs  frame.rs
//! ```
//!
//! The outline of the disk's image is a closed path of curves. It is projected into the picture as short cubics,
//! [arcs](self#arcs). For smooth edges each arc adds the area to its right to the pixels that it passes, and a sum
//! along each row gives every pixel's share of the disk. For hard edges each arc turns on the pixels whose centres lie
//! to its right; centres that are too near to an arc are asked one by one.
//!
//! # Parts of pictures
//! Where a scene names a part of its picture, all places are those of the whole picture and only memory is that of the
//! part ([`View::region`](crate::scene::View::region)). So the part has the whole picture's bytes: a mask draws the
//! whole picture's arcs into the cells of the part, and light and data are painted in the whole picture's tiles.
//!
//! # Arcs
//! `arc.rs` derives how far an arc may be off its edge, `path.rs` which parts of the outline are out of the picture,
//! `round.rs` how edges cross the seams of fisheyes and equirectangular pictures, `cells.rs` how areas add up.

mod arc;
mod banded;
pub mod batch;
mod cells;
mod centre;
mod cover;
pub mod coverage;
mod cross;
mod edge_map;
mod error;
mod flux_spline;
pub mod frame;
mod ink;
pub mod mask;
mod mixture;
pub mod needs;
#[cfg(feature = "figure")]
mod outline;
mod painter;
mod patch;
mod path;
pub mod pixelwise;
mod planes;
mod renderer;
mod round;
mod runs;
mod scene_frame;
mod section;
mod shaded;
mod shader;
mod shadow;
mod sky;
mod tiles;

pub use error::RenderError;
#[cfg(feature = "figure")]
pub use outline::disk_outline;
pub use planes::{Form, FrameMemory, Pixels, Plane};
pub use renderer::Renderer;
pub use scene_frame::FrameReport;

/// White: the disk.
pub const WHITE: u8 = 255;
