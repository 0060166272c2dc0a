//! Why a scene is refused.

use std::fmt::{Debug, Display};
use std::path::PathBuf;

use super::builtin::{Builtin, builtins};

/// Why a scene is refused.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The text is not a scene: it is not TOML, or a key is missing, unknown, of the wrong type, or given twice.
    #[error("{message}")]
    Toml {
        /// What is wrong; from the parser, with line and column.
        message: String,
    },
    /// There is nothing to show.
    #[error("the scene has neither a disk nor a sky; add the table [disk] or the table [sky]")]
    Empty,
    /// A value is not allowed.
    #[error("{key} = {value}: {reason}")]
    Value {
        /// The key, with its table.
        key: &'static str,
        /// The value.
        value: String,
        /// What is allowed, and why.
        reason: String,
    },
    /// A value that was to take the place of one in a scene's file is not allowed.
    #[error("{from}: {problem}")]
    Override {
        /// Where the value comes from, such as an option of the command line.
        from: String,
        /// What is wrong.
        problem: String,
    },
    /// Something is wrong in one frame, or in the keyframe at that frame.
    #[error("frame {number}: {error}")]
    InFrame {
        /// The frame's number.
        number: i64,
        /// What is wrong.
        error: Box<SceneError>,
    },
    /// The animation has no such frame.
    #[error("there is no frame {number}: the frames are {first} to {last}")]
    NoFrame {
        /// The number asked for.
        number: i64,
        /// The first frame's number.
        first: i64,
        /// The last frame's number.
        last: i64,
    },
    /// No built-in scene and no file has this name.
    #[error(
        "{} is neither a file nor a built-in scene{} (these are {})",
        path.display(),
        path.to_str().and_then(Builtin::meant).map_or(String::new(), |name| format!("; did you mean {name}?")),
        builtins().iter().map(Builtin::name).collect::<Vec<_>>().join(", ")
    )]
    Unknown {
        /// The name asked for.
        path: PathBuf,
    },
    /// A scene's file cannot be read.
    #[error("scene file {} cannot be read: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A file holds no valid scene.
    #[error("scene file {}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        error: Box<SceneError>,
    },
}

impl SceneError {
    /// The error of a value that is not allowed.
    pub(super) fn value(key: &'static str, value: impl Debug, reason: impl Display) -> Self {
        Self::Value {
            key,
            value: format!("{value:?}"),
            reason: reason.to_string(),
        }
    }

    /// Checks that a value is allowed.
    ///
    /// # Errors
    /// [`Self::value`]
    pub(super) fn check(
        is_allowed: bool,
        key: &'static str,
        value: impl Debug,
        reason: impl Display,
    ) -> Result<(), Self> {
        if is_allowed {
            Ok(())
        } else {
            Err(Self::value(key, value, reason))
        }
    }

    /// The error of a text that is not a scene.
    pub(super) fn toml(message: impl Into<String>) -> Self {
        Self::Toml {
            message: message.into(),
        }
    }

    /// The same error, of the frame `number`.
    pub(super) fn in_frame(self, number: i64) -> Self {
        Self::InFrame {
            number,
            error: Box::new(self),
        }
    }
}
