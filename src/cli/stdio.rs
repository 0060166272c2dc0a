//! The standard output.

use std::fs::{File, Metadata};
use std::io::{self, Write};

/// The standard output cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("the standard output cannot be written: {0}")]
pub(super) struct StdoutError(#[source] pub(super) io::Error);

impl StdoutError {
    /// Whether the reader closed its end, which is not a failure.
    pub(super) fn is_closed_pipe(&self) -> bool {
        self.0.kind() == io::ErrorKind::BrokenPipe
    }
}

/// Prints text.
pub(super) fn print(text: &str) -> Result<(), StdoutError> {
    let mut stdout = io::stdout().lock();
    stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
        .map_err(StdoutError)
}

/// The standard output as a file. The one of [`io::stdout`] flushes at line ends, and ignores a closed descriptor.
///
/// # Errors
/// What the system returns.
pub(super) fn stdout() -> io::Result<File> {
    #[cfg(unix)]
    let owned = std::os::fd::AsFd::as_fd(&io::stdout()).try_clone_to_owned()?;
    #[cfg(windows)]
    let owned = std::os::windows::io::AsHandle::as_handle(&io::stdout()).try_clone_to_owned()?;
    Ok(File::from(owned))
}

/// Whether the standard output goes to the file with this metadata.
pub(super) fn is_stdout(file: &Metadata) -> bool {
    #[cfg(unix)]
    if let Ok(stdout) = stdout().and_then(|stdout| stdout.metadata()) {
        use std::os::unix::fs::MetadataExt;
        let id = |file: &Metadata| (file.dev(), file.ino());
        return file.is_file() && id(file) == id(&stdout);
    }
    #[cfg(not(unix))]
    let _ = file;
    false
}
