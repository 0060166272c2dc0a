//! Frames: each pixel against its own exact ray, against reference pictures computed by other means, and against the
//! same picture drawn in another way.

#[path = "../common/natural.rs"]
mod natural;
#[path = "../common/noise.rs"]
mod noise;
#[path = "../common/process.rs"]
mod process;
#[path = "../common/quadrature.rs"]
mod quadrature;
#[path = "../common/tables.rs"]
mod tables;

#[path = "../program/tools.rs"]
mod tools;

mod any_scene;
mod drawn;
mod light_references;
mod lit;
mod methods;
mod shares;

mod batches;
mod coverage;
mod coverage_frames;
mod coverage_rings;
mod crops;
mod extreme_cameras;
mod figure;
mod grazing;
mod gyoto;
mod light;
mod light_average;
mod light_bytes;
mod light_layers;
mod light_map;
mod light_methods;
mod masks;
mod needs;
mod outline;
mod photon_rings;
mod projections;
mod renderer;
mod sky_directions;
mod sky_extremes;
mod sky_footprints;
mod sky_grid;
mod sky_panorama;
mod sky_stars;
mod sky_views;
mod symmetry;
mod without_disk;
mod zoomed_edges;
