//! Files that appear whole or not at all.
//!
//! A file is written under another name in the same folder, a hidden one that ends in `.part`, and renamed when it is
//! finished. While it is written it is locked (`flock`): so what a killed process left behind can be told from what a
//! live one, also another machine's on a shared disk, is writing.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// The end of an unfinished file's name.
const ENDING: &str = ".part";

/// How many letters and digits stand before the ending, so that two processes can write one file.
const RANDOM: usize = 6;

/// The longest name that an unfinished file carries, in bytes: with the rest it is still a name that file systems take. Of a longer one
/// it carries the checksum.
pub const LONGEST_NAME: usize = 200;

/// Writes a file through `fill`, whole or not at all, and onto the disk; what a killed process left of the same file is
/// removed. Whatever stops the process or the disk on the way, `path` holds its old content, the new, or nothing.
///
/// Its mode follows the umask, as that of any new file.
///
/// # Errors
/// What creating, filling, syncing or renaming the file returns; the unfinished file is removed then.
pub fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut unfinished = Unfinished::after_leftovers(path)?;
    {
        let mut writer = BufWriter::new(unfinished.file());
        fill(&mut writer)?;
        writer.flush()?;
    }
    unfinished.finish()?;
    // The rename itself lasts once the folder is on the disk; not every system opens folders, and the file is whole
    // either way.
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// A file that is being written. Dropped before it is finished, it is removed.
#[derive(Debug)]
pub struct Unfinished {
    temporary: NamedTempFile,
    path: PathBuf,
}

impl Unfinished {
    /// [Begins](Self::new) the file that is to be at `path`, after what killed processes left of it is removed.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn after_leftovers(path: &Path) -> io::Result<Self> {
        let name = path.file_name().map(label).unwrap_or_default();
        remove_leftovers(folder_of(path), |left| left == name.as_encoded_bytes());
        Self::new(path)
    }

    /// Begins the file that is to be at `path`.
    ///
    /// # Errors
    /// What creating a file in the same folder returns.
    pub fn new(path: &Path) -> io::Result<Self> {
        // A link is followed, not replaced.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let mut prefix = OsString::from(".");
        prefix.push(path.file_name().map(label).unwrap_or_default());
        prefix.push(".");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(ENDING).rand_bytes(RANDOM);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // Less the umask: the kernel takes it off where the file is made.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        loop {
            let temporary = builder.tempfile_in(folder_of(&path)).map_err(bare)?;
            // Between its making and its locking someone may have taken it for a leftover. Where files cannot be locked
            // nobody can.
            let is_taken = matches!(
                temporary.as_file().try_lock(),
                Err(TryLockError::WouldBlock)
            ) || !temporary.path().exists();
            if !is_taken {
                return Ok(Self { temporary, path });
            }
        }
    }

    /// The file, to be written.
    pub fn file(&mut self) -> &mut File {
        self.temporary.as_file_mut()
    }

    /// Gives the file its name, once its content is on the disk.
    ///
    /// # Errors
    /// What syncing or renaming it returns.
    pub fn finish(self) -> io::Result<()> {
        // A full or a broken disk may not say so before.
        self.temporary.as_file().sync_data()?;
        self.temporary
            .persist(&self.path)
            .map_err(|error| error.error)?;
        Ok(())
    }
}

/// Removes what killed processes left unfinished in a folder: those files whose [`label`] is asked for, and none that
/// a live process is writing.
fn remove_leftovers(folder: &Path, asked: impl Fn(&[u8]) -> bool) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if leftover(&entry.file_name()).is_some_and(&asked) {
            remove_if_dead(&entry.path());
        }
    }
}

/// The label of the file that an unfinished one of this name was to become, in the system's encoding.
pub fn leftover(name: &OsStr) -> Option<&[u8]> {
    let bytes = name.as_encoded_bytes().strip_prefix(b".")?;
    let bytes = bytes.strip_suffix(ENDING.as_bytes())?;
    let (label, random) = bytes.split_at_checked(bytes.len().checked_sub(RANDOM + 1)?)?;
    let is_ours = random.starts_with(b".") && random[1..].iter().all(u8::is_ascii_alphanumeric);
    (is_ours && !label.is_empty()).then_some(label)
}

/// Removes an unfinished file, unless somebody is writing it.
pub fn remove_if_dead(path: &Path) {
    // To open a pipe is to wait for its other end.
    let is_file = fs::symlink_metadata(path).is_ok_and(|kind| kind.is_file());
    // The lock is let go when the file is gone: who finds it locked makes another.
    if is_file
        && let Ok(file) = File::open(path)
        && file.try_lock().is_ok()
    {
        let _ = fs::remove_file(path);
    }
}

/// What an unfinished file is called after: its name, or for a long one its checksum.
fn label(name: &OsStr) -> OsString {
    if name.len() > LONGEST_NAME {
        format!("{:08x}", crc32fast::hash(name.as_encoded_bytes())).into()
    } else {
        name.to_owned()
    }
}

/// An error without the random name of the file that it came with.
fn bare(error: io::Error) -> io::Error {
    let source = error.get_ref().and_then(|error| error.source());
    let system = source.and_then(|source| source.downcast_ref::<io::Error>());
    match system.and_then(io::Error::raw_os_error) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error,
    }
}

/// The folder that a file is in.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_what_a_live_one_writes_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        let path = here.join("f_1.png");
        fs::write(here.join(".f_1.png.Ab3xY9.part"), "half").unwrap();
        fs::write(here.join(".f_2.png.Ab3xY9.part"), "another's").unwrap();
        fs::write(here.join(".f_1.png.notes.part"), "somebody's own").unwrap();
        let mut alive = Unfinished::new(&path).unwrap();
        alive.file().write_all(b"slow").unwrap();
        write_whole(&path, |file| file.write_all(b"fast")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"fast");
        assert_eq!(names(here).len(), 4, "{:?}", names(here));
        alive.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"slow");
        assert_eq!(
            names(here),
            [".f_1.png.notes.part", ".f_2.png.Ab3xY9.part", "f_1.png"]
        );
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.table");
        fs::write(&path, "old").unwrap();
        let failed = write_whole(&path, |file| {
            file.write_all(b"new")?;
            Err(io::Error::other("the disk is gone"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.table"]);
    }

    #[test]
    fn the_longest_names_that_a_file_can_have() {
        let folder = tempfile::tempdir().unwrap();
        let name = "n".repeat(255);
        let path = folder.path().join(&name);
        let leftover = format!(
            ".{}.Ab3xY9.part",
            label(OsStr::new(&name)).to_str().unwrap()
        );
        fs::write(folder.path().join(leftover), "half").unwrap();
        write_whole(&path, |file| file.write_all(b"all")).unwrap();
        assert_eq!(names(folder.path()), [name]);
    }

    #[test]
    fn only_unfinished_files_are_leftovers() {
        let label = |name: &str| {
            leftover(OsStr::new(name)).map(|label| String::from_utf8(label.to_vec()).unwrap())
        };
        assert_eq!(label(".f_01.png.Ab3xY9.part").as_deref(), Some("f_01.png"));
        assert_eq!(label(".a.b.c.000000.part").as_deref(), Some("a.b.c"));
        for name in [
            "f_01.png",
            ".f_01.png",
            ".part",
            "..Ab3xY9.part",
            ".Ab3xY9.part",
            ".f.Ab3xY.part",
            ".f.Ab-xY9.part",
            "f.Ab3xY9.part",
            ".f.Ab3xY9.part~",
        ] {
            assert_eq!(label(name), None, "{name}");
        }
    }
}
