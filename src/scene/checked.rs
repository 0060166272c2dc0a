//! A scene whose values are checked.

use std::sync::Arc;

use super::error::SceneError;
use super::layers::LayerSet;
use super::sky::Sky;
use super::validate;
use super::values::{
    Camera, DEFAULT_TOLERANCE, Disk, ImageSettings, ImageSize, Light, Region, Tone,
};
use super::vector::norm;

/// A checked scene: nothing that takes one needs to check it again.
///
/// ```
/// use darkness::scene::{Camera, Disk, ImageSize, Scene};
///
/// let camera = Camera::at([20.0, 0.0, 5.0], 40.0);
/// let size = ImageSize { width: 640, height: 360 };
/// let scene = Scene::new(camera, Disk::new(3.0, 12.0), size)?;
///
/// // The same from TOML.
/// let text = "[camera]\nposition = [20, 0, 5]\nfov = 40\n\
///             [disk]\ninner = 3\nouter = 12\n\
///             [image]\nwidth = 640\nheight = 360\n";
/// assert_eq!(Scene::from_toml(text)?, scene);
///
/// let error = Scene::new(camera, Disk::new(2.0, 12.0), size).unwrap_err();
/// assert!(error.to_string().starts_with("disk.inner = 2.0: no stable circular orbit exists"));
/// # Ok::<(), darkness::scene::SceneError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    camera: Camera,
    radius: f64,
    disk: Option<Disk>,
    light: Option<Light>,
    sky: Option<Arc<Sky>>,
    settings: ImageSettings,
}

impl Scene {
    /// Checks a scene that is built from values. Its edges are smooth ([`Self::with_antialias`]) and right to
    /// [`DEFAULT_TOLERANCE`] ([`Self::with_tolerance`]).
    ///
    /// # Errors
    /// [`SceneError::Value`] for the first value that is not allowed.
    pub fn new(camera: Camera, disk: Disk, image: ImageSize) -> Result<Self, SceneError> {
        let (width, height) = (i64::from(image.width), i64::from(image.height));
        let settings = validate::image(width, height, true, DEFAULT_TOLERANCE)?;
        Self::at_radius(
            camera,
            norm(camera.position),
            Some(disk),
            None,
            None,
            settings,
        )
    }

    /// Checks a scene that shows only a sky. Its edges are those of [`Self::new`].
    ///
    /// # Errors
    /// [`SceneError::Value`] for the first value that is not allowed.
    pub fn without_disk(camera: Camera, sky: Sky, image: ImageSize) -> Result<Self, SceneError> {
        validate::sky(&sky)?;
        let (width, height) = (i64::from(image.width), i64::from(image.height));
        let settings = validate::image(width, height, true, DEFAULT_TOLERANCE)?;
        let sky = Some(Arc::new(sky));
        Self::at_radius(camera, norm(camera.position), None, None, sky, settings)
    }

    /// The scene of a camera whose position has the length `radius`, up to the rounding of the position's components.
    ///
    /// # Errors
    /// [`SceneError::Value`] for the first value that is not allowed.
    pub(super) fn at_radius(
        camera: Camera,
        radius: f64,
        disk: Option<Disk>,
        light: Option<Light>,
        sky: Option<Arc<Sky>>,
        settings: ImageSettings,
    ) -> Result<Self, SceneError> {
        validate::scene(&camera, radius, disk.as_ref(), settings.size)?;
        Ok(Self {
            camera,
            radius,
            disk,
            light,
            sky,
            settings,
        })
    }

    /// The same scene from another camera.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a camera that is not allowed.
    pub fn with_camera(self, camera: Camera) -> Result<Self, SceneError> {
        let (radius, settings) = (norm(camera.position), self.settings);
        Self::at_radius(camera, radius, self.disk, self.light, self.sky, settings)
    }

    /// The same scene, its camera turned about its viewing direction by so many degrees; by 0, to the last bit.
    pub(super) fn rolled(mut self, degrees: f64) -> Self {
        if degrees != 0.0 {
            self.camera = self.camera.rolled(degrees);
        }
        self
    }

    /// The same scene as a picture of another size; the vertical field of view stays, and so does the part that is
    /// drawn.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a size that is not allowed (an equirectangular picture is twice as wide as high), and
    /// for one that does not have the part that is drawn.
    pub fn with_size(mut self, width: u32, height: u32) -> Result<Self, SceneError> {
        let size = validate::image_size(i64::from(width), i64::from(height))?;
        validate::shape(self.camera.projection, size)?;
        self.settings.size = size;
        let crop = self.settings.crop;
        self.with_crop(crop)
    }

    /// The same scene of which only a part of the picture is drawn, or all of it (`None`).
    ///
    /// # Errors
    /// [`SceneError::Value`] for a part without pixels, and for one that reaches beyond the picture.
    pub fn with_crop(mut self, crop: Option<Region>) -> Result<Self, SceneError> {
        if let Some(part) = crop {
            let numbers = [part.left, part.top, part.width, part.height].map(i64::from);
            validate::crop(numbers, self.settings.size)?;
        }
        self.settings.crop = crop;
        Ok(self)
    }

    /// The same scene with its edges right to `pixels`.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a tolerance that is not allowed.
    pub fn with_tolerance(mut self, pixels: f64) -> Result<Self, SceneError> {
        validate::tolerance(pixels)?;
        self.settings.tolerance = pixels;
        Ok(self)
    }

    /// The same scene with smooth edges, or with hard ones.
    #[must_use]
    pub fn with_antialias(mut self, antialias: bool) -> Self {
        self.settings.antialias = antialias;
        self
    }

    /// The same scene with a shining disk, or with one that only covers (`None`).
    ///
    /// # Errors
    /// [`SceneError::Value`] for a temperature that is not allowed, for the light of a scene without a disk, and for a
    /// disk that no longer has the light of one of the scene's layers.
    pub fn with_light(mut self, light: Option<Light>) -> Result<Self, SceneError> {
        validate::light(light, self.disk.is_some())?;
        validate::layers(self.settings.layers, light, self.sky.is_some())?;
        self.light = light;
        Ok(self)
    }

    /// The same scene with another sky, or without one (`None`).
    ///
    /// # Errors
    /// [`SceneError::Value`] for a value of the sky that is not allowed, and for the layer of colour in a scene that
    /// would no longer show any; [`SceneError::Empty`] for a scene that would have neither disk nor sky.
    pub fn with_sky(mut self, sky: Option<Sky>) -> Result<Self, SceneError> {
        match &sky {
            Some(sky) => validate::sky(sky)?,
            None if self.disk.is_none() => return Err(SceneError::Empty),
            None => {}
        }
        validate::layers(self.settings.layers, self.light, sky.is_some())?;
        self.sky = sky.map(Arc::new);
        Ok(self)
    }

    /// The same scene with its light multiplied by 2 to the power of `stops`.
    ///
    /// # Errors
    /// [`SceneError::Value`] for an exposure that is not allowed.
    pub fn with_exposure(mut self, stops: f64) -> Result<Self, SceneError> {
        validate::exposure("image.exposure", stops)?;
        self.settings.exposure = stops;
        Ok(self)
    }

    /// The same scene with another tone.
    #[must_use]
    pub fn with_tone(mut self, tone: Tone) -> Self {
        self.settings.tone = tone;
        self
    }

    /// The same scene as a PNG picture whose samples have `bits` bits, 8 or 16.
    ///
    /// # Errors
    /// [`SceneError::Value`] for another number.
    pub fn with_bits(mut self, bits: u8) -> Result<Self, SceneError> {
        self.settings.bits = validate::bits(i64::from(bits))?;
        Ok(self)
    }

    /// The same scene with these layers of data.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a layer that the scene's light does not have.
    pub fn with_layers(mut self, layers: LayerSet) -> Result<Self, SceneError> {
        validate::layers(layers, self.light, self.sky.is_some())?;
        self.settings.layers = layers;
        Ok(self)
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The camera's radius, `|position|`, in Schwarzschild radii. Frames of an animation at one radius have the same
    /// value, to the last bit, although the components of their positions are rounded.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The disk; `None` where the scene shows only a sky.
    pub fn disk(&self) -> Option<&Disk> {
        self.disk.as_ref()
    }

    /// The light of the disk; `None` where the disk only covers.
    pub fn light(&self) -> Option<Light> {
        self.light
    }

    /// The sky; `None` where it is black. Before a sky a disk without light shines with the radiance 1, white.
    pub fn sky(&self) -> Option<&Sky> {
        self.sky.as_deref()
    }

    /// The sky, as the frames of an animation share it.
    pub(super) fn shared_sky(&self) -> Option<&Arc<Sky>> {
        self.sky.as_ref()
    }

    /// Whether pictures are in colour: the disk has light, or there is a sky. Else they are masks.
    pub fn shows_colour(&self) -> bool {
        self.light.is_some() || self.sky.is_some()
    }

    /// The exposure, in stops: a picture shows light times 2 to this power.
    pub fn exposure(&self) -> f64 {
        self.settings.exposure
    }

    /// How bright light becomes a picture's values.
    pub fn tone(&self) -> Tone {
        self.settings.tone
    }

    /// The bits of a PNG picture's samples, 8 or 16.
    pub fn bits(&self) -> u8 {
        self.settings.bits
    }

    /// The layers of data that the scene names.
    pub fn layers(&self) -> LayerSet {
        self.settings.layers
    }

    /// The whole picture's size.
    pub fn image(&self) -> ImageSize {
        self.settings.size
    }

    /// The part of the picture that is drawn, if it is not all.
    pub fn crop(&self) -> Option<Region> {
        self.settings.crop
    }

    /// The part of the picture that is drawn: [`Self::crop`], or all of it.
    pub fn region(&self) -> Region {
        self.settings.region()
    }

    /// The size of what is drawn: of [`Self::region`].
    pub fn size(&self) -> ImageSize {
        self.region().size()
    }

    /// Whether edges are smooth: a pixel is then the share of its square that the disk covers, else what its centre
    /// sees.
    pub fn antialias(&self) -> bool {
        self.settings.antialias
    }

    /// An edge's largest error, in pixels.
    pub fn tolerance(&self) -> f64 {
        self.settings.tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_size_checks_the_size_and_keeps_the_rest() {
        let scene = Scene::builtin("classic").unwrap();
        let small = scene.clone().with_size(64, 36).unwrap();
        assert_eq!(
            small.image(),
            ImageSize {
                width: 64,
                height: 36
            }
        );
        assert_eq!(
            (small.camera(), small.disk()),
            (scene.camera(), scene.disk())
        );
        assert!(matches!(
            scene.clone().with_size(0, 36),
            Err(SceneError::Value { .. })
        ));
        assert!(matches!(
            scene.with_size(64, 1_000_001),
            Err(SceneError::Value { .. })
        ));
    }

    #[test]
    fn a_scene_without_a_disk_needs_a_sky() {
        let size = ImageSize {
            width: 64,
            height: 36,
        };
        let camera = Camera::at([15.0, 0.0, 1.0], 60.0);
        let black = Scene::without_disk(camera, Sky::default(), size).unwrap();
        assert_eq!(black.disk(), None);
        assert_eq!(black.sky(), Some(&Sky::default()));
        let toml = black.to_toml();
        assert!(toml.contains("\n\n[sky]\n\n[image]") && !toml.contains("[disk]"));
        assert_eq!(Scene::from_toml(&toml).unwrap(), black);

        let words = "add the table [disk] or the table [sky]";
        for error in [
            Scene::from_toml(&toml.replace("[sky]\n", "")).unwrap_err(),
            black.clone().with_sky(None).unwrap_err(),
        ] {
            assert!(error.to_string().contains(words), "{error}");
        }
        let error = black
            .clone()
            .with_light(Some(Light::Bolometric))
            .unwrap_err();
        assert!(
            error.to_string().contains("add the table [disk]"),
            "{error}"
        );
        let classic = Scene::builtin("classic").unwrap();
        let other = classic.clone().with_camera(camera).unwrap();
        assert_eq!((other.camera(), other.disk()), (&camera, classic.disk()));
        assert!(
            classic
                .with_camera(Camera::at([5.0, 0.0, 0.0], 60.0))
                .is_err()
        );
    }
}
