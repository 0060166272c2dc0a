//! The window and its events.
//!
//! It hands what the hand does to the [`viewer`], which knows no window and says which scene is looked at; the
//! [`painter`] draws it with the renderer that all pictures are drawn with, and the [`overlay`] writes over it.

mod bitmap;
mod false_colour;
mod measure;
mod opening;
mod overlay;
mod pace;
mod painter;
mod playback;
mod pointed;
mod save;
mod shown;
mod text;
mod viewer;
mod watch;

use std::num::NonZero;
use std::time::{Duration, Instant};

use softbuffer::Context;
use winit::application::ApplicationHandler;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, OwnedDisplayHandle};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Fullscreen, WindowId};

use super::super::method::MethodArgs;
use super::super::progress::Report;
use super::super::stdio::print;
use super::super::threads::start_threads;
use super::ViewArgs;
use super::controls::{self, Action};
use crate::scene::{Animation, ImageSize, builtins};
use bitmap::Bitmap;
use measure::Measure;
use opening::OpenWindow;
use overlay::{Measured, Overlay};
use pace::{Coarseness, Pace};
use painter::{Look, Methods, ViewPainter};
use pointed::pointed;
use viewer::{Button, Request, Viewer};
use watch::SceneWatch;

/// The pixels of a touchpad that count as a notch of a wheel.
const NOTCH: f64 = 40.0;

/// Frames that are farther apart belong to different movements.
const PAUSE: Duration = Duration::from_millis(250);

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// A scene, a table or a sky that cannot be read, or no display.
pub(super) fn run(args: &ViewArgs, report: Report) -> anyhow::Result<()> {
    let animation = Animation::load_with(&args.scene, &args.set)?;
    let size = args.size.unwrap_or_else(|| animation.image());
    let viewer = Viewer::new(animation, size)?;
    let no_display = || {
        anyhow::anyhow!(
            "there is no display to open a window on: neither WAYLAND_DISPLAY nor DISPLAY names one that answers; \
             `darkness render` draws pictures without one"
        )
    };
    let event_loop = EventLoop::new().map_err(|_| no_display())?;
    let context = Context::new(event_loop.owned_display_handle());
    let context = context.map_err(|_| no_display())?;
    start_threads(args.threads.threads)?;
    let methods = Methods::new(MethodArgs::of_table(args.table.clone()), report);
    let mut painter = ViewPainter::new(&methods);
    // What cannot be read is told before a window opens.
    painter.draw_as(viewer.scene(), viewer.shown().form(), |_, _| Ok(()))?;
    let is_builtin = |name: &str| builtins().iter().any(|builtin| builtin.name() == name);
    let is_file = !args.scene.to_str().is_some_and(is_builtin);
    let mut app = ViewApp {
        args,
        report,
        viewer,
        painter,
        pace: Pace::default(),
        overlay: Overlay::new(1.0),
        watch: is_file
            .then(|| SceneWatch::new(&args.scene, Instant::now()))
            .flatten(),
        measure: args.frames.map(Measure::new),
        context,
        open: None,
        rate: None,
        last_drawn: None,
        fault: None,
        pointed: None,
        picture: Vec::new(),
        outcome: Ok(()),
    };
    event_loop.run_app(&mut app)?;
    app.outcome?;
    if let Some(measure) = &app.measure {
        let scene = args.scene.display();
        print(&measure.report(
            &scene,
            app.viewer.scene().image(),
            rayon::current_num_threads(),
        ))?;
    }
    Ok(())
}

/// The program while its window is open.
struct ViewApp<'a> {
    args: &'a ViewArgs,
    report: Report,
    viewer: Viewer,
    painter: ViewPainter<'a>,
    pace: Pace,
    overlay: Overlay,
    watch: Option<SceneWatch>,
    measure: Option<Measure>,
    context: Context<OwnedDisplayHandle>,
    open: Option<OpenWindow>,
    /// Frames a second of the present movement.
    rate: Option<f64>,
    last_drawn: Option<Instant>,
    /// Why the picture could not be drawn.
    fault: Option<String>,
    /// What the pointer is over.
    pointed: Option<String>,
    /// A picture that is smaller than the window.
    picture: Vec<u32>,
    outcome: anyhow::Result<()>,
}

impl ApplicationHandler for ViewApp<'_> {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_some() {
            return;
        }
        let size = match self.args.size {
            Some(size) => size,
            None => opening::size(self.viewer.size(), event_loop),
        };
        match OpenWindow::new(&self.title(), size, event_loop, &self.context) {
            Ok(open) => {
                self.overlay = Overlay::new(open.window.scale_factor());
                let size = open.window.inner_size();
                self.open = Some(open);
                self.resize(size);
                self.ask_for_frame();
            }
            Err(error) => self.end(event_loop, Err(error)),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let now = Instant::now();
        match event {
            WindowEvent::CloseRequested => self.end(event_loop, Ok(())),
            WindowEvent::Resized(size) => self.resize(size),
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => {
                self.overlay = Overlay::new(scale_factor);
            }
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.draw(event_loop) {
                    self.end(event_loop, Err(error));
                }
            }
            WindowEvent::CursorMoved { position, .. } => self.point(position, now),
            WindowEvent::CursorLeft { .. } => {
                self.viewer.leave();
                self.name();
            }
            WindowEvent::MouseInput { state, button, .. } => {
                let button = match button {
                    MouseButton::Left => Button::Left,
                    MouseButton::Right => Button::Right,
                    _ => return,
                };
                self.viewer.press(button, state.is_pressed(), now);
            }
            WindowEvent::MouseWheel { delta, .. } => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => lines.into(),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / NOTCH,
                };
                self.viewer.roll(notches, now);
            }
            WindowEvent::KeyboardInput {
                event,
                is_synthetic: false,
                ..
            } => {
                if let Some(action) = action(&event) {
                    self.act(action, event_loop, now);
                }
            }
            _ => {}
        }
        self.ask_for_frame();
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        if self
            .watch
            .as_mut()
            .is_some_and(|watch| watch.has_changed(now))
        {
            let read = Animation::load_with(&self.args.scene, &self.args.set);
            let sky = read
                .as_ref()
                .map_or(Ok(()), |read| self.painter.read(read.sky()));
            match sky {
                Ok(()) => self.viewer.reload(read, now),
                Err(error) => self.viewer.fail(error.to_string()),
            }
        }
        self.viewer.pass(now);
        self.ask_for_frame();
        let watch = self.watch.as_ref().map(SceneWatch::next);
        let next = self.viewer.next(now).into_iter().chain(watch).min();
        event_loop.set_control_flow(next.map_or(ControlFlow::Wait, ControlFlow::WaitUntil));
    }
}

impl ViewApp<'_> {
    /// Ends the program when the events of now are done.
    fn end(&mut self, event_loop: &ActiveEventLoop, outcome: anyhow::Result<()>) {
        self.outcome = outcome;
        event_loop.exit();
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        let (Some(width), Some(height)) = (NonZero::new(size.width), NonZero::new(size.height))
        else {
            return;
        };
        if let Some(open) = &mut self.open
            && let Err(error) = open.surface.resize(width, height)
        {
            self.fault = Some(error.to_string());
        }
        self.viewer.resize(ImageSize {
            width: size.width,
            height: size.height,
        });
    }

    fn point(&mut self, position: PhysicalPosition<f64>, now: Instant) {
        self.viewer.point((position.x, position.y), now);
        self.name();
    }

    /// Tells in the window's title what the pointer is over.
    fn name(&mut self) {
        let pointer = self.viewer.pointer();
        let told = pointer.and_then(|pointer| pointed(self.viewer.scene(), pointer));
        if told != self.pointed {
            self.pointed = told;
            if let Some(open) = &self.open {
                open.window.set_title(&self.title());
            }
        }
    }

    fn title(&self) -> String {
        let scene = self.args.scene.display();
        match &self.pointed {
            Some(pointed) => format!("{scene}: {pointed}"),
            None => format!("{scene}: darkness"),
        }
    }

    /// Asks for a frame where the picture has changed.
    fn ask_for_frame(&mut self) {
        let is_measuring = self
            .measure
            .as_ref()
            .is_some_and(|measure| !measure.is_done());
        if let Some(open) = &self.open
            && (self.viewer.take_change() || is_measuring)
        {
            open.window.request_redraw();
        }
    }

    fn act(&mut self, action: Action, event_loop: &ActiveEventLoop, now: Instant) {
        match self.viewer.act(action, now) {
            Some(Request::Close) => self.end(event_loop, Ok(())),
            Some(Request::FullScreen) => {
                if let Some(OpenWindow { window, .. }) = &self.open {
                    let full = window.fullscreen().is_none();
                    window.set_fullscreen(full.then_some(Fullscreen::Borderless(None)));
                }
            }
            Some(Request::SaveScene) => self.saved(save::scene(self.viewer.scene()), now),
            Some(Request::SavePicture) => {
                let look = look(&self.viewer, None);
                let saved = save::picture(look, self.args.picture_format, &mut self.painter);
                self.saved(saved, now);
            }
            None => {}
        }
    }

    /// Tells which file was written, or why none was.
    fn saved(&mut self, saved: anyhow::Result<std::path::PathBuf>, now: Instant) {
        let text = match saved {
            Ok(path) => path.display().to_string(),
            Err(error) => error.to_string(),
        };
        self.report.note(&text);
        self.viewer.tell(text, now);
    }

    /// Draws the picture and shows it.
    fn draw(&mut self, event_loop: &ActiveEventLoop) -> anyhow::Result<()> {
        let failed = |error: softbuffer::SoftBufferError| {
            anyhow::anyhow!("the window cannot be drawn into: {error}")
        };
        if let Some(measure) = &mut self.measure {
            self.viewer.turn_to_measure();
            measure.begin();
        }
        self.name();
        let Some(OpenWindow { window, surface }) = &mut self.open else {
            return Ok(());
        };
        let start = Instant::now();
        let coarseness = match &self.measure {
            Some(_) => Some(Coarseness::FULL),
            None if self.viewer.is_moving() => Some(self.pace.coarseness()),
            None => None,
        };
        let mut buffer = surface.buffer_mut().map_err(failed)?;
        if let Some(measure) = &mut self.measure {
            measure.shown();
        }
        let look = look(&self.viewer, coarseness);
        let (area, size) = (self.viewer.area(), self.viewer.size());
        let is_whole = area.width * area.height == buffer.len();
        let painted = if is_whole {
            self.painter.paint(look, &mut buffer)
        } else {
            buffer.fill(0);
            self.picture.resize(area.width * area.height, 0);
            self.painter.paint(look, &mut self.picture)
        };
        self.fault = painted.err().map(|error| error.to_string());
        let mut bitmap = Bitmap::new(&mut buffer, size.width as usize);
        if self.fault.is_some() {
            bitmap.fill(bitmap.whole(), 0);
        } else if !is_whole {
            bitmap.copy(area, &self.picture);
        }
        let rate = self.rate.filter(|_| coarseness.is_some());
        let measured = Measured {
            rate,
            coarseness: coarseness.unwrap_or(Coarseness::FULL),
            scale: self.painter.scale(),
            pointed: self.pointed.as_deref(),
            fault: self.fault.as_deref(),
        };
        self.overlay.write(&self.viewer, &measured, &mut bitmap);
        window.pre_present_notify();
        buffer.present().map_err(failed)?;
        let end = Instant::now();
        if coarseness.is_some() {
            self.pace.drawn(end - start);
        } else {
            self.pace.rested();
        }
        let since = self.last_drawn.replace(end).map(|last| end - last);
        self.rate = since.filter(|&since| since < PAUSE).map(|since| {
            let now = 1.0 / since.as_secs_f64();
            self.rate.map_or(now, |rate| 0.9 * rate + 0.1 * now)
        });
        if self.measure.as_ref().is_some_and(Measure::is_done) {
            self.end(event_loop, Ok(()));
        }
        Ok(())
    }
}

/// What the viewer looks at.
fn look(viewer: &Viewer, coarseness: Option<Coarseness>) -> Look<'_> {
    Look {
        scene: viewer.scene(),
        shown: viewer.shown(),
        order: viewer.order(),
        coarseness,
    }
}

/// What a pressed key asks for. A key that is held asks again only where more of it makes sense.
fn action(event: &KeyEvent) -> Option<Action> {
    if event.state == ElementState::Released {
        return None;
    }
    let typed = match &event.logical_key {
        Key::Named(NamedKey::Space) => ' ',
        Key::Character(text) => text.chars().next()?,
        _ => return None,
    };
    let action = controls::action(typed)?;
    let repeats = matches!(action, Action::ScaleFov(_) | Action::Expose(_));
    (repeats || !event.repeat).then_some(action)
}
