//! Errors of the command line itself.

/// A command line that contradicts itself or the files it names. The program exits with 2, as for every usage error.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(super) struct Misuse(String);

/// The error of a command line that makes no sense; `message` says why, and what to write instead.
pub(super) fn misuse(message: impl Into<String>) -> anyhow::Error {
    Misuse(message.into()).into()
}
