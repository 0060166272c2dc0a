//! What all frames of an animation have in common: size, edges, light, sky and how they are shown.

use super::Animation;
use crate::scene::error::SceneError;
use crate::scene::layers::LayerSet;
use crate::scene::sky::Sky;
use crate::scene::validate;
use crate::scene::values::{ImageSize, Light, Region, Tone};

impl Animation {
    /// The size of every whole frame.
    pub fn image(&self) -> ImageSize {
        self.settings.size
    }

    /// The part of every frame that is drawn.
    pub fn region(&self) -> Region {
        self.settings.region()
    }

    /// The size of what is drawn of every frame: of [`Self::region`].
    pub fn size(&self) -> ImageSize {
        self.region().size()
    }

    /// The light of the disk; `None` where the disk only covers.
    pub fn light(&self) -> Option<Light> {
        self.file.light()
    }

    /// The sky of all frames; `None` where it is black.
    pub fn sky(&self) -> Option<&Sky> {
        self.file.sky.as_deref()
    }

    /// Whether frames are in colour: the disk has light, or there is a sky. Else they are masks.
    pub fn shows_colour(&self) -> bool {
        self.light().is_some() || self.sky().is_some()
    }

    /// The bits of a PNG picture's samples, 8 or 16.
    pub fn bits(&self) -> u8 {
        self.settings.bits
    }

    /// The layers of data that the animation names.
    pub fn layers(&self) -> LayerSet {
        self.settings.layers
    }

    /// The same animation as pictures of another size; the vertical field of view stays.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a size that is not allowed, and for one that does not have the part that is drawn.
    pub fn with_size(mut self, width: u32, height: u32) -> Result<Self, SceneError> {
        (self.file.image.width, self.file.image.height) = (i64::from(width), i64::from(height));
        self.with_settings()
    }

    /// The same animation of which only a part of each frame is drawn, or all of it (`None`).
    ///
    /// # Errors
    /// [`SceneError::Value`] for a part without pixels, and for one that reaches beyond the picture.
    pub fn with_crop(mut self, crop: Option<Region>) -> Result<Self, SceneError> {
        self.file.image.crop =
            crop.map(|part| [part.left, part.top, part.width, part.height].map(i64::from));
        self.with_settings()
    }

    /// The same animation with its edges right to `pixels`.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a tolerance that is not allowed.
    pub fn with_tolerance(mut self, pixels: f64) -> Result<Self, SceneError> {
        self.file.image.tolerance = pixels;
        self.with_settings()
    }

    /// The same animation with smooth edges, or with hard ones.
    ///
    /// # Errors
    /// None that the animation does not have already.
    pub fn with_antialias(mut self, antialias: bool) -> Result<Self, SceneError> {
        self.file.image.antialias = antialias;
        self.with_settings()
    }

    /// The same animation with a shining disk, or with one that only covers (`None`).
    ///
    /// # Errors
    /// [`SceneError::Value`] for a temperature that is not allowed, for the light of a scene without a disk, and for a
    /// disk that no longer has the light of one of the layers.
    pub fn with_light(mut self, light: Option<Light>) -> Result<Self, SceneError> {
        match &mut self.file.disk {
            Some(disk) => disk.light = light,
            None => validate::light(light, false)?,
        }
        self.with_settings()
    }

    /// The same animation with its light multiplied by 2 to the power of `stops`, in every frame.
    ///
    /// # Errors
    /// [`SceneError::Value`] for an exposure that is not allowed.
    pub fn with_exposure(mut self, stops: f64) -> Result<Self, SceneError> {
        self.file.image.exposure = stops;
        self.with_settings()
    }

    /// The same animation with another tone.
    #[must_use]
    pub fn with_tone(mut self, tone: Tone) -> Self {
        self.file.image.tone = tone;
        self.settings.tone = tone;
        self
    }

    /// The same animation as PNG pictures whose samples have `bits` bits, 8 or 16.
    ///
    /// # Errors
    /// [`SceneError::Value`] for another number.
    pub fn with_bits(mut self, bits: u8) -> Result<Self, SceneError> {
        self.file.image.bits = i64::from(bits);
        self.with_settings()
    }

    /// The same animation with these layers of data.
    ///
    /// # Errors
    /// [`SceneError::Value`] for a layer that the scene's light does not have.
    pub fn with_layers(mut self, layers: LayerSet) -> Result<Self, SceneError> {
        self.file.image.layers = layers;
        self.with_settings()
    }

    fn with_settings(mut self) -> Result<Self, SceneError> {
        self.settings = self.file.settings()?;
        Ok(self)
    }
}
