//! Layers of data.

use std::sync::LazyLock;

use super::directions::{paint_directions, set_direction};
use super::rows::Samples;
use super::{Averaging, Colours, Ink, Part, Quantities, Stretch, amplitude};
use crate::light::{Sight, emission_cosine};
use crate::render::error::RenderError;
use crate::render::mixture::Mixture;
use crate::render::patch::{Patch, PatchFit};
use crate::render::planes::Plane;
use crate::render::shader::{PlaceRay, Shader};
use crate::render::sky::{SkyShader, SkySight};
use crate::render::tiles::{Run, TileRow, tiles_of};
use crate::scene::{Layer, LayerSet, Light, Scene, View};

/// Nodes a side of a patch.
const NODES: usize = 9;

static FIT: LazyLock<PatchFit<NODES>> = LazyLock::new(PatchFit::new);

/// How far data may be off: half a unit in the last place of a float.
const TOLERANCE: f64 = 3e-8;

/// The most layers of a frame.
const MOST_LAYERS: usize = Layer::NAMED.len() + 1;

/// Layers of data.
pub(in crate::render) struct Data<'a> {
    layers: LayerSet,
    /// Of a scene with light.
    colours: Option<&'a Colours>,
    averaging: Averaging,
    /// The temperature of the hottest ring.
    temperature: f64,
    /// Whether there is a sky, so that no pixel shows through.
    has_sky: bool,
}

/// What is interpolated, in the order of the quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Radius,
    Azimuth,
    Redshift,
    EmissionCosine,
    /// For temperature and colour. The last one: a patch tells how steep it is.
    Amplitude,
}

impl Quantity {
    const ALL: [Self; 5] = [
        Self::Radius,
        Self::Azimuth,
        Self::Redshift,
        Self::EmissionCosine,
        Self::Amplitude,
    ];

    /// What a layer is computed from.
    fn of(layer: Layer) -> Option<Self> {
        match layer {
            Layer::Radius => Some(Self::Radius),
            Layer::Azimuth => Some(Self::Azimuth),
            Layer::Redshift => Some(Self::Redshift),
            Layer::EmissionCosine => Some(Self::EmissionCosine),
            Layer::Temperature | Layer::Colour => Some(Self::Amplitude),
            Layer::Coverage | Layer::Order | Layer::Sky | Layer::SkyUv | Layer::Alpha => None,
        }
    }

    /// Whether some layer is computed from it.
    fn is_of(self, layers: LayerSet) -> bool {
        layers.iter().any(|layer| Self::of(layer) == Some(self))
    }
}

/// A band of each layer.
pub(in crate::render) struct PlaneRows<'b> {
    planes: [Option<(Layer, Samples<'b, f32>)>; MOST_LAYERS],
    pub(super) width: usize,
}

impl<'b> PlaneRows<'b> {
    /// Splits planes of the drawn part of a view into bands.
    pub(in crate::render) fn bands(
        planes: &'b mut [Plane],
        view: &View,
    ) -> impl Iterator<Item = Self> {
        let (drawn, width) = (view.region().width as usize, tiles_of(view).width as usize);
        let mut planes = planes.iter_mut().map(|plane| {
            let channels = plane.layer.channels();
            let bands = Samples::bands(&mut plane.values, view, drawn * channels, channels);
            (plane.layer, bands)
        });
        let mut parts: [_; MOST_LAYERS] = core::array::from_fn(|_| planes.next());
        core::iter::from_fn(move || {
            let mut next = |i: usize| {
                let (layer, parts) = parts[i].as_mut()?;
                Some((*layer, parts.next()?))
            };
            let planes = core::array::from_fn(&mut next);
            planes[0].is_some().then_some(Self { planes, width })
        })
    }

    pub(super) fn iter(&mut self) -> impl Iterator<Item = (Layer, &mut [f32])> {
        let planes = self.planes.iter_mut().flatten();
        planes.map(|(layer, plane)| (*layer, plane.all().0))
    }

    /// Hands over the pixels that are drawn.
    pub(in crate::render) fn hand_over(&mut self) {
        let planes = self.planes.iter_mut().flatten();
        planes.for_each(|(_, plane)| plane.hand_over());
    }
}

impl<'a> Data<'a> {
    /// # Errors
    /// [`RenderError::NoLight`] for colours or temperatures of a scene without light.
    pub(in crate::render) fn new(
        layers: LayerSet,
        colours: Option<&'a Colours>,
        scene: &Scene,
        averaging: Averaging,
    ) -> Result<Self, RenderError> {
        let light = scene.light();
        let has_temperature = matches!(light, Some(Light::BlackBody { .. }));
        let lacks = |layer, has: bool| layers.has(layer) && !has;
        if lacks(Layer::Temperature, has_temperature) || lacks(Layer::Colour, colours.is_some()) {
            return Err(RenderError::NoLight);
        }
        let temperature = match light {
            Some(Light::BlackBody { temperature }) => temperature,
            _ => 0.0,
        };
        Ok(Self {
            layers,
            colours,
            averaging,
            temperature,
            has_sky: scene.sky().is_some(),
        })
    }

    /// Sets a pixel of every layer to what a ray sees.
    pub(in crate::render) fn set_sight(
        &self,
        band: &mut PlaneRows<'_>,
        pixel: usize,
        sight: &Sight,
    ) {
        let values = self.quantities_of(|quantity| match quantity {
            Quantity::Radius => 1.0 / sight.u,
            Quantity::Azimuth => sight.azimuth,
            Quantity::Redshift => sight.redshift,
            Quantity::EmissionCosine => sight.emission_cosine,
            Quantity::Amplitude => amplitude(sight),
        });
        self.set(band, sight.order, pixel, &values);
    }

    /// Sets a pixel that sees no disk.
    pub(in crate::render) fn set_hidden(band: &mut PlaneRows<'_>, pixel: usize, is_captured: bool) {
        for (layer, plane) in band.iter() {
            if layer == Layer::Alpha && is_captured {
                plane[pixel] = 1.0;
            }
        }
    }

    /// Sets the direction in which a pixel's ray leaves.
    pub(in crate::render) fn put_direction(
        &self,
        band: &mut PlaneRows<'_>,
        pixel: usize,
        sky: &SkyShader<'_>,
        sight: &SkySight,
    ) {
        if self.needs_directions() {
            set_direction(band, pixel, sky, sight);
        }
    }

    /// Sets what no pixel of a sky shows through.
    pub(in crate::render) fn finish_sky(&self, band: &mut PlaneRows<'_>) {
        let planes = band.iter().filter(|(layer, _)| *layer == Layer::Alpha);
        planes.for_each(|(_, plane)| {
            if self.has_sky {
                plane.fill(1.0);
            }
        });
    }

    /// The quantities that are asked for.
    fn asked(&self) -> impl Iterator<Item = Quantity> {
        let all = Quantity::ALL.into_iter();
        let is_white = self.colours.is_some_and(|colours| colours.is_white);
        let layers = if is_white {
            self.layers.without(Layer::Colour)
        } else {
            self.layers
        };
        all.filter(move |quantity| quantity.is_of(layers))
    }

    /// The place of a quantity among those that are asked for.
    fn place_of(&self, quantity: Quantity) -> Option<usize> {
        self.asked().position(|asked| asked == quantity)
    }

    /// Computes the quantities that are asked for.
    #[inline(always)]
    fn quantities_of(&self, value: impl Fn(Quantity) -> f64) -> Quantities {
        let mut values = Quantities::default();
        for (place, quantity) in values.iter_mut().zip(self.asked()) {
            *place = value(quantity);
        }
        values
    }

    /// Sets a pixel of every layer that holds data of a ray.
    fn set(&self, band: &mut PlaneRows<'_>, order: u32, pixel: usize, values: &Quantities) {
        for (layer, plane) in band.iter() {
            let place = Quantity::of(layer).and_then(|quantity| self.place_of(quantity));
            let value = place.map(|place| values[place]);
            match (layer, value) {
                (Layer::Coverage | Layer::Alpha, _) => plane[pixel] = 1.0,
                (Layer::Order, _) => plane[pixel] = order as f32,
                (Layer::Azimuth, Some(azimuth)) => plane[pixel] = turned(azimuth as f32),
                (Layer::Temperature, Some(y)) => plane[pixel] = self.kelvin(y as f32),
                (Layer::Colour, Some(y)) => {
                    let light = |colours: &Colours| colours.light(y as f32);
                    let light = self.colours.map_or([0.0; 3], light);
                    plane[3 * pixel..][..3].copy_from_slice(&light);
                }
                (Layer::Colour, None) => plane[3 * pixel..][..3].fill(1.0),
                (_, Some(value)) => plane[pixel] = value as f32,
                (_, None) => {}
            }
        }
    }

    fn kelvin(&self, amplitude: f32) -> f32 {
        self.temperature as f32 * amplitude.max(0.0).sqrt()
    }

    /// The quantities of a place that sees an order.
    fn quantities_at(&self, shader: &Shader<'_>, order: u32, ray: &PlaceRay) -> Quantities {
        let mut values = Quantities::default();
        if self.asked().next().is_some() {
            let u = shader.u_on_disk(order, ray);
            self.evaluate(shader, order, u, ray, &mut values);
        }
        values
    }
}

/// Adds the hole's shadow where there is no disk, to a band: what the centre sees, or with smooth edges the covered
/// share.
fn add_shadow(alpha: &mut [f32], shader: &Shader<'_>, band: TileRow, averaging: Averaging) {
    for (i, alpha) in alpha.iter_mut().enumerate() {
        if *alpha == 0.0 {
            let place = band.centre(i % band.width, i / band.width);
            *alpha = match averaging {
                Averaging::Square => shader.shadow(place) as f32,
                Averaging::Centre => f32::from(u8::from(shader.shadow_covers(place))),
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

impl Ink<NODES> for Data<'_> {
    type Band<'b> = PlaneRows<'b>;

    fn clear(&self, band: &mut Self::Band<'_>, row: usize, (from, to): (usize, usize)) {
        let first = row * band.width;
        for (layer, plane) in band.iter() {
            let channels = layer.channels();
            plane[(first + from) * channels..(first + to) * channels].fill(layer.nothing());
        }
    }

    fn put_light(&self, band: &mut Self::Band<'_>, row: usize, from: usize, light: &[[f32; 3]]) {
        let first = row * band.width + from;
        for (layer, plane) in band.iter() {
            if layer == Layer::Colour {
                plane[3 * first..][..3 * light.len()].copy_from_slice(light.as_flattened());
            }
        }
    }

    fn needs_directions(&self) -> bool {
        self.layers.has(Layer::Sky) || self.layers.has(Layer::SkyUv)
    }

    fn put_directions(
        &self,
        band: &mut Self::Band<'_>,
        sky: &SkyShader<'_>,
        place: TileRow,
        runs: &[Run],
    ) {
        if self.needs_directions() {
            paint_directions(band, sky, place, runs);
        }
    }

    fn finish(&self, band: &mut Self::Band<'_>, shader: &Shader<'_>, place: TileRow) {
        if self.has_sky {
            self.finish_sky(band);
        } else {
            for (layer, plane) in band.iter() {
                if layer == Layer::Alpha {
                    add_shadow(plane, shader, place, self.averaging);
                }
            }
        }
    }

    fn hand_over(&self, band: &mut Self::Band<'_>) {
        band.hand_over();
    }

    fn fit(&self) -> &PatchFit<NODES> {
        &FIT
    }

    fn quantities(&self) -> usize {
        self.asked().count()
    }

    fn tolerance(&self) -> f64 {
        TOLERANCE
    }

    fn angle(&self) -> Option<usize> {
        self.place_of(Quantity::Azimuth)
    }

    #[inline(always)]
    fn evaluate(
        &self,
        shader: &Shader<'_>,
        order: u32,
        u: f64,
        ray: &PlaceRay,
        values: &mut Quantities,
    ) {
        let momentum = shader.geometry.angular_momentum(ray.ray);
        let g = shader.redshift(u, momentum.along);
        *values = self.quantities_of(|quantity| match quantity {
            Quantity::Radius => 1.0 / u,
            Quantity::Azimuth => shader.geometry.azimuth(ray.ray, shader.told(order, ray)),
            Quantity::Redshift => g,
            Quantity::EmissionCosine => emission_cosine(u, momentum.across, momentum.along),
            Quantity::Amplitude => g * g * shader.flux.signed_root(u),
        });
    }

    fn put_stretch(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        stretch: Stretch,
        patch: &Patch<NODES>,
    ) {
        let Stretch {
            order,
            from,
            to,
            place: (x, y),
            ..
        } = stretch;
        let (outer, inner) = shader.u_edges;
        let (least, greatest) = ((1.0 / inner) as f32, (1.0 / outer) as f32);
        let first = stretch.row * band.width;
        for (layer, plane) in band.iter() {
            if matches!(layer, Layer::Sky | Layer::SkyUv) {
                continue;
            }
            let channels = layer.channels();
            let pixels = &mut plane[(first + from) * channels..(first + to) * channels];
            let place = Quantity::of(layer).and_then(|quantity| self.place_of(quantity));
            let Some(place) = place else {
                match layer {
                    Layer::Order if shader.is_in_plane => {
                        for (i, pixel) in pixels.iter_mut().enumerate() {
                            let ray = shader.ray((x + i as f64, y));
                            *pixel = shader.told(order, &ray) as f32;
                        }
                    }
                    Layer::Order => pixels.fill(order as f32),
                    _ => pixels.fill(1.0),
                }
                continue;
            };
            if layer == Layer::Colour {
                if let Some(colours) = self.colours {
                    let parts = colours.parts(patch, self.averaging);
                    let light = colours.of_row((patch, place), (x, y), to - from, parts);
                    let (pixels, _) = pixels.as_chunks_mut::<3>();
                    pixels.copy_from_slice(&light[..pixels.len()]);
                }
                continue;
            }
            patch.row(place, y).fill(x, pixels);
            match layer {
                Layer::Radius => pixels
                    .iter_mut()
                    .for_each(|r| *r = r.max(least).min(greatest)),
                Layer::Azimuth => pixels.iter_mut().for_each(|angle| *angle = turned(*angle)),
                Layer::Temperature => pixels.iter_mut().for_each(|y| *y = self.kelvin(*y)),
                _ => {}
            }
        }
    }

    fn put_pixel(
        &self,
        band: &mut Self::Band<'_>,
        shader: &Shader<'_>,
        order: u32,
        (row, column): (usize, usize),
        place: (f64, f64),
    ) {
        if self.averaging == Averaging::Square && self.layers.has(Layer::Colour) {
            let whole = [Part { order, share: 1.0 }];
            let mixture = Mixture::new(shader, place);
            self.put_mixture(band, (row, column), &whole, &mixture, [0.0; 3]);
            return;
        }
        let pixel = row * band.width + column;
        let ray = shader.ray(place);
        let values = self.quantities_at(shader, order, &ray);
        self.set(band, shader.told(order, &ray), pixel, &values);
    }

    fn put_mixture(
        &self,
        band: &mut Self::Band<'_>,
        (row, column): (usize, usize),
        parts: &[Part],
        mixture: &Mixture<'_>,
        beside: [f32; 3],
    ) {
        let (pixel, shader) = (row * band.width + column, mixture.shader);
        if let Some((order, ray)) = mixture.nearest_covered() {
            let values = self.quantities_at(shader, order, &ray);
            self.set(band, shader.told(order, &ray), pixel, &values);
        }
        let share = parts.iter().map(|part| part.share).sum::<f32>().min(1.0);
        let light = match self.colours {
            Some(colours) if self.layers.has(Layer::Colour) => {
                colours.mixed(parts, mixture, beside)
            }
            _ => [0.0; 3],
        };
        for (layer, plane) in band.iter() {
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
