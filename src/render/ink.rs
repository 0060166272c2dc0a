//! What is painted: colours or data, into which memory.

use core::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use super::error::RenderError;
use super::mixture::Mixture;
use super::patch::{Patch, RowPolynomial};
use super::planes::{Form, Plane};
use super::shader::{PlaceRay, Shader};
use crate::light::{DisplayTransform, Palette, Radiance, RadianceTable, Sight, flux};
use crate::scene::{Layer, LayerSet, Light, Scene, Tone};

/// The most quantities that are interpolated.
pub(super) const MOST_QUANTITIES: usize = 8;

/// An order's share of a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub(super) order: u32,
    pub(super) share: f32,
}

/// Paints pixels of one kind.
pub(super) trait Ink: Sync {
    /// The memory of a band of rows.
    type Band<'b>;

    /// Fills a band with what is seen where there is no disk.
    fn clear(&self, band: &mut Self::Band<'_>);

    /// Adds to a band, which begins at row `top` of the picture, what is seen beside the disk.
    fn finish(&self, band: &mut Self::Band<'_>, shader: &Shader<'_>, top: usize, smooth: bool) {
        let _ = (band, shader, top, smooth);
    }

    /// How many quantities are interpolated, at most [`MOST_QUANTITIES`].
    fn quantities(&self) -> usize;

    /// How far they may be off, as a share of their size.
    fn tolerance(&self) -> f64;

    /// The degree of the polynomials.
    fn degree(&self) -> usize {
        6
    }

    /// Computes the quantities of a ray that meets the disk at u.
    fn evaluate(&self, shader: &Shader<'_>, order: u32, u: f64, ray: &PlaceRay, values: &mut [f64]);

    /// The quantity that is an angle, if there is one.
    fn angle(&self, values: &[f64]) -> f64 {
        let _ = values;
        0.0
    }

    /// Makes the angle continuous with the first one.
    fn unwrap(&self, values: &mut [f64], first: f64) {
        let _ = (values, first);
    }

    /// Paints pixels of one row, wholly covered, from a patch.
    #[expect(clippy::too_many_arguments, reason = "what, where, and from what")]
    fn put_row(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        row: usize,
        columns: (usize, usize),
        patch: &Patch,
        y: f64,
    );

    /// Whether pixels without a patch are painted as mixtures: their light is averaged.
    fn averages(&self) -> bool {
        true
    }

    /// Paints one pixel, wholly covered.
    fn put(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        pixel: (usize, usize),
        ray: &PlaceRay,
        values: &[f64],
    );

    /// Paints a pixel that is covered in part.
    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        row: usize,
        column: usize,
        parts: &[Part],
        mixture: &Mixture<'_>,
    );
}

/// The amplitude of what a ray sees.
pub(super) fn amplitude(sight: &Sight) -> f64 {
    sight.redshift * sight.redshift * flux::signed_root(sight.u)
}

/// How light becomes colours.
#[derive(Debug)]
pub(super) struct Colours {
    pub(super) radiance: RadianceTable,
    pub(super) display: DisplayTransform,
    pub(super) palette: Palette,
}

impl Colours {
    /// Prepares the colours of a scene with light.
    pub(super) fn new(light: Light, exposure: f64, tone: Tone) -> Self {
        let radiance = RadianceTable::new(&Radiance::new(light));
        let display = DisplayTransform::new(exposure, tone);
        Self {
            palette: Palette::new(&radiance, &display),
            radiance,
            display,
        }
    }

    /// Calls `put` with the linear light of pixels of a row: its mean over `parts` places a side of each.
    #[inline]
    fn averaged(
        &self,
        patch: &Patch,
        quantity: usize,
        (from, to): (usize, usize),
        y: f64,
        parts: usize,
        mut put: impl FnMut(usize, [f32; 3]),
    ) {
        if parts == 1 {
            patch
                .row(quantity, y)
                .for_lanes(from, to, |column, amplitudes| {
                    for (i, amplitude) in amplitudes.iter().enumerate() {
                        put(column + i, self.radiance.rgb(*amplitude));
                    }
                });
            return;
        }
        let rows: [RowPolynomial; MOST_PARTS] =
            core::array::from_fn(|i| patch.row(quantity, y + offset(i.min(parts - 1), parts)));
        let share = 1.0 / (parts * parts) as f32;
        for column in from..to {
            let mut sum = [0.0; 3];
            for row in &rows[..parts] {
                for i in 0..parts {
                    let amplitude = row.at(column as f64 + 0.5 + offset(i, parts));
                    let rgb = self.radiance.rgb(amplitude as f32);
                    for (sum, c) in sum.iter_mut().zip(rgb) {
                        *sum += share * c;
                    }
                }
            }
            put(column, sum);
        }
    }

    /// The linear light of a pixel that is covered in part.
    fn mixed(&self, parts: &[Part], mixture: &Mixture<'_>) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for part in parts {
            let mean = mixture.mean(part.order, f64::from(part.share), |y| {
                self.radiance.rgb(y as f32)
            });
            for (sum, c) in sum.iter_mut().zip(mean) {
                *sum += part.share * c;
            }
        }
        sum
    }
}

/// The colours of an animation, computed when a frame first needs them: light, exposure and tone are those of all its
/// frames.
#[derive(Debug, Default)]
pub(super) struct SharedColours(OnceLock<Colours>);

impl SharedColours {
    /// The colours of a scene, where it has light and the form shows it.
    pub(super) fn of(&self, scene: &Scene, form: Form) -> Option<&Colours> {
        let light = scene.light()?;
        let new = || Colours::new(light, scene.exposure(), scene.tone());
        form.shows_light().then(|| self.0.get_or_init(new))
    }
}

/// The amplitude of a ray.
fn evaluate_amplitude(shader: &Shader<'_>, u: f64, ray: &PlaceRay, values: &mut [f64]) {
    values[0] = shader.amplitude(u, shader.lambda(ray));
}

/// The last coefficients of an amplitude for colours of 8 bits. The amplitude itself is off by a fifth of it or less:
/// by 1/20 of a code where light rises with its tenth power.
const COLOUR_TOLERANCE: f64 = 1e-4;

/// The most places a side of a pixel over which its light is averaged.
const MOST_PARTS: usize = 8;

/// Where the amplitude changes by less than this from a pixel to the next, the light of the centre is the mean: it is
/// off by about `L″ δ²/24` where the amplitude changes by δ, with L″ some 10, so by 1e-3 of the hottest ring's light.
const FLAT: f64 = 0.05;

/// Two places a side, at ±1/√12, are exact to the fourth power of the change. They do up to this change.
const STEEP: f64 = 0.3;

/// What of a pixel's light is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Averaging {
    /// The mean over its square.
    Square,
    /// Its centre's.
    Centre,
}

/// How many places a side of a pixel its light is averaged over.
fn parts(patch: &Patch, averaging: Averaging) -> usize {
    if averaging == Averaging::Centre {
        return 1;
    }
    match patch.steepness() {
        flat if flat <= FLAT => 1,
        steep if steep <= STEEP => 2,
        steep if steep <= 2.0 * STEEP => 4,
        _ => MOST_PARTS,
    }
}

/// Where the i-th of `parts` places of a pixel's side is, from its middle: pairs of Gauss's places.
fn offset(i: usize, parts: usize) -> f64 {
    /// `1/√12`
    const GAUSS: f64 = 0.288_675_134_594_812_9;
    let pairs = parts / 2;
    let pair = ((i / 2) as f64 + 0.5) / pairs as f64 - 0.5;
    pair + (if i.is_multiple_of(2) { -GAUSS } else { GAUSS }) / pairs as f64
}

/// How far data may be off.
const DATA_TOLERANCE: f64 = 3e-8;

/// Colours of 8 bits.
pub(super) struct Rgb8<'a>(pub(super) &'a Colours, pub(super) Averaging);

/// A band's memory: rows of samples, some distance apart.
pub(super) struct Rows<'b, T> {
    pub(super) samples: &'b mut [T],
    pub(super) stride: usize,
    /// The samples of a row.
    pub(super) width: usize,
}

impl<'b, T: Copy + Default> Rows<'b, T> {
    /// Splits memory, whose rows of `width` samples are `stride` apart, into bands of `rows` rows.
    pub(super) fn bands(
        samples: &'b mut [T],
        stride: usize,
        width: usize,
        rows: usize,
    ) -> impl Iterator<Item = Self> {
        let bands = samples.chunks_mut(stride.saturating_mul(rows));
        bands.map(move |samples| Self {
            samples,
            stride,
            width,
        })
    }

    fn clear(&mut self) {
        for row in self.samples.chunks_mut(self.stride) {
            let width = self.width.min(row.len());
            row[..width].fill(T::default());
        }
    }

    #[inline(always)]
    fn pixels(&mut self, row: usize, from: usize, to: usize) -> &mut [[T; 3]] {
        let row = &mut self.samples[row * self.stride..];
        row[3 * from..3 * to].as_chunks_mut::<3>().0
    }
}

impl Ink for Rgb8<'_> {
    type Band<'b> = Rows<'b, u8>;

    fn clear(&self, band: &mut Self::Band<'_>) {
        band.clear();
    }

    fn quantities(&self) -> usize {
        1
    }

    fn tolerance(&self) -> f64 {
        COLOUR_TOLERANCE
    }

    fn evaluate(&self, shader: &Shader<'_>, _: u32, u: f64, ray: &PlaceRay, values: &mut [f64]) {
        evaluate_amplitude(shader, u, ray, values);
    }

    fn put_row(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        _: u32,
        row: usize,
        (from, to): (usize, usize),
        patch: &Patch,
        y: f64,
    ) {
        let parts = parts(patch, self.1);
        if parts > 1 {
            let pixels = band.pixels(row, from, to);
            self.0
                .averaged(patch, 0, (from, to), y, parts, |column, light| {
                    pixels[column - from] = self.0.display.rgb8(light);
                });
            return;
        }
        let mut pixels = band.pixels(row, from, to).iter_mut();
        let palette = &self.0.palette;
        patch.row(0, y).for_lanes(from, to, |_, amplitudes| {
            for (amplitude, pixel) in amplitudes.iter().zip(&mut pixels) {
                let [r, g, b, _] = palette.rgb8(*amplitude);
                *pixel = [r, g, b];
            }
        });
    }

    fn put(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        _: u32,
        (row, column): (usize, usize),
        _: &PlaceRay,
        values: &[f64],
    ) {
        let [r, g, b, _] = self.0.palette.rgb8(values[0] as f32);
        band.pixels(row, column, column + 1)[0] = [r, g, b];
    }

    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        row: usize,
        column: usize,
        parts: &[Part],
        mixture: &Mixture<'_>,
    ) {
        let light = self.0.mixed(parts, mixture);
        band.pixels(row, column, column + 1)[0] = self.0.display.rgb8(light);
    }
}

/// Colours of 16 bits.
pub(super) struct Rgb16<'a>(pub(super) &'a Colours, pub(super) Averaging);

impl Ink for Rgb16<'_> {
    type Band<'b> = Rows<'b, u16>;

    fn clear(&self, band: &mut Self::Band<'_>) {
        band.clear();
    }

    fn quantities(&self) -> usize {
        1
    }

    fn tolerance(&self) -> f64 {
        COLOUR_TOLERANCE / 200.0
    }

    fn evaluate(&self, shader: &Shader<'_>, _: u32, u: f64, ray: &PlaceRay, values: &mut [f64]) {
        evaluate_amplitude(shader, u, ray, values);
    }

    fn put_row(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        _: u32,
        row: usize,
        (from, to): (usize, usize),
        patch: &Patch,
        y: f64,
    ) {
        let pixels = band.pixels(row, from, to);
        let parts = parts(patch, self.1);
        self.0
            .averaged(patch, 0, (from, to), y, parts, |column, light| {
                pixels[column - from] = self.0.display.rgb16(light);
            });
    }

    fn put(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        _: u32,
        (row, column): (usize, usize),
        _: &PlaceRay,
        values: &[f64],
    ) {
        let light = self.0.radiance.rgb(values[0] as f32);
        band.pixels(row, column, column + 1)[0] = self.0.display.rgb16(light);
    }

    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        _: &Shader<'_>,
        row: usize,
        column: usize,
        parts: &[Part],
        mixture: &Mixture<'_>,
    ) {
        let light = self.0.mixed(parts, mixture);
        band.pixels(row, column, column + 1)[0] = self.0.display.rgb16(light);
    }
}

/// Layers of data.
pub(super) struct Data<'a> {
    /// Those that are interpolated: what is asked for, without coverage and order.
    quantities: Vec<Quantity>,
    layers: LayerSet,
    /// Of a scene with light.
    colours: Option<&'a Colours>,
    averaging: Averaging,
    /// The temperature of the hottest ring.
    temperature: f64,
}

/// What is interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Radius,
    Azimuth,
    Redshift,
    EmissionCosine,
    /// For temperature and colour.
    Amplitude,
}

/// A band of each layer.
pub(super) struct PlaneRows<'b> {
    pub(super) planes: Vec<(Layer, &'b mut [f32])>,
    pub(super) width: usize,
}

impl<'a> Data<'a> {
    /// # Errors
    /// [`RenderError::NoLight`] for colours or temperatures of a scene without light.
    pub(super) fn new(
        layers: LayerSet,
        colours: Option<&'a Colours>,
        light: Option<Light>,
        averaging: Averaging,
    ) -> Result<Self, RenderError> {
        let has_light = match light {
            None => !layers.has(Layer::Temperature) && !layers.has(Layer::Colour),
            Some(Light::Bolometric) => !layers.has(Layer::Temperature),
            Some(Light::BlackBody { .. }) => true,
        };
        if !has_light {
            return Err(RenderError::NoLight);
        }
        let temperature = match light {
            Some(Light::BlackBody { temperature }) => temperature,
            _ => 0.0,
        };
        let needs = [
            (Quantity::Radius, layers.has(Layer::Radius)),
            (Quantity::Azimuth, layers.has(Layer::Azimuth)),
            (Quantity::Redshift, layers.has(Layer::Redshift)),
            (Quantity::EmissionCosine, layers.has(Layer::EmissionCosine)),
            (
                Quantity::Amplitude,
                layers.has(Layer::Temperature) || layers.has(Layer::Colour),
            ),
        ];
        let needed = needs.into_iter().filter(|(_, is_needed)| *is_needed);
        Ok(Self {
            quantities: needed.map(|(quantity, _)| quantity).collect(),
            layers,
            colours,
            averaging,
            temperature,
        })
    }

    /// Splits planes into bands of rows.
    pub(super) fn bands<'b>(
        planes: &'b mut [Plane],
        width: usize,
        rows: usize,
    ) -> Vec<PlaneRows<'b>> {
        let mut bands: Vec<PlaneRows<'b>> = Vec::new();
        for plane in planes {
            let layer = plane.layer;
            let parts = plane.values.chunks_mut(width * rows * layer.channels());
            for (i, part) in parts.enumerate() {
                if bands.len() <= i {
                    bands.push(PlaneRows {
                        planes: Vec::new(),
                        width,
                    });
                }
                bands[i].planes.push((layer, part));
            }
        }
        bands
    }

    /// Sets a pixel of every layer to what a ray sees.
    pub(super) fn set_sight(&self, band: &mut PlaneRows<'_>, pixel: usize, sight: &Sight) {
        let mut values = [0.0; MOST_QUANTITIES];
        for (value, quantity) in values.iter_mut().zip(&self.quantities) {
            *value = match quantity {
                Quantity::Radius => 1.0 / sight.u,
                Quantity::Azimuth => sight.azimuth,
                Quantity::Redshift => sight.redshift,
                Quantity::EmissionCosine => sight.emission_cosine,
                Quantity::Amplitude => amplitude(sight),
            };
        }
        self.set(band, sight.order, pixel, &values);
    }

    /// Sets a pixel that sees no disk.
    pub(super) fn set_hidden(band: &mut PlaneRows<'_>, pixel: usize, is_captured: bool) {
        for (layer, plane) in &mut band.planes {
            if *layer == Layer::Alpha && is_captured {
                plane[pixel] = 1.0;
            }
        }
    }

    fn place_of(&self, quantity: Quantity) -> Option<usize> {
        self.quantities.iter().position(|&q| q == quantity)
    }

    /// The quantity of a layer.
    fn of(layer: Layer) -> Option<Quantity> {
        match layer {
            Layer::Radius => Some(Quantity::Radius),
            Layer::Azimuth => Some(Quantity::Azimuth),
            Layer::Redshift => Some(Quantity::Redshift),
            Layer::EmissionCosine => Some(Quantity::EmissionCosine),
            Layer::Temperature | Layer::Colour => Some(Quantity::Amplitude),
            Layer::Coverage | Layer::Order | Layer::Alpha => None,
        }
    }

    /// Sets a pixel of every layer that holds data of a ray.
    fn set(&self, band: &mut PlaneRows<'_>, order: u32, pixel: usize, values: &[f64]) {
        for (layer, plane) in &mut band.planes {
            let value = Self::of(*layer)
                .and_then(|quantity| self.place_of(quantity))
                .map(|place| values[place]);
            match (*layer, value) {
                (Layer::Coverage | Layer::Alpha, _) => plane[pixel] = 1.0,
                (Layer::Order, _) => plane[pixel] = order as f32,
                (Layer::Azimuth, Some(azimuth)) => plane[pixel] = turned(azimuth as f32),
                (Layer::Temperature, Some(y)) => plane[pixel] = self.kelvin(y as f32),
                (Layer::Colour, Some(y)) => {
                    let rgb = self
                        .colours
                        .map_or([0.0; 3], |colours| colours.radiance.rgb(y as f32));
                    plane[3 * pixel..][..3].copy_from_slice(&rgb);
                }
                (_, Some(value)) => plane[pixel] = value as f32,
                (_, None) => {}
            }
        }
    }

    fn kelvin(&self, amplitude: f32) -> f32 {
        self.temperature as f32 * amplitude.max(0.0).sqrt()
    }
}

/// Adds the hole's shadow where there is no disk, to rows from row `top` of the picture on: what the centre sees, or
/// with smooth edges the covered share.
fn add_shadow(alpha: &mut [f32], width: usize, shader: &Shader<'_>, top: usize, smooth: bool) {
    for (i, alpha) in alpha.iter_mut().enumerate() {
        if *alpha == 0.0 {
            let place = ((i % width) as f64 + 0.5, (top + i / width) as f64 + 0.5);
            let share = shader.shadow(place);
            *alpha = if smooth {
                share as f32
            } else {
                f32::from(u8::from(share >= 0.5))
            };
        }
    }
}

/// An angle as a float within 0 and 2π.
fn turned(angle: f32) -> f32 {
    const TURN: f32 = core::f32::consts::TAU;
    if angle < 0.0 {
        angle + TURN
    } else if angle >= TURN {
        angle - TURN
    } else {
        angle
    }
}

impl Ink for Data<'_> {
    type Band<'b> = PlaneRows<'b>;

    fn clear(&self, band: &mut Self::Band<'_>) {
        for (layer, plane) in &mut band.planes {
            plane.fill(layer.nothing());
        }
    }

    fn finish(&self, band: &mut Self::Band<'_>, shader: &Shader<'_>, top: usize, smooth: bool) {
        for (layer, plane) in &mut band.planes {
            if *layer == Layer::Alpha {
                add_shadow(plane, band.width, shader, top, smooth);
            }
        }
    }

    fn quantities(&self) -> usize {
        self.quantities.len()
    }

    fn tolerance(&self) -> f64 {
        DATA_TOLERANCE
    }

    fn degree(&self) -> usize {
        8
    }

    fn evaluate(
        &self,
        shader: &Shader<'_>,
        order: u32,
        u: f64,
        ray: &PlaceRay,
        values: &mut [f64],
    ) {
        let momentum = shader.geometry.angular_momentum(ray.ray);
        let g = shader.redshift(u, momentum.along);
        for (value, quantity) in values.iter_mut().zip(&self.quantities) {
            *value = match quantity {
                Quantity::Radius => 1.0 / u,
                Quantity::Azimuth => shader.geometry.azimuth(ray.ray, shader.told(order, ray)),
                Quantity::Redshift => g,
                Quantity::EmissionCosine => {
                    crate::light::emission_cosine(u, momentum.across, momentum.along)
                }
                Quantity::Amplitude => g * g * shader.flux_root(u),
            };
        }
    }

    fn averages(&self) -> bool {
        self.layers.has(Layer::Colour)
    }

    fn angle(&self, values: &[f64]) -> f64 {
        self.place_of(Quantity::Azimuth)
            .map_or(0.0, |place| values[place])
    }

    fn unwrap(&self, values: &mut [f64], first: f64) {
        if let Some(place) = self.place_of(Quantity::Azimuth) {
            let turn = values[place] - first;
            if turn > PI {
                values[place] -= TAU;
            } else if turn < -PI {
                values[place] += TAU;
            }
        }
    }

    fn put_row(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        row: usize,
        (from, to): (usize, usize),
        patch: &Patch,
        y: f64,
    ) {
        let (outer, inner) = shader.u_edges;
        let (least, greatest) = (1.0 / inner, 1.0 / outer);
        let first = row * band.width;
        for (layer, plane) in &mut band.planes {
            let pixels = &mut plane[(first + from) * layer.channels()..];
            let pixels = &mut pixels[..(to - from) * layer.channels()];
            let place = Self::of(*layer).and_then(|quantity| self.place_of(quantity));
            let Some(place) = place else {
                match layer {
                    Layer::Order if shader.is_in_plane => {
                        for (i, pixel) in pixels.iter_mut().enumerate() {
                            let ray = shader.ray(((from + i) as f64 + 0.5, y));
                            *pixel = shader.told(order, &ray) as f32;
                        }
                    }
                    Layer::Order => pixels.fill(order as f32),
                    _ => pixels.fill(1.0),
                }
                continue;
            };
            let polynomial = patch.row(place, y);
            if *layer == Layer::Colour {
                if let Some(colours) = self.colours {
                    let parts = parts(patch, self.averaging);
                    colours.averaged(patch, place, (from, to), y, parts, |column, light| {
                        pixels[3 * (column - from)..][..3].copy_from_slice(&light);
                    });
                }
                continue;
            }
            let (least, greatest) = (least as f32, greatest as f32);
            polynomial.for_lanes(from, to, |column, values| {
                let pixels = pixels[column - from..].iter_mut().zip(values);
                match layer {
                    Layer::Radius => {
                        pixels.for_each(|(pixel, r)| *pixel = r.clamp(least, greatest));
                    }
                    Layer::Azimuth => pixels.for_each(|(pixel, angle)| *pixel = turned(*angle)),
                    Layer::Temperature => pixels.for_each(|(pixel, y)| *pixel = self.kelvin(*y)),
                    _ => pixels.for_each(|(pixel, value)| *pixel = *value),
                }
            });
        }
    }

    fn put(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        (row, column): (usize, usize),
        ray: &PlaceRay,
        values: &[f64],
    ) {
        let pixel = row * band.width + column;
        let told = shader.told(order, ray);
        self.set(band, told, pixel, values);
    }

    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        row: usize,
        column: usize,
        parts: &[Part],
        mixture: &Mixture<'_>,
    ) {
        let pixel = row * band.width + column;
        if let Some((order, ray)) = mixture.nearest_covered() {
            let mut values = [0.0; MOST_QUANTITIES];
            if !self.quantities.is_empty() {
                let u = shader.u_on_disk(order, &ray);
                self.evaluate(shader, order, u, &ray, &mut values);
            }
            self.set(band, shader.told(order, &ray), pixel, &values);
        }
        let share = parts.iter().map(|part| part.share).sum::<f32>().min(1.0);
        let light = match self.colours {
            Some(colours) if self.layers.has(Layer::Colour) => colours.mixed(parts, mixture),
            _ => [0.0; 3],
        };
        for (layer, plane) in &mut band.planes {
            match layer {
                Layer::Coverage => plane[pixel] = share,
                Layer::Alpha => {
                    let shadow = if share < 1.0 {
                        mixture.shadow() as f32
                    } else {
                        0.0
                    };
                    plane[pixel] = share + (1.0 - share) * shadow;
                }
                Layer::Colour => plane[3 * pixel..][..3].copy_from_slice(&light),
                _ => {}
            }
        }
    }
}
