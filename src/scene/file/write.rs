//! Writes a scene's TOML form.

use std::fmt;

use super::{
    AnimationTable, CameraTable, DiskTable, Fov, FromTo, ImageTable, Interpolation, OrbitTable,
    Place, SceneFile, line, sky,
};
use crate::scene::checked::Scene;
use crate::scene::projection::Projection;
use crate::scene::values::{Light, Tone};

impl From<&Scene> for SceneFile {
    fn from(scene: &Scene) -> Self {
        let camera = scene.camera();
        Self {
            camera: CameraTable {
                place: Some(Place::Position(camera.position.to_array())),
                focus: camera.focus.to_array(),
                up: Some(camera.up.to_array()),
                roll: 0.0,
                projection: camera.projection,
                fov: Fov::Vertical(camera.fov_degrees),
            },
            disk: scene.disk().map(|disk| DiskTable {
                inner: disk.inner,
                outer: disk.outer,
                normal: disk.normal.to_array(),
                light: scene.light(),
            }),
            image: ImageTable {
                width: i64::from(scene.image().width),
                height: i64::from(scene.image().height),
                antialias: scene.antialias(),
                tolerance: scene.tolerance(),
                exposure: scene.exposure(),
                tone: scene.tone(),
                bits: i64::from(scene.bits()),
                layers: scene.layers(),
                crop: scene
                    .crop()
                    .map(|part| [part.left, part.top, part.width, part.height].map(i64::from)),
            },
            sky: scene.shared_sky().cloned(),
            animation: None,
        }
    }
}

/// The TOML text. It is written by hand because pictures carry its checksum: no version of a serialiser may change it.
/// `{:?}` of a finite f64 is valid TOML, and the shortest decimal that reads back to the same bits.
impl fmt::Display for SceneFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            camera,
            disk,
            image,
            sky,
            animation,
        } = self;
        write!(f, "{camera}")?;
        if let Some(disk) = disk {
            write!(f, "\n{disk}")?;
        }
        if let Some(sky) = sky {
            sky::write(f, sky)?;
        }
        writeln!(f, "\n[image]")?;
        writeln!(f, "width = {}", image.width)?;
        writeln!(f, "height = {}", image.height)?;
        writeln!(f, "antialias = {}", image.antialias)?;
        writeln!(f, "tolerance = {:?}", image.tolerance)?;
        // Keys that came later are left out at their defaults: the checksums of older scenes stay.
        if image.exposure.to_bits() != 0 {
            writeln!(f, "exposure = {:?}", image.exposure)?;
        }
        if image.tone == Tone::None {
            writeln!(f, "tone = \"none\"")?;
        }
        if image.bits != 8 {
            writeln!(f, "bits = {}", image.bits)?;
        }
        if !image.layers.is_empty() {
            writeln!(f, "layers = {}", image.layers)?;
        }
        line(f, "crop", image.crop)?;
        animation
            .as_ref()
            .map_or(Ok(()), |animation| write!(f, "\n{animation}"))
    }
}

impl fmt::Display for CameraTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[camera]")?;
        match self.place {
            Some(Place::Position(position)) => writeln!(f, "position = {position:?}")?,
            Some(Place::Angles {
                radius,
                inclination,
                azimuth,
            }) => writeln!(
                f,
                "radius = {radius:?}\ninclination = {inclination:?}\nazimuth = {azimuth:?}"
            )?,
            None => {}
        }
        writeln!(f, "focus = {:?}", self.focus)?;
        line(f, "up", self.up)?;
        if self.roll != 0.0 {
            writeln!(f, "roll = {:?}", self.roll)?;
        }
        // Left out at its default, as is what has no place beside another one.
        if self.projection != Projection::Perspective {
            writeln!(f, "projection = {:?}", self.projection.name())?;
        }
        if self.projection == Projection::Equirectangular {
            return Ok(());
        }
        match self.fov {
            Fov::Vertical(degrees) => writeln!(f, "fov = {degrees:?}"),
            Fov::Horizontal(degrees) => writeln!(f, "fov_horizontal = {degrees:?}"),
        }
    }
}

impl fmt::Display for DiskTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[disk]")?;
        writeln!(f, "inner = {:?}", self.inner)?;
        writeln!(f, "outer = {:?}", self.outer)?;
        writeln!(f, "normal = {:?}", self.normal)?;
        match self.light {
            Some(Light::BlackBody { temperature }) => {
                writeln!(
                    f,
                    "\n[disk.light]\nmodel = \"blackbody\"\ntemperature = {temperature:?}"
                )
            }
            Some(Light::Bolometric) => writeln!(f, "\n[disk.light]\nmodel = \"bolometric\""),
            None => Ok(()),
        }
    }
}

impl fmt::Display for FromTo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.from == self.to {
            write!(f, "{:?}", self.from)
        } else {
            write!(f, "[{:?}, {:?}]", self.from, self.to)
        }
    }
}

impl fmt::Display for AnimationTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "[animation]")?;
        writeln!(f, "frames = {}", self.frames)?;
        // Left out at its default, as later keys of the picture are.
        if self.first != 1 {
            writeln!(f, "first = {}", self.first)?;
        }
        writeln!(f, "fps = {:?}", self.fps)?;
        let interpolation = match self.interpolation {
            Interpolation::Smooth => "smooth",
            Interpolation::Linear => "linear",
        };
        writeln!(f, "interpolation = \"{interpolation}\"")?;
        if let Some(orbit) = &self.orbit {
            let OrbitTable {
                radius,
                inclination,
                azimuth,
            } = orbit;
            writeln!(
                f,
                "orbit = {{ radius = {radius}, inclination = {inclination}, azimuth = {azimuth} }}"
            )?;
        }
        for keyframe in &self.keyframe {
            writeln!(f, "\n[[animation.keyframe]]")?;
            writeln!(f, "frame = {}", keyframe.frame)?;
            line(f, "position", keyframe.position)?;
            line(f, "focus", keyframe.focus)?;
            line(f, "up", keyframe.up)?;
            line(f, "fov", keyframe.fov)?;
            line(f, "normal", keyframe.normal)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::layers::{Layer, LayerSet};

    const OLDEST: &str = "[camera]\nposition = [20.0, 0.0, 5.0]\nfocus = [0.0, 0.0, 0.0]\n\
        up = [0.0, 0.0, 1.0]\nfov = 40.0\n\
        \n[disk]\ninner = 3.0\nouter = 12.0\nnormal = [0.0, 0.0, 1.0]\n\n\
        [image]\nwidth = 64\nheight = 36\nantialias = true\ntolerance = 0.001\n";

    #[test]
    fn written_toml_reads_back_to_the_same_bits() {
        let mut file = SceneFile::parse(OLDEST).unwrap();
        file.camera.place = Some(Place::Position([0.1 + 0.2, -1e-300, 123_456_789_012_345.0]));
        file.camera.up = Some([5e-324, f64::MAX, -0.0]);
        file.camera.fov = Fov::Vertical(1e-9);
        file.image.exposure = -0.0;
        file.image.tone = Tone::None;
        file.image.bits = 16;
        file.image.layers = LayerSet::from_iter(Layer::NAMED);
        for light in [
            Light::BlackBody {
                temperature: 0.1 + 0.2,
            },
            Light::Bolometric,
        ] {
            file.disk.as_mut().unwrap().light = Some(light);
            let back = SceneFile::parse(&file.to_string()).unwrap();
            assert_eq!(back, file);
            assert!(back.camera.up.is_some_and(|up| up[2].is_sign_negative()));
            assert!(back.image.exposure.is_sign_negative());
        }
    }

    /// Guards against a key that changes the checksum of scenes that do not use it.
    #[test]
    fn keys_that_came_later_are_left_out_at_their_defaults() {
        assert_eq!(SceneFile::parse(OLDEST).unwrap().to_string(), OLDEST);
        let defaults = format!("{OLDEST}exposure = 0\ntone = \"neutral\"\nbits = 8\nlayers = []\n");
        assert_eq!(SceneFile::parse(&defaults).unwrap().to_string(), OLDEST);
        let lit = OLDEST.replace(
            "\n[image]",
            "\n[disk.light]\nmodel = \"blackbody\"\ntemperature = 7000.0\n\n[image]",
        ) + "exposure = -1.5\ntone = \"none\"\nbits = 16\nlayers = [\"radius\", \"colour\"]\n";
        assert_eq!(SceneFile::parse(&lit).unwrap().to_string(), lit);
    }
}
