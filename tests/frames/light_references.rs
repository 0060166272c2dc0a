//! The references of `tests/reference/light`: what the centres of pixels see, in long double.

use core::f64::consts::TAU;
use std::path::{Path, PathBuf};

use darkness::light::Sight;
use darkness::scene::Scene;

/// The scenes of `tests/reference/light`.
pub(crate) const SCENES: [&str; 5] = [
    "camera-over-disk",
    "classic-80deg",
    "inside-photon-sphere",
    "rolled-tilted-disk",
    "telephoto-1e6",
];

/// What the centre of a pixel sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Seen {
    Disk(Sight),
    /// The direction in which its ray leaves.
    Sky([f64; 3]),
    Hole,
}

/// The pixels of one reference.
pub(crate) struct Reference {
    pub(crate) scene: Scene,
    pub(crate) rows: Vec<((u32, u32), Seen)>,
}

pub(crate) fn reference(name: &str) -> Reference {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/light");
    let read = |file: PathBuf| std::fs::read_to_string(file).expect("a reference file");
    let scene = Scene::from_toml(&read(folder.join(format!("{name}.toml")))).unwrap();
    let text = read(folder.join(format!("{name}.csv")));
    let rows = text.lines().skip(1).map(row).collect();
    Reference { scene, rows }
}

/// Reads `column,row,sees,order,radius,azimuth,redshift,emission_cosine,…`.
fn row(line: &str) -> ((u32, u32), Seen) {
    let fields: Vec<&str> = line.split(',').collect();
    let number = |k: usize| -> f64 { fields[k].parse().expect(line) };
    let seen = match fields[2] {
        "disk" => Seen::Disk(Sight {
            order: fields[3].parse().expect(line),
            u: 1.0 / number(4),
            azimuth: number(5),
            redshift: number(6),
            emission_cosine: number(7),
        }),
        "sky" => Seen::Sky([8, 9, 10].map(number)),
        "hole" => Seen::Hole,
        other => panic!("{other}: {line}"),
    };
    ((number(0) as u32, number(1) as u32), seen)
}

/// The largest errors of what a method says.
#[derive(Debug, Default)]
pub(crate) struct Worst {
    /// Relative.
    pub(crate) radius: f64,
    pub(crate) azimuth: f64,
    /// Relative.
    pub(crate) redshift: f64,
    pub(crate) cosine: f64,
    /// Of any of the four, in units of the last place of a float32; of an azimuth below 1, in those of 1.
    pub(crate) float32: f64,
}

impl Worst {
    pub(crate) fn add(&mut self, found: &Sight, known: &Sight) {
        let difference = (found.azimuth - known.azimuth).abs();
        let azimuth = difference.min(TAU - difference);
        self.radius = self.radius.max((found.u / known.u - 1.0).abs());
        self.azimuth = self.azimuth.max(azimuth);
        self.redshift = self
            .redshift
            .max((found.redshift / known.redshift - 1.0).abs());
        let cosine = (found.emission_cosine - known.emission_cosine).abs();
        self.cosine = self.cosine.max(cosine);
        let pairs = [
            (1.0 / found.u, 1.0 / known.u),
            (known.azimuth.max(1.0) + azimuth, known.azimuth.max(1.0)),
            (found.redshift, known.redshift),
            (found.emission_cosine, known.emission_cosine),
        ];
        for (found, known) in pairs {
            let known32 = known as f32;
            let unit = f64::from(known32.next_up() - known32);
            self.float32 = self.float32.max((found - known).abs() / unit);
        }
    }

    /// The largest of the four.
    pub(crate) fn greatest(&self) -> f64 {
        let shifts = self.radius.max(self.redshift);
        shifts.max(self.azimuth).max(self.cosine)
    }
}
