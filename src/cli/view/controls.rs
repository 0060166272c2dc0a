//! What the mouse and the keys do: one table, for the window, its help and the command's.

use std::fmt::Write as _;

/// What a key asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Action {
    /// Multiplies the tangent of half the field of view.
    ScaleFov(f64),
    /// Adds stops to the exposure.
    Expose(f64),
    /// Shows the next quantity, or the one before.
    ShowNext,
    ShowPrevious,
    /// Shows one image order alone: the next, or all again.
    NextOrder,
    Play,
    FullScreen,
    Reset,
    Help,
    Figures,
    SaveScene,
    SavePicture,
    Close,
}

/// A mouse movement or keys, and what they do.
pub(super) struct Control {
    pub(super) input: &'static str,
    pub(super) effect: &'static str,
    #[cfg_attr(
        not(feature = "view"),
        expect(dead_code, reason = "only the window takes keys")
    )]
    keys: &'static [(char, Action)],
}

/// The controls in the order of the help.
pub(super) const CONTROLS: [Control; 16] = [
    mouse(
        "drag",
        "turn about the hole: azimuth and inclination, over the poles too",
    ),
    mouse("wheel", "move in and out"),
    mouse("right drag", "look aside"),
    keys(
        "[ ]",
        "a narrower, a wider field of view",
        &[
            ('[', Action::ScaleFov(1.0 / FOV_STEP)),
            (']', Action::ScaleFov(FOV_STEP)),
        ],
    ),
    keys(
        ", .",
        "less, more exposure: a quarter of a stop",
        &[
            (',', Action::Expose(-EXPOSURE_STEP)),
            ('.', Action::Expose(EXPOSURE_STEP)),
        ],
    ),
    keys(
        "L",
        "the next of mask, light and each layer in false colour; Shift+L: back",
        &[('l', Action::ShowNext), ('L', Action::ShowPrevious)],
    ),
    keys(
        "O",
        "one order of the image alone: 0, 1, 2, 3, then all again",
        &[('o', Action::NextOrder)],
    ),
    keys(
        "Space",
        "play the scene's animation, or stop it",
        &[(' ', Action::Play)],
    ),
    mouse(
        "drag bar",
        "choose a frame of the animation; the bar is at the lower edge",
    ),
    keys(
        "F",
        "full screen, or a window again",
        &[('f', Action::FullScreen)],
    ),
    keys(
        "R",
        "reset: the scene as it was read",
        &[('r', Action::Reset)],
    ),
    keys(
        "I",
        "figures: frames a second, radius, inclination, field of view",
        &[('i', Action::Figures)],
    ),
    keys("H", "this help", &[('h', Action::Help)]),
    keys(
        "S",
        "save the view as a scene: view-0001.toml, counting on",
        &[('s', Action::SaveScene)],
    ),
    keys(
        "P",
        "save the picture: view-0001.png, counting on",
        &[('p', Action::SavePicture)],
    ),
    keys("Q", "close the window", &[('q', Action::Close)]),
];

/// How far a key changes the tangent of half the field of view.
const FOV_STEP: f64 = 1.1;

/// How far a key changes the exposure, in stops.
const EXPOSURE_STEP: f64 = 0.25;

const fn mouse(input: &'static str, effect: &'static str) -> Control {
    keys(input, effect, &[])
}

const fn keys(
    input: &'static str,
    effect: &'static str,
    keys: &'static [(char, Action)],
) -> Control {
    Control {
        input,
        effect,
        keys,
    }
}

/// Returns what a typed character asks for. With the shift key or without makes a difference only where the table has
/// both.
#[cfg(feature = "view")]
pub(super) fn action(typed: char) -> Option<Action> {
    let find = |typed| {
        let mut all = CONTROLS.iter().flat_map(|control| control.keys);
        all.find_map(|&(key, action)| (key == typed).then_some(action))
    };
    find(typed).or_else(|| find(typed.to_ascii_lowercase()))
}

/// Returns the lines of the help: each input and what it does.
pub(super) fn lines() -> impl Iterator<Item = String> {
    let width = CONTROLS.iter().map(|control| control.input.len()).max();
    let width = width.unwrap_or_default();
    CONTROLS
        .iter()
        .map(move |Control { input, effect, .. }| format!("{input:width$}  {effect}"))
}

/// Returns the help of the command.
pub(super) fn help() -> String {
    lines().fold("In the window:".into(), |mut text, line| {
        let _ = write!(text, "\n  {line}");
        text
    })
}

#[cfg(all(test, feature = "view"))]
mod tests {
    use super::*;

    #[test]
    fn keys_are_taken_with_shift_and_without() {
        assert_eq!(action('h'), Some(Action::Help));
        assert_eq!(action('H'), Some(Action::Help));
        assert_eq!(action('L'), Some(Action::ShowPrevious));
        assert_eq!(action('l'), Some(Action::ShowNext));
        assert_eq!(action(' '), Some(Action::Play));
        assert_eq!(action('z'), None);
    }

    #[test]
    fn no_key_stands_for_two_actions() {
        let all = CONTROLS.iter().flat_map(|control| control.keys);
        let mut keys: Vec<char> = all.map(|&(key, _)| key).collect();
        let count = keys.len();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), count);
    }
}
