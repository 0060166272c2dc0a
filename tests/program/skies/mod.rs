//! Guards against a sky that some format, method or verb shows differently, and against files of a sky that a run reads
//! needlessly, does not tell of, or does not notice to have changed.
#![cfg(unix)]

mod files;
mod shown;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use exr::prelude::{Image as ExrImage, ReadChannels, ReadLayers};
use tempfile::{TempDir, tempdir};

use crate::harness::done;

/// A panorama without a disk, and an animation of a panorama, a catalogue and a grid behind a lit disk.
const STILL: &str = "[camera]\nposition = [20, 0, 4]\nfov = 50\n[sky]\npanorama = \"sky.png\"\n\
    [image]\nwidth = 96\nheight = 54\n";
const MOVING: &str = "[camera]\nfov = 50\n[disk]\ninner = 3\nouter = 7\n\
    [disk.light]\nmodel = \"blackbody\"\ntemperature = 7000\n\
    [sky]\npanorama = \"sky.png\"\nstars = \"stars.csv\"\nstar_exposure = -6\ngrid = 30\n\
    [image]\nwidth = 96\nheight = 54\n\
    [animation]\nframes = 6\norbit = { radius = 20.0, inclination = 75.0, azimuth = [0.0, 360.0] }\n";

/// Writes a smooth panorama of 128 × 64 pixels.
fn write_panorama(path: &Path, blue: u8) {
    let pixel = |x: u32, y: u32| {
        let wave = 127.5 + 120.0 * libm::sin(f64::from(x) * std::f64::consts::TAU / 128.0);
        image::Rgb([wave as u8, (4 * y) as u8, blue])
    };
    image::RgbImage::from_fn(128, 64, pixel).save(path).unwrap();
}

/// A folder with both scenes, the files of their skies, and a table.
fn with_skies() -> TempDir {
    let folder = tempdir().unwrap();
    let here = folder.path();
    fs::write(here.join("still.toml"), STILL).unwrap();
    fs::write(here.join("moving.toml"), MOVING).unwrap();
    write_panorama(&here.join("sky.png"), 40);
    let mut stars = String::from("ra,dec,magnitude,temperature\n");
    for i in 0..200_u8 {
        let degrees = f64::from(i);
        let (longitude, latitude) = (1.8 * degrees, 0.8 * degrees - 80.0);
        stars.push_str(
            &[longitude, latitude, f64::from(i % 5), 5800.0]
                .map(|x| x.to_string())
                .join(","),
        );
        stars.push('\n');
    }
    fs::write(here.join("stars.csv"), stars).unwrap();
    done(here, &["table", "standard"]);
    folder
}

/// The channels of an `OpenEXR` file, and its texts.
fn channels(path: &Path) -> (BTreeMap<String, Vec<f32>>, String) {
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level();
    let read = read.all_channels().first_valid_layer().all_attributes();
    let image: ExrImage<_> = read.from_file(path).unwrap();
    let texts = format!("{:?}", image.layer_data.attributes.other);
    let channels = image.layer_data.channel_data.list.into_iter();
    let channels = channels.map(|channel| {
        let values = channel.sample_data.values_as_f32().collect();
        (channel.name.to_string(), values)
    });
    (channels.collect(), texts)
}
