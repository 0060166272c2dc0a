//! What is looked at: the state that the hand changes. It knows no window and no pixels, and takes the time as a value.

use std::time::{Duration, Instant};

use super::super::controls::Action;
use super::bitmap::Area;
use super::playback::Playback;
use super::shown::Shown;
use crate::scene::{Animation, ImageSize, MAX_EXPOSURE, Navigator, Projection, Scene, SceneError};

/// How far a drag over the picture's height turns about the hole, in degrees.
const TURN: f64 = 180.0;

/// The factor of the distance for one notch of the wheel.
const NOTCH: f64 = 0.9;

/// The orders that are shown one by one.
const ORDERS: u32 = 4;

/// How long the camera must be still before it rests: then the picture is drawn exactly.
const REST: Duration = Duration::from_millis(150);

/// How long a message stays over the picture.
const MESSAGE: Duration = Duration::from_secs(3);

/// The height of the animation's bar, in pixels.
const BAR: usize = 24;

/// What a held mouse button does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Drag {
    Turn,
    Look,
    Seek,
}

/// A mouse button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Button {
    Left,
    Right,
}

/// What a key asks of the window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Request {
    FullScreen,
    SaveScene,
    SavePicture,
    Close,
}

/// What is looked at.
#[derive(Debug)]
pub(super) struct Viewer {
    animation: Animation,
    playback: Playback,
    /// Of the window.
    size: ImageSize,
    /// The frame of the animation, as a picture that fits the window.
    read: Scene,
    navigator: Navigator,
    /// Added to the scene's exposure.
    stops: f64,
    shown: Shown,
    order: Option<u32>,
    /// What `darkness render` draws of what is shown.
    scene: Scene,
    pointer: Option<(f64, f64)>,
    drag: Option<Drag>,
    has_figures: bool,
    has_help: bool,
    fault: Option<String>,
    message: Option<(String, Instant)>,
    /// When the camera moved last, until it rests.
    moved: Option<Instant>,
    has_changed: bool,
}

impl Viewer {
    /// Looks at the first frame of an animation, in a window of some size.
    ///
    /// # Errors
    /// The first frame cannot be.
    pub(super) fn new(animation: Animation, size: ImageSize) -> Result<Self, SceneError> {
        let read = fitted(animation.first_frame()?, size)?;
        let shown = Shown::of(&read);
        Ok(Self {
            playback: Playback::new(&animation),
            animation,
            size,
            navigator: Navigator::new(&read),
            stops: 0.0,
            shown,
            order: None,
            scene: shown.scene(&read.clone().with_camera(*read.camera())?)?,
            read,
            pointer: None,
            drag: None,
            has_figures: false,
            has_help: false,
            fault: None,
            message: None,
            moved: None,
            has_changed: true,
        })
    }

    /// The scene of which `darkness render` draws what is shown.
    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    pub(super) fn shown(&self) -> Shown {
        self.shown
    }

    /// The order that is shown alone.
    pub(super) fn order(&self) -> Option<u32> {
        self.order
    }

    pub(super) fn navigator(&self) -> &Navigator {
        &self.navigator
    }

    pub(super) fn playback(&self) -> &Playback {
        &self.playback
    }

    pub(super) fn has_figures(&self) -> bool {
        self.has_figures
    }

    pub(super) fn has_help(&self) -> bool {
        self.has_help
    }

    /// Where the pointer is, in pixels from the picture's left and top.
    pub(super) fn pointer(&self) -> Option<(f64, f64)> {
        let area = self.area();
        let (x, y) = self.pointer?;
        Some((x - area.left as f64, y - area.top as f64))
    }

    /// The part of the window that the picture takes, in its middle.
    pub(super) fn area(&self) -> Area {
        let ImageSize { width, height } = self.scene.image();
        Area {
            left: (self.size.width - width) as usize / 2,
            top: (self.size.height - height) as usize / 2,
            width: width as usize,
            height: height as usize,
        }
    }

    /// The window's size.
    pub(super) fn size(&self) -> ImageSize {
        self.size
    }

    /// What is written over the picture: what is wrong, or what has been done.
    pub(super) fn message(&self) -> Option<&str> {
        let message = self.message.as_ref().map(|(text, _)| text.as_str());
        self.fault.as_deref().or(message)
    }

    /// The stops that were added to the scene's exposure.
    pub(super) fn stops(&self) -> f64 {
        self.stops
    }

    /// Whether the camera moves: frames may be coarser than at rest.
    pub(super) fn is_moving(&self) -> bool {
        self.moved.is_some() || self.playback.is_playing()
    }

    /// Returns whether the picture has changed since the last call.
    pub(super) fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// The animation's bar, where it is shown: while the animation plays, and while the pointer is near.
    pub(super) fn bar(&self) -> Option<Area> {
        let (width, height) = (self.size.width as usize, self.size.height as usize);
        let area = Area {
            left: 0,
            top: height.saturating_sub(BAR),
            width,
            height: BAR,
        };
        let near = Area {
            top: height.saturating_sub(3 * BAR),
            height: 3 * BAR,
            ..area
        };
        let is_near = self.pointer.is_some_and(|pointer| near.contains(pointer));
        let is_shown = self.playback.is_playing()
            || self.drag == Some(Drag::Seek)
            || is_near && self.drag.is_none();
        (self.playback.has_frames() && is_shown).then_some(area)
    }

    /// Changes the window's size.
    pub(super) fn resize(&mut self, size: ImageSize) {
        if size == self.size {
            return;
        }
        match fitted(self.read.clone(), size) {
            Ok(read) => {
                self.size = size;
                self.read = read;
                self.update();
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Moves the pointer, and what is dragged with it.
    pub(super) fn point(&mut self, to: (f64, f64), now: Instant) {
        let bar = self.bar();
        let from = self.pointer.replace(to).unwrap_or(to);
        let (right, down) = (to.0 - from.0, to.1 - from.1);
        let per_pixel = 1.0 / f64::from(self.size.height);
        match self.drag {
            _ if right == 0.0 && down == 0.0 => {}
            Some(Drag::Turn) => {
                let turn = TURN * per_pixel;
                self.steer(now, |navigator| navigator.turn(turn * right, turn * down));
            }
            Some(Drag::Look) => {
                let turn = self.navigator.fov_degrees() * per_pixel;
                self.steer(now, |navigator| navigator.look(-turn * right, -turn * down));
            }
            Some(Drag::Seek) => self.seek(now),
            None => self.has_changed |= self.has_figures || bar != self.bar(),
        }
    }

    /// The pointer leaves the window.
    pub(super) fn leave(&mut self) {
        let bar = self.bar();
        if self.drag.is_none() {
            self.pointer = None;
            self.has_changed |= self.has_figures || bar != self.bar();
        }
    }

    /// Presses or releases a button.
    pub(super) fn press(&mut self, button: Button, is_pressed: bool, now: Instant) {
        let is_on_bar = self.bar().zip(self.pointer);
        let is_on_bar = is_on_bar.is_some_and(|(bar, pointer)| bar.contains(pointer));
        self.drag = match (button, is_pressed) {
            (_, false) => None,
            (Button::Left, true) if is_on_bar => Some(Drag::Seek),
            (Button::Left, true) => Some(Drag::Turn),
            (Button::Right, true) => Some(Drag::Look),
        };
        if self.drag == Some(Drag::Seek) {
            self.seek(now);
        }
    }

    /// Turns the wheel, away from the hand where `notches` is positive: the camera comes nearer.
    pub(super) fn roll(&mut self, notches: f64, now: Instant) {
        self.steer(now, |navigator| {
            navigator.zoom(libm::pow(NOTCH, notches));
        });
    }

    /// Does what a key asks for, or returns what it asks of the window.
    pub(super) fn act(&mut self, action: Action, now: Instant) -> Option<Request> {
        match action {
            Action::ScaleFov(factor) => self.steer(now, |navigator| navigator.scale_fov(factor)),
            Action::Expose(stops) => {
                let exposure = self.read.exposure() + self.stops + stops;
                if exposure.abs() <= MAX_EXPOSURE {
                    self.stops += stops;
                }
                self.update();
            }
            Action::ShowNext => self.show(self.shown.after(&self.read, 1)),
            Action::ShowPrevious => self.show(self.shown.before(&self.read)),
            Action::NextOrder => {
                self.order = match self.order {
                    None if self.read.disk().is_none() => None,
                    None => Some(0),
                    Some(order) => Some(order + 1).filter(|&order| order < ORDERS),
                };
                let name = match self.order {
                    None => "all orders".into(),
                    Some(order) => format!("order {order} alone"),
                };
                self.tell(name, now);
            }
            Action::Play => {
                self.playback.toggle(now);
                if !self.playback.has_frames() {
                    self.tell("this scene has no animation".into(), now);
                }
                if self.playback.is_playing() {
                    self.show_frame();
                }
                self.has_changed = true;
            }
            Action::Reset => {
                self.stops = 0.0;
                self.order = None;
                self.shown = Shown::of(&self.read);
                self.playback.stop();
                self.show_frame();
            }
            Action::Help => {
                self.has_help ^= true;
                self.has_changed = true;
            }
            Action::Figures => {
                self.has_figures ^= true;
                self.has_changed = true;
            }
            Action::FullScreen => return Some(Request::FullScreen),
            Action::SaveScene => return Some(Request::SaveScene),
            Action::SavePicture => return Some(Request::SavePicture),
            Action::Close => return Some(Request::Close),
        }
        None
    }

    /// Turns the camera a little, to measure frames.
    pub(super) fn turn_to_measure(&mut self) {
        self.navigator.turn(1.0, 0.25);
        self.update();
    }

    /// Lets the time pass: the animation goes on, messages go, the camera comes to rest.
    pub(super) fn pass(&mut self, now: Instant) {
        if self.playback.advance(now) {
            self.show_frame();
        }
        if self.moved.is_some_and(|moved| now >= moved + REST) {
            self.moved = None;
            self.has_changed = true;
        }
        if self
            .message
            .as_ref()
            .is_some_and(|&(_, until)| now >= until)
        {
            self.message = None;
            self.has_changed = true;
        }
    }

    /// When [`Self::pass`] has something to do next.
    pub(super) fn next(&self, now: Instant) -> Option<Instant> {
        let rest = self.moved.map(|moved| moved + REST);
        let message = self.message.as_ref().map(|&(_, until)| until);
        let frame = self.playback.next(now);
        rest.into_iter().chain(message).chain(frame).min()
    }

    /// Takes the scene's file as it is read again. A camera that was moved stays where it can.
    pub(super) fn reload(&mut self, read: Result<Animation, SceneError>, now: Instant) {
        let scene = |animation: &Animation| {
            let mut playback = Playback::new(animation);
            playback.go_to(self.playback.frame());
            let scene = fitted(animation.frame(playback.frame())?, self.size)?;
            Ok::<_, SceneError>((playback, scene))
        };
        match read.and_then(|animation| scene(&animation).map(|read| (animation, read))) {
            Ok((animation, (playback, read))) => {
                let follows = self.shown == Shown::of(&self.read);
                let navigator = self.navigator.carried_to(&read);
                self.animation = animation;
                self.playback = playback;
                self.read = read;
                self.navigator = navigator;
                if follows || self.shown.scene(&self.read).is_err() {
                    self.shown = Shown::of(&self.read);
                }
                self.fault = None;
                self.tell("the scene was read again".into(), now);
                self.update();
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Writes what has been done over the picture for a while.
    pub(super) fn tell(&mut self, text: String, now: Instant) {
        self.message = Some((text, now + MESSAGE));
        self.has_changed = true;
    }

    /// Writes what is wrong over the picture, until the scene is read again.
    pub(super) fn fail(&mut self, text: String) {
        self.fault = Some(text);
        self.has_changed = true;
    }

    fn show(&mut self, shown: Shown) {
        self.shown = shown;
        self.update();
    }

    /// Moves the camera. An animation stops: its own camera has gone.
    fn steer(&mut self, now: Instant, change: impl FnOnce(&mut Navigator)) {
        self.playback.stop();
        let before = self.navigator.clone();
        change(&mut self.navigator);
        if self.navigator != before {
            self.moved = Some(now);
            self.update();
        }
    }

    /// Goes to the frame of the animation that the pointer is at.
    fn seek(&mut self, now: Instant) {
        if let Some((x, _)) = self.pointer {
            let before = self.playback.frame();
            let last = f64::from(self.size.width.max(2) - 1);
            self.playback.seek(x / last);
            if self.playback.frame() != before {
                self.moved = Some(now);
            }
            self.show_frame();
        }
    }

    /// Takes the scene and the camera of the animation's frame.
    fn show_frame(&mut self) {
        let frame = self.animation.frame(self.playback.frame());
        match frame.and_then(|frame| fitted(frame, self.size)) {
            Ok(read) => {
                self.navigator = Navigator::new(&read);
                self.read = read;
                self.update();
            }
            Err(error) => {
                self.playback.stop();
                self.fail(error.to_string());
            }
        }
    }

    /// Makes the scene of what is shown. Where there is none, the last one stays.
    fn update(&mut self) {
        let camera = self.read.clone().with_camera(self.navigator.camera());
        let shown = camera.and_then(|scene| {
            let scene = self.shown.scene(&scene)?;
            if scene.shows_colour() && self.stops != 0.0 {
                let exposure = scene.exposure() + self.stops;
                return scene.with_exposure(exposure);
            }
            Ok(scene)
        });
        match shown {
            Ok(scene) => self.scene = scene,
            Err(error) => self.fail(error.to_string()),
        }
        self.has_changed = true;
    }
}

/// Returns the scene as the largest picture that fits a window: the whole sphere is twice as wide as high. A picture of
/// which only a part is drawn is shown as a whole.
fn fitted(scene: Scene, window: ImageSize) -> Result<Scene, SceneError> {
    let ImageSize { width, height } = window;
    let scene = scene.with_crop(None)?;
    if scene.camera().projection == Projection::Equirectangular {
        let height = height.min(width / 2);
        return scene.with_size(2 * height, height);
    }
    scene.with_size(width, height)
}

#[cfg(test)]
mod tests;
