//! Claims, by which processes without a scheduler share work: a file is claimed by the lock on its unfinished file.
//!
//! All claims of one file have the same name, so that only one process at a time creates and locks it. The lock ends
//! with its process, however that ends. On a network file system all machines must see each other's locks.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use super::{
    ENDING, Unfinished, create, folder_of, is_at, led_to, open_to_lock, prefix, remove_if_dead,
    replaced_mode,
};

/// What a claimed file's name has in place of random letters and digits.
const CLAIMED: &str = "shared";

impl Unfinished {
    /// Begins a file as [`Self::new`] does, but only one process at a time: returns [`None`] while another one has
    /// claimed it. What a killed process claimed is free. Where files cannot be locked, nothing is claimed, and each
    /// process writes a file of its own.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn claim(path: &Path) -> io::Result<Option<Self>> {
        let path = led_to(path)?;
        let mode = replaced_mode(&path)?;
        let name = hidden(&path, CLAIMED);
        loop {
            match create(&path, Some(CLAIMED)) {
                Ok(temporary) => match temporary.as_file().try_lock() {
                    Ok(()) if is_at(temporary.as_file(), &name) => {
                        return Ok(Some(Self::with_mode(temporary, path, mode)));
                    }
                    Err(TryLockError::Error(_)) => break,
                    // Before the lock another process took the file for a dead one's. The name may be that process's
                    // by now, and is not to be removed.
                    _ => {
                        let _ = temporary.keep();
                    }
                },
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    match remove_if_dead(&name) {
                        Ok(true) => {}
                        Ok(false) => return Ok(None),
                        Err(_) => break,
                    }
                }
                Err(error) => return Err(error),
            }
        }
        Self::new(&path).map(Some)
    }
}

/// The mark of running processes that make the same files with the same settings. They hold its lock together; the last
/// one removes it.
#[derive(Debug)]
pub struct RunMark {
    file: File,
    name: PathBuf,
}

impl RunMark {
    /// Joins the processes that make the files `path` with these `settings`: six letters or digits.
    ///
    /// # Errors
    /// The file system has no locks, or no file can be made in the folder.
    pub fn join(path: &Path, settings: &str) -> io::Result<Self> {
        let name = hidden(path, settings);
        loop {
            let mut options = File::options();
            options.read(true).write(true).create(true).truncate(false);
            let file = options.open(&name).or_else(|_| open_to_lock(&name))?;
            match file.try_lock_shared() {
                Ok(()) if is_at(&file, &name) => return Ok(Self { file, name }),
                Err(TryLockError::Error(error)) => {
                    let _ = fs::remove_file(&name);
                    return Err(error);
                }
                // Another process is removing it.
                _ => thread::sleep(Duration::from_millis(1)),
            }
        }
    }

    /// The name of the mark.
    pub fn name(&self) -> &Path {
        &self.name
    }
}

impl Drop for RunMark {
    fn drop(&mut self) {
        // Only the last process gets the lock for itself.
        if self.file.try_lock().is_ok() && is_at(&self.file, &self.name) {
            let _ = fs::remove_file(&self.name);
        }
    }
}

/// The name of an unfinished file for `path` with `part` before the ending.
fn hidden(path: &Path, part: &str) -> PathBuf {
    let mut name = prefix(path);
    name.push(part);
    name.push(ENDING);
    folder_of(path).join(name)
}

#[cfg(test)]
mod tests {
    use std::io::Write;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::super::leftover;
    use super::*;

    #[test]
    fn a_claim_is_of_one_at_a_time_and_free_when_it_is_dropped_or_left_by_a_killed_process() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f_1.png");
        let name = folder.path().join(".f_1.png.shared.part");
        // What a killed process left.
        fs::write(&name, "half").unwrap();
        let mut first = Unfinished::claim(&path).unwrap().unwrap();
        assert_eq!(first.path(), name);
        assert!(Unfinished::claim(&path).unwrap().is_none());
        assert!(!remove_if_dead(&name).unwrap());
        drop(first);
        assert!(!name.exists());
        first = Unfinished::claim(&path).unwrap().unwrap();
        first.file().write_all(b"whole").unwrap();
        first.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        drop(Unfinished::claim(&path).unwrap().unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// Guards against a claim that two processes get, or that one removes from another: by many that claim one file at
    /// once, some of which clean up.
    #[test]
    fn claims_that_race_are_had_by_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = &folder.path().join("f_1.png");
        let name = &hidden(path, CLAIMED);
        let (holders, claims) = (&AtomicU32::new(0), &AtomicU32::new(0));
        thread::scope(|scope| {
            for worker in 0..8 {
                scope.spawn(move || {
                    // Until there were enough, however the threads take turns.
                    let mut turn = 0;
                    while claims.load(Ordering::SeqCst) < 300 {
                        turn += 1;
                        if worker % 4 == 3 {
                            remove_if_dead(name).unwrap();
                        } else if let Some(claim) = Unfinished::claim(path).unwrap() {
                            assert_eq!(holders.fetch_add(1, Ordering::SeqCst), 0);
                            assert!(is_at(claim.temporary.as_file(), name));
                            claims.fetch_add(1, Ordering::SeqCst);
                            holders.fetch_sub(1, Ordering::SeqCst);
                            if turn % 2 == 0 {
                                claim.finish().unwrap();
                            }
                        }
                    }
                });
            }
        });
        assert!(!name.exists());
    }

    #[test]
    fn a_mark_lasts_as_long_as_the_last_of_its_runs() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f_##.png");
        let first = RunMark::join(&path, "a1b2c3").unwrap();
        let second = RunMark::join(&path, "a1b2c3").unwrap();
        let name = first.name().to_owned();
        assert_eq!(leftover(name.file_name().unwrap()), Some(&b"f_##.png"[..]));
        drop(first);
        assert!(!remove_if_dead(&name).unwrap() && name.exists());
        drop(second);
        assert!(!name.exists());
    }
}
