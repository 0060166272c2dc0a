//! Errors of the command line itself.

use crate::scene::{Projection, Scene};

/// A command line that contradicts itself or the files it names. The program exits with 2, as for every usage error.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Misuse(String);

/// The error of a command line that makes no sense; `message` says why, and what to write instead.
pub(super) fn misuse(message: impl Into<String>) -> anyhow::Error {
    Misuse(message.into()).into()
}

/// Checks that a scene's picture is flat, since `what` is drawn only there.
///
/// # Errors
/// A misuse.
pub(super) fn check_flat(scene: &Scene, what: &str) -> anyhow::Result<()> {
    match scene.camera().projection {
        Projection::Perspective => Ok(()),
        other => Err(misuse(format!(
            "{what} is drawn in flat pictures only, and camera.projection is {:?}; leave the projection out",
            other.name()
        ))),
    }
}
