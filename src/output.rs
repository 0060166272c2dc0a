//! Files that appear whole or not at all.
//!
//! A file is written under a hidden name that ends in `.part`, in the same folder, and renamed when it is finished. It
//! is locked (`flock`) while it is written: the lock tells a file that a process is writing, on any machine that shares
//! the disk, from one that a killed process left. Processes that share work claim files by that lock: see [`claim`].

pub mod claim;
#[cfg(test)]
mod tests;

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// The end of an unfinished file's name.
const ENDING: &str = ".part";

/// The number of random letters and digits before the ending, so that two processes can write one file.
const RANDOM: usize = 6;

/// The longest file name that becomes part of an unfinished file's name, in bytes: file systems allow 255 in all. The
/// checksum stands for a longer one.
pub const LONGEST_NAME: usize = 200;

/// Writes a file through `fill`, whole or not at all, and syncs it to the disk. Whatever stops the process or the disk,
/// `path` holds its old content, the new content, or nothing. Unfinished files that killed processes left for `path`
/// are removed. A symbolic link is followed, whether or not it leads to a file. The mode is that of the file that is
/// replaced; for a new file it follows the umask.
///
/// # Errors
/// What creating, filling, syncing or renaming the file returns. The unfinished file is then removed. A file that may
/// not be written is not replaced.
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
    let folder = folder_of(&unfinished.path).to_owned();
    unfinished.finish()?;
    // Syncing the folder makes the rename last. Not every system can open folders; the file is whole either way.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// A file that is being written. If it is dropped before it is finished, it is removed.
#[derive(Debug)]
pub struct Unfinished {
    temporary: NamedTempFile,
    path: PathBuf,
}

impl Unfinished {
    /// Makes the folder where it is missing, removes what killed processes left for `path`, and [begins](Self::new) the
    /// file.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn after_leftovers(path: &Path) -> io::Result<Self> {
        let path = led_to(path)?;
        let name = path.file_name().map(label).unwrap_or_default();
        make_folder(folder_of(&path))?;
        remove_leftovers(folder_of(&path), |left| left == name.as_encoded_bytes());
        Self::new(&path)
    }

    /// Begins a file that will be at `path`, or where a link at `path` leads to.
    ///
    /// # Errors
    /// What creating a file in the same folder returns; a file that may not be written is there.
    pub fn new(path: &Path) -> io::Result<Self> {
        let path = led_to(path)?;
        let mode = replaced_mode(&path)?;
        loop {
            let temporary = create(&path, None)?;
            // Before the lock another process may have taken the file for a leftover. Where files cannot be locked,
            // none does.
            let is_taken = matches!(
                temporary.as_file().try_lock(),
                Err(TryLockError::WouldBlock)
            ) || !temporary.path().exists();
            if !is_taken {
                return Ok(Self::with_mode(temporary, path, mode));
            }
        }
    }

    fn with_mode(temporary: NamedTempFile, path: PathBuf, mode: Option<fs::Permissions>) -> Self {
        if let Some(mode) = mode {
            // Disks without modes refuse, and have none to keep.
            let _ = temporary.as_file().set_permissions(mode);
        }
        Self { temporary, path }
    }

    /// The file to write to.
    pub fn file(&mut self) -> &mut File {
        self.temporary.as_file_mut()
    }

    /// The name under which the file is written.
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// Syncs the content to the disk, and gives the file its name.
    ///
    /// # Errors
    /// What syncing or renaming the file returns.
    pub fn finish(self) -> io::Result<()> {
        // Some disks report that they are full or broken only here.
        self.temporary.as_file().sync_data()?;
        self.temporary
            .persist(&self.path)
            .map_err(|error| error.error)?;
        Ok(())
    }
}

/// Removes the unfinished files in a folder whose label is `asked`, unless a process is writing them.
pub fn remove_leftovers(folder: &Path, asked: impl Fn(&[u8]) -> bool) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if leftover(&entry.file_name()).is_some_and(&asked) {
            let _ = remove_if_dead(&entry.path());
        }
    }
}

/// The [label](LONGEST_NAME) in an unfinished file's name: the name that the file would have had, or its checksum, in
/// the system's encoding. [`None`] for any other name.
pub fn leftover(name: &OsStr) -> Option<&[u8]> {
    let bytes = name.as_encoded_bytes().strip_prefix(b".")?;
    let bytes = bytes.strip_suffix(ENDING.as_bytes())?;
    let (label, random) = bytes.split_at_checked(bytes.len().checked_sub(RANDOM + 1)?)?;
    let is_ours = random.starts_with(b".") && random[1..].iter().all(u8::is_ascii_alphanumeric);
    (is_ours && !label.is_empty()).then_some(label)
}

/// Removes an unfinished file, unless a process is writing it. Returns whether it is gone.
///
/// # Errors
/// It is no regular file, or cannot be locked or removed.
pub fn remove_if_dead(path: &Path) -> io::Result<bool> {
    let remove = || {
        // Opening a pipe would wait for its writer.
        if !fs::symlink_metadata(path)?.is_file() {
            return Err(io::Error::other("not a regular file"));
        }
        let file = open_to_lock(path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Ok(false),
            Err(TryLockError::Error(error)) => return Err(error),
        }
        // Before the lock the name may have become another file's. The file is deleted before it is unlocked: a writer
        // that finds it locked chooses another name, or looks again.
        if is_at(&file, path) {
            fs::remove_file(path)?;
        }
        Ok(true)
    };
    match remove() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        gone => gone,
    }
}

/// Opens a file for a lock. On network file systems an exclusive lock needs the right to write; elsewhere another
/// user's file can be locked too.
fn open_to_lock(path: &Path) -> io::Result<File> {
    let file = File::options().read(true).write(true).open(path);
    file.or_else(|_| File::open(path))
}

/// Whether an open file has this name.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let place = |kind: fs::Metadata| (kind.dev(), kind.ino());
        let (file, named) = (file.metadata(), fs::symlink_metadata(path));
        file.is_ok_and(|file| named.is_ok_and(|named| place(file) == place(named)))
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Creates an unfinished file for `path`, with `part` or random letters and digits before the ending.
///
/// # Errors
/// What the system returns.
fn create(path: &Path, part: Option<&str>) -> io::Result<NamedTempFile> {
    let mut prefix = prefix(path);
    prefix.push(part.unwrap_or_default());
    let random = if part.is_some() { 0 } else { RANDOM };
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(ENDING).rand_bytes(random);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The kernel applies the umask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(path)).map_err(bare)
}

/// How the names of unfinished files for `path` begin.
fn prefix(path: &Path) -> OsString {
    let mut prefix = OsString::from(".");
    prefix.push(path.file_name().map(label).unwrap_or_default());
    prefix.push(".");
    prefix
}

/// The mode of the file at `path`, if one is there.
///
/// # Errors
/// It may not be written.
fn replaced_mode(path: &Path) -> io::Result<Option<fs::Permissions>> {
    let replaced = fs::metadata(path).ok().filter(fs::Metadata::is_file);
    if replaced.is_some() {
        check_writable(path)?;
    }
    Ok(replaced.map(|replaced| replaced.permissions()))
}

/// The label in an unfinished file's name: the final name, or for a long one its checksum.
fn label(name: &OsStr) -> OsString {
    if name.len() > LONGEST_NAME {
        format!("{:08x}", crc32fast::hash(name.as_encoded_bytes())).into()
    } else {
        name.to_owned()
    }
}

/// The system's error, without the random file name that `tempfile` adds.
fn bare(error: io::Error) -> io::Error {
    let source = error.get_ref().and_then(|error| error.source());
    let system = source.and_then(|source| source.downcast_ref::<io::Error>());
    match system.and_then(io::Error::raw_os_error) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error,
    }
}

/// Checks that a file may be written: by its mode, whoever runs the program, and by the system. It is not changed.
///
/// # Errors
/// It may not, or is not there.
pub fn check_writable(path: &Path) -> io::Result<()> {
    if fs::metadata(path)?.permissions().readonly() {
        let problem = "the file is read-only";
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, problem));
    }
    File::options().write(true).open(path).map(drop)
}

/// Returns what a path leads to through symbolic links, whether or not anything exists there.
///
/// # Errors
/// Links that lead in a circle.
pub fn led_to(path: &Path) -> io::Result<PathBuf> {
    // As many as Linux follows.
    const MOST_LINKS: usize = 40;
    if let Ok(path) = fs::canonicalize(path) {
        return Ok(path);
    }
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(link) = fs::read_link(&path) else {
            return Ok(path);
        };
        path = folder_of(&path).join(link);
    }
    Err(io::Error::other("symbolic links lead in a circle"))
}

/// Makes a folder, and those above it, where they are missing. Links that lead to no folder yet are followed.
///
/// # Errors
/// What the system returns.
pub fn make_folder(folder: &Path) -> io::Result<()> {
    let mut folders: Vec<&Path> = folder.ancestors().collect();
    folders.reverse();
    for folder in folders.into_iter().filter(|folder| !folder.is_dir()) {
        if !folder.as_os_str().is_empty() {
            fs::create_dir_all(led_to(folder)?)?;
        }
    }
    Ok(())
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
