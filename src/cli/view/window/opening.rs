//! Opens the window.

use std::rc::Rc;

use softbuffer::{Context, Surface};
use winit::dpi::PhysicalSize;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::Window;

use crate::scene::ImageSize;

/// The share of a display's side that a window takes at most, unless its size is given.
const MOST_OF_DISPLAY: f64 = 0.9;

/// The window that is open, and its pixels.
pub(super) struct OpenWindow {
    pub(super) window: Rc<Window>,
    pub(super) surface: Surface<OwnedDisplayHandle, Rc<Window>>,
}

impl OpenWindow {
    /// Opens the window.
    ///
    /// # Errors
    /// The display refuses it.
    pub(super) fn new(
        title: &str,
        size: ImageSize,
        event_loop: &ActiveEventLoop,
        context: &Context<OwnedDisplayHandle>,
    ) -> anyhow::Result<Self> {
        let attributes = Window::default_attributes()
            .with_title(title)
            .with_inner_size(PhysicalSize::new(size.width, size.height));
        let window = Rc::new(event_loop.create_window(attributes)?);
        let surface = Surface::new(context, Rc::clone(&window));
        let surface = surface.map_err(|error| anyhow::anyhow!("{error}"))?;
        Ok(Self { window, surface })
    }
}

/// Returns the size of a window for a picture: the picture's, if the display has room for it.
pub(super) fn size(picture: ImageSize, event_loop: &ActiveEventLoop) -> ImageSize {
    let display = event_loop
        .primary_monitor()
        .or_else(|| event_loop.available_monitors().next());
    display.map_or(picture, |display| fitted(picture, display.size()))
}

/// Returns the largest size of the same shape that a display has room for, and not larger than the picture.
fn fitted(size: ImageSize, display: PhysicalSize<u32>) -> ImageSize {
    let share = |display: u32, side: u32| MOST_OF_DISPLAY * f64::from(display) / f64::from(side);
    let scale = share(display.width, size.width)
        .min(share(display.height, size.height))
        .min(1.0);
    let side = |side: u32| ((scale * f64::from(side)) as u32).max(1);
    ImageSize {
        width: side(size.width),
        height: side(size.height),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_as_large_as_its_picture_or_as_the_display_has_room_for() {
        let fitted = |width, height| {
            let ImageSize { width, height } =
                fitted(ImageSize { width, height }, PhysicalSize::new(1000, 500));
            (width, height)
        };
        assert_eq!(fitted(640, 360), (640, 360));
        assert_eq!(fitted(1920, 1080), (800, 450));
        assert_eq!(fitted(1800, 100), (900, 50));
        assert_eq!(fitted(1_000_000, 1), (900, 1));
    }
}
