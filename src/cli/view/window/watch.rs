//! A scene's file, read again when it changes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// The time between two looks at the file.
const INTERVAL: Duration = Duration::from_millis(250);

/// A file that may change.
#[derive(Debug)]
pub(super) struct SceneWatch {
    path: PathBuf,
    seen: Option<(SystemTime, u64)>,
    next: Instant,
}

impl SceneWatch {
    /// Watches a file, as it is now. A built-in scene has none.
    pub(super) fn new(path: &Path, now: Instant) -> Option<Self> {
        let seen = state(path)?;
        Some(Self {
            path: path.to_owned(),
            seen: Some(seen),
            next: now + INTERVAL,
        })
    }

    /// When it looks at the file next.
    pub(super) fn next(&self) -> Instant {
        self.next
    }

    /// Returns whether the file is another one than at the last look. While there is none, as an editor may leave it
    /// for a moment, there is nothing to read.
    pub(super) fn has_changed(&mut self, now: Instant) -> bool {
        if now < self.next {
            return false;
        }
        self.next = now + INTERVAL;
        let state = state(&self.path);
        let has_changed = state.is_some() && state != self.seen;
        if has_changed {
            self.seen = state;
        }
        has_changed
    }
}

/// When the file was changed last, and its length.
fn state(path: &Path) -> Option<(SystemTime, u64)> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_seen_once_and_a_missing_file_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        let start = Instant::now();
        assert!(SceneWatch::new(&path, start).is_none());
        fs::write(&path, "a").unwrap();
        let mut watch = SceneWatch::new(&path, start).unwrap();
        let mut look = |times: u32| watch.has_changed(start + INTERVAL * times);
        assert!(!look(1));
        fs::write(&path, "ab").unwrap();
        assert!(!look(1));
        assert!(look(2));
        assert!(!look(3));
        fs::remove_file(&path).unwrap();
        assert!(!look(4));
        fs::write(&path, "abc").unwrap();
        assert!(look(5));
    }
}
