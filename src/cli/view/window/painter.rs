//! What is looked at becomes a window's pixels, by the renderer that all pictures are drawn with.

use std::cell::OnceCell;
use std::sync::Arc;

use bytesize::ByteSize;
use rayon::prelude::*;

use super::super::super::method::{Method, MethodArgs};
use super::super::super::progress::Report;
use super::super::super::render::read_sky;
use super::bitmap::colour;
use super::false_colour::ColourScale;
use super::pace::Coarseness;
use super::shown::Shown;
use crate::orbit::exact::Exact;
use crate::orbit::path::SweptAngles;
use crate::render::needs::Needs;
use crate::render::{Form, FrameMemory, Pixels, Plane, RenderError, Renderer};
use crate::scene::{Layer, LayerSet, Scene, Sky, View};
use crate::sky::SkySource;
use crate::table::Spec;

/// The most memory that a sky may take.
const SKY_MEMORY: ByteSize = ByteSize(4 << 30);

/// The pixels of a row that are turned into colours at a time.
const CHUNK: usize = 1 << 14;

/// The methods that scenes need: the built-in tables, coarsest first, and exact curves. Each is opened when it is first
/// needed.
pub(super) struct Methods {
    args: MethodArgs,
    report: Report,
    opened: [OnceCell<Method>; METHODS],
}

/// The number of [`Spec::NAMES`], and one for exact curves.
const METHODS: usize = Spec::NAMES.len() + 1;

impl Methods {
    pub(super) fn new(args: MethodArgs, report: Report) -> Self {
        Self {
            args,
            report,
            opened: Default::default(),
        }
    }

    /// Opens the method at a place, if it is not open yet.
    ///
    /// # Errors
    /// A table that cannot be read or made.
    fn open(&self, place: usize) -> anyhow::Result<&Method> {
        if let Some(method) = self.opened[place].get() {
            return Ok(method);
        }
        let needed = Spec::NAMES.get(place).copied();
        let method = self.args.check(needed)?.ready(self.report)?;
        Ok(self.opened[place].get_or_init(|| method))
    }
}

/// The place of the method with which `darkness render` draws a scene in a form.
fn needed(scene: &Scene, form: Form) -> usize {
    let needs = Needs::new(scene, &View::new(scene), form);
    let table = needs.table().map(|table| table.name);
    let place = table.and_then(|table| Spec::NAMES.iter().position(|&name| name == table));
    place.unwrap_or(METHODS - 1)
}

/// Draws scenes with a renderer of one method.
type Drawer<'a> = Box<dyn FnMut(&Scene, &mut FrameMemory) -> Result<(), RenderError> + 'a>;

fn drawer<'a>(method: &'a Method, sky: Option<&(Sky, Arc<SkySource>)>) -> Drawer<'a> {
    match method {
        Method::Table(table) => drawer_of(Renderer::new(table), sky),
        _ => drawer_of(Renderer::with_angles(Exact), sky),
    }
}

fn drawer_of<'a, A: SweptAngles + 'a>(
    renderer: Renderer<A>,
    sky: Option<&(Sky, Arc<SkySource>)>,
) -> Drawer<'a> {
    let mut renderer = match sky {
        Some((sky, source)) => renderer.with_sky(sky.clone(), Arc::clone(source)),
        None => renderer,
    };
    Box::new(move |scene, memory| renderer.draw(scene, memory).map(|_| ()))
}

/// What is to be drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look<'a> {
    /// Of the window's size, as [`Shown::scene`] makes it.
    pub(super) scene: &'a Scene,
    pub(super) shown: Shown,
    /// The only order that is shown.
    pub(super) order: Option<u32>,
    /// How coarse it is, while the camera moves; `None` at rest: the pixels are those of `darkness render`, to the last
    /// bit.
    pub(super) coarseness: Option<Coarseness>,
}

/// Draws looks.
pub(super) struct ViewPainter<'a> {
    methods: &'a Methods,
    /// The method that was needed last, at rest, and its renderer.
    drawer: Option<(usize, Drawer<'a>)>,
    sky: Option<(Sky, Arc<SkySource>)>,
    memory: FrameMemory,
    orders: FrameMemory,
    /// A frame that is coarser than the window.
    coarse: Vec<u32>,
    colours: Vec<u32>,
    /// The scale of the false colours that were drawn last.
    scale: Option<ColourScale>,
}

impl<'a> ViewPainter<'a> {
    pub(super) fn new(methods: &'a Methods) -> Self {
        Self {
            methods,
            drawer: None,
            sky: None,
            memory: FrameMemory::default(),
            orders: FrameMemory::new(Form::Layers(LayerSet::default().with(Layer::Order))),
            coarse: Vec::new(),
            colours: ColourScale::colours(),
            scale: None,
        }
    }

    /// The scale of the false colours that were drawn last, and its colours.
    pub(super) fn scale(&self) -> Option<(ColourScale, &[u32])> {
        Some((self.scale?, &self.colours))
    }

    /// The method of the last picture at rest.
    pub(super) fn method(&self) -> anyhow::Result<&'a Method> {
        let place = self.drawer.as_ref().map_or(0, |(place, _)| *place);
        self.methods.open(place)
    }

    /// Draws into the window's pixels.
    ///
    /// # Errors
    /// A table or a sky that cannot be read, or not enough memory.
    pub(super) fn paint(&mut self, look: Look<'_>, pixels: &mut [u32]) -> anyhow::Result<()> {
        let size = look.scene.image();
        let (width, height) = (size.width as usize, size.height as usize);
        anyhow::ensure!(
            pixels.len() == width * height,
            "the window changes its size"
        );
        let Some(coarseness) = look.coarseness.filter(|&by| by != Coarseness::FULL) else {
            return self.frame(look, pixels);
        };
        let by = coarseness.reduction;
        let (columns, rows) = (size.width.div_ceil(by), size.height.div_ceil(by));
        let scene = look.scene.clone().with_antialias(false);
        let scene = scene.with_size(columns, rows)?;
        let look = Look {
            scene: &scene,
            ..look
        };
        if by == 1 {
            return self.frame(look, pixels);
        }
        let mut coarse = std::mem::take(&mut self.coarse);
        coarse.resize(columns as usize * rows as usize, 0);
        let drawn = self.frame(look, &mut coarse);
        enlarge(&coarse, columns as usize, pixels, width, by as usize);
        self.coarse = coarse;
        drawn
    }

    /// Draws a frame of the scene's own size.
    fn frame(&mut self, look: Look<'_>, pixels: &mut [u32]) -> anyhow::Result<()> {
        let form = look.shown.form();
        if self.memory.form() != form {
            self.memory = FrameMemory::new(form);
        }
        self.draw(look.scene, form, look.coarseness.is_none())?;
        self.scale = None;
        match (self.memory.pixels(), look.shown) {
            (Pixels::Grey8(bytes), _) => {
                each(pixels, bytes, 1, |grey| u32::from(grey[0]) * 0x0001_0101);
            }
            (Pixels::Rgb8(bytes), _) => {
                each(pixels, bytes, 3, |rgb| colour([rgb[0], rgb[1], rgb[2]]));
            }
            (Pixels::Planes([plane]), Shown::Channel(layer, component)) => {
                let channels = layer.channels();
                let values = plane.values.iter().skip(component).step_by(channels);
                let scale = ColourScale::new(look.scene, layer, values.copied());
                let (colours, nothing) = (&self.colours, layer.nothing());
                each(pixels, &plane.values, channels, |values| {
                    scale.of(colours, values[component], nothing)
                });
                self.scale = Some(scale);
            }
            _ => {}
        }
        if let Some(order) = look.order.filter(|_| look.scene.disk().is_some())
            && let Some((_, drawer)) = &mut self.drawer
        {
            drawer(look.scene, &mut self.orders)?;
            if let Pixels::Planes([Plane { values, .. }]) = self.orders.pixels() {
                for (pixel, &seen) in pixels.iter_mut().zip(values) {
                    if seen != order as f32 {
                        *pixel = 0;
                    }
                }
            }
        }
        Ok(())
    }

    /// Reads the sky, if it is not the one that was read last.
    ///
    /// # Errors
    /// A file that cannot be read; the last sky stays.
    pub(super) fn read(&mut self, sky: Option<&Sky>) -> anyhow::Result<()> {
        if let Some(sky) = sky
            && self.sky.as_ref().is_none_or(|(read, _)| read != sky)
        {
            let source = read_sky(sky, 0, SKY_MEMORY, self.methods.report)?;
            self.sky = Some((sky.clone(), Arc::new(source)));
            self.drawer = None;
        }
        Ok(())
    }

    /// Draws a scene into the memory. At rest it is drawn as `darkness render` draws it: with the table that it needs,
    /// and with curves of its own, where a moving camera's may be more accurate ones of a frame before.
    fn draw(&mut self, scene: &Scene, form: Form, is_at_rest: bool) -> anyhow::Result<()> {
        self.read(scene.sky().filter(|_| form.shows_light()))?;
        if is_at_rest || self.drawer.is_none() {
            let place = needed(scene, form);
            let method = self.methods.open(place)?;
            self.drawer = Some((place, drawer(method, self.sky.as_ref())));
        }
        if let Some((_, drawer)) = &mut self.drawer {
            drawer(scene, &mut self.memory)?;
        }
        Ok(())
    }

    /// Draws a scene in a form of its own, as `darkness render` draws it, and calls `take` with it.
    ///
    /// # Errors
    /// Those of [`Self::paint`] and of `take`.
    pub(super) fn draw_as<T>(
        &mut self,
        scene: &Scene,
        form: Form,
        take: impl FnOnce(Pixels<'_>, &Method) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        self.memory = FrameMemory::new(form);
        self.draw(scene, form, true)?;
        take(self.memory.pixels(), self.method()?)
    }
}

/// Makes each pixel of its samples, on all threads.
fn each<T: Sync>(
    pixels: &mut [u32],
    samples: &[T],
    of_pixel: usize,
    make: impl Fn(&[T]) -> u32 + Sync,
) {
    let parts = pixels
        .par_chunks_mut(CHUNK)
        .zip(samples.par_chunks(CHUNK * of_pixel));
    parts.for_each(|(pixels, samples)| {
        for (pixel, samples) in pixels.iter_mut().zip(samples.chunks_exact(of_pixel)) {
            *pixel = make(samples);
        }
    });
}

/// Makes `by` × `by` pixels of each of a coarse frame's; what is beyond the picture's edges is cut off.
fn enlarge(coarse: &[u32], columns: usize, pixels: &mut [u32], width: usize, by: usize) {
    let bands = pixels
        .par_chunks_mut(by * width)
        .zip(coarse.par_chunks(columns));
    bands.for_each(|(band, row)| {
        let (first, rest) = band.split_at_mut(width.min(band.len()));
        for (pixels, &value) in first.chunks_mut(by).zip(row) {
            pixels.fill(value);
        }
        for copy in rest.chunks_mut(width) {
            copy.copy_from_slice(first);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Navigator;
    use crate::table::Table;

    const SIZE: (u32, u32) = (65, 34);

    /// Calls `body` with a painter whose table is the standard one.
    fn with_painter(body: impl FnOnce(&mut ViewPainter<'_>, &Table)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("standard.table");
        let table = Table::generate(&Spec::standard()).unwrap();
        table.save(&path).unwrap();
        let methods = Methods::new(MethodArgs::of_table(Some(path)), Report::new(true));
        body(&mut ViewPainter::new(&methods), &table);
    }

    fn scene(name: &str, (width, height): (u32, u32)) -> Scene {
        let scene = Scene::builtin(name).unwrap();
        scene.with_size(width, height).unwrap()
    }

    fn look(scene: &Scene, coarseness: Option<Coarseness>) -> Look<'_> {
        Look {
            scene,
            shown: Shown::of(scene),
            order: None,
            coarseness,
        }
    }

    /// The colours of a scene's picture, by a renderer of its own.
    fn rendered(table: &Table, scene: &Scene) -> Vec<u32> {
        let picture = Renderer::new(table).render_rgb(scene).unwrap();
        picture.pixels().map(|pixel| colour(pixel.0)).collect()
    }

    #[test]
    fn at_rest_it_draws_what_a_renderer_of_its_own_draws() {
        with_painter(|painter, table| {
            let mut pixels = vec![0; (SIZE.0 * SIZE.1) as usize];
            let wide = scene("lit", SIZE);
            let mut navigator = Navigator::new(&wide);
            for step in 0..5 {
                // Curves of narrow views are more accurate ones.
                navigator.scale_fov(if step < 3 { 0.3 } else { 4.0 });
                let scene = wide.clone().with_camera(navigator.camera()).unwrap();
                for coarseness in [Some(Coarseness::FULL), None] {
                    painter
                        .paint(look(&scene, coarseness), &mut pixels)
                        .unwrap();
                }
                assert!(pixels == rendered(table, &scene), "{step}");
            }
            let stars = scene("stars", SIZE);
            painter.paint(look(&stars, None), &mut pixels).unwrap();
            assert!(pixels == rendered(table, &stars));
            assert!(painter.paint(look(&stars, None), &mut pixels[1..]).is_err());
        });
    }

    #[test]
    fn a_coarse_frame_is_enlarged_over_the_whole_window() {
        with_painter(|painter, table| {
            let whole = scene("lit", SIZE);
            let (width, height) = (SIZE.0 as usize, SIZE.1 as usize);
            for by in 1..=4 {
                let mut pixels = vec![7; width * height];
                let coarseness = Coarseness {
                    reduction: by,
                    is_smooth: false,
                };
                let look = look(&whole, Some(coarseness));
                painter.paint(look, &mut pixels).unwrap();
                let (columns, rows) = (SIZE.0.div_ceil(by), SIZE.1.div_ceil(by));
                let hard = scene("lit", (columns, rows)).with_antialias(false);
                let coarse = rendered(table, &hard);
                for (place, &pixel) in pixels.iter().enumerate() {
                    let (x, y) = (place % width / by as usize, place / width / by as usize);
                    assert_eq!(pixel, coarse[y * columns as usize + x], "{by}: {place}");
                }
            }
        });
    }

    #[test]
    fn a_sky_that_cannot_be_read_leaves_the_last_one() {
        with_painter(|painter, _| {
            let stars = scene("stars", SIZE);
            painter.read(stars.sky()).unwrap();
            let missing = Sky {
                panorama: Some(crate::scene::SkyFile::new("no such file.png")),
                ..Sky::default()
            };
            let error = painter.read(Some(&missing)).unwrap_err().to_string();
            assert!(error.contains("no such file.png"), "{error}");
            assert_eq!(painter.sky.as_ref().map(|(sky, _)| sky), stars.sky());
        });
    }
}
