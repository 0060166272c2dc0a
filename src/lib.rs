//! **darkness** renders what a black hole does to the light of its accretion disk: fast, and exactly.
//!
//! ```
//! use darkness::table::Spec;
//! use darkness::{Renderer, Scene, Table};
//!
//! // Every light ray there is, solved once. `save` keeps it in a file, `Table::open` maps that file.
//! let table = Table::generate(&Spec::standard())?;
//! let scene = Scene::builtin("classic")?.with_size(320, 180)?;
//! let picture = Renderer::new(&table).render(&scene)?; // an image::GrayImage
//! assert_eq!(picture.get_pixel(160, 90).0, [0]); // the shadow
//! assert_eq!(picture.get_pixel(160, 120).0, [255]); // the disk in front of it
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With light, in colour and as data:
//!
//! ```
//! use darkness::scene::{Layer, LayerSet};
//! use darkness::table::Spec;
//! use darkness::{Renderer, Scene, Table};
//!
//! # let table = Table::generate(&Spec::standard())?;
//! let scene = Scene::builtin("lit")?.with_size(320, 180)?;
//! let mut renderer = Renderer::new(&table);
//! let picture = renderer.render_rgb(&scene)?; // an image::RgbImage
//! assert!(picture.get_pixel(60, 95).0 > picture.get_pixel(260, 95).0); // what comes towards us is brighter
//!
//! let layers = LayerSet::default().with(Layer::Radius).with(Layer::Redshift);
//! let planes = renderer.render_layers(&scene, layers)?;
//! let (radius, redshift) = (planes[0].values[95 * 320 + 60], planes[1].values[95 * 320 + 60]);
//! assert!(radius > 3.0 && radius < 12.0 && redshift > 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Single rays, from where they start to the horizon or to infinity:
//!
//! ```
//! use darkness::table::Spec;
//! use darkness::{Ray, Table};
//!
//! # let table = Table::generate(&Spec::draft())?;
//! // From 30 Schwarzschild radii, past the hole at an impact parameter of 6.
//! for event in table.trace(Ray::from_impact_parameter(30.0, 6.0)?, &[12.0])? {
//!     println!("{:?} at r = {} after {} rad", event.kind, event.radius, event.angle);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it works
//! Around a hole without spin or charge a ray moves in a plane. With u = 1/r, and lengths in Schwarzschild radii, it
//! obeys `d²u/dφ² = 3/2 u² − u`.
//!
//! ```text
//! orbit equation ──solve once──▶ table ──at the camera's radius──▶ curves ──in this view──▶ pixels
//!     orbit                      table                             isoradial                render
//! ```
//!
//! # Where to find what
//! | module | what it holds |
//! |---|---|
//! | [`scene`] | [`Scene`]: camera, disk, picture; from TOML or from values; animations |
//! | [`table`] | [`Table`]: the swept angles of all rays, in a memory-mapped file |
//! | [`orbit`] | [`Ray`] and what happens to it: by elliptic integrals, by integration, by the table |
//! | [`isoradial`] | the curves in the picture at which the disk begins and ends, and the outline they make |
//! | [`light`] | redshift, flux, black bodies, colour: what a ray that meets the disk shows |
//! | [`sky`] | what is behind the hole: a panorama, stars, and a grid |
//! | [`render`] | [`Renderer`]: frames and batches of frames, as masks, in colour or as layers of data |
//! | `figure` | curves of constant radius, redshift and flux as Bézier paths (feature `figure`) |
//! | `chart` | speed against accuracy of every method, measured and drawn (feature `chart`) |
//! | `cli` | the program `darkness` (feature `cli`, on by default; with its window: feature `view`) |
//!
//! `default-features = false` builds the library without the program and its dependencies.
//!
//! Results are the same to the last bit on every machine, with any number of threads: the functions of `libm` stand in
//! for the system's, nothing is fused, and sums do not depend on the order of threads.

#[cfg(feature = "chart")]
pub mod chart;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "figure")]
pub mod figure;
pub mod isoradial;
pub mod light;
pub mod orbit;
pub mod output;
mod quotation;
pub mod render;
pub mod scene;
pub mod sky;
pub mod table;

pub use orbit::Ray;
pub use render::Renderer;
pub use scene::Scene;
pub use table::Table;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
