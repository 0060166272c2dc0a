//! Guards the sky: panoramas that are read wrongly or not refused, and filters that are wrong, uneven or have seams.

#[path = "../common/noise.rs"]
mod noise;

mod panorama_files;
mod panorama_filter;
