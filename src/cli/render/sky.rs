//! A scene's sky: its files, what they hold, and the memory that they take.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use bytesize::ByteSize;
use sha2::{Digest, Sha256};

use super::super::method::digits;
use super::super::misuse::misuse;
use super::super::progress::{Report, warn};
use crate::scene::{Sky, SkyFile, StarSource};
use crate::sky::stars::{CatalogueError, CatalogueFault, Star};
use crate::sky::{BadRows, Panorama, PanoramaProblem, SkyError, SkySource};

/// So many bad rows of a catalogue are told of with their reasons.
const ROWS_TOLD: usize = 5;

/// Returns the files that a sky is read from, each with what it is.
pub(in crate::cli) fn files(
    sky: Option<&Sky>,
) -> impl Iterator<Item = (&SkyFile, &'static str)> + Clone {
    let panorama = sky.and_then(|sky| sky.panorama.as_ref());
    let stars = sky.and_then(|sky| sky.stars.as_ref());
    let catalogue = stars.and_then(|stars| match &stars.source {
        StarSource::File(file) => Some(file),
        StarSource::Synthetic { .. } => None,
    });
    let panorama = panorama.map(|file| (file, "panorama"));
    let catalogue = catalogue.map(|file| (file, "star catalogue"));
    panorama.into_iter().chain(catalogue)
}

/// Checks that the files of a sky are there.
///
/// # Errors
/// One is not.
pub(super) fn check_files(sky: Option<&Sky>) -> anyhow::Result<()> {
    for (file, what) in files(sky) {
        if let Err(error) = fs::metadata(&file.path)
            && error.kind() == io::ErrorKind::NotFound
        {
            let path = file.path.display();
            return Err(misuse(format!(
                "{what} {path}: the file cannot be read: {error}"
            )));
        }
    }
    Ok(())
}

/// Returns the SHA-256 of each file of a sky; [`None`] for a sky without files.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn fingerprint(sky: Option<&Sky>) -> anyhow::Result<Option<String>> {
    let hashes = files(sky).map(|(file, what)| {
        let problem = |problem| anyhow::anyhow!("{what} {}: {problem}", file.path.display());
        hash(&file.path).map_err(problem)
    });
    let hashes: Vec<String> = hashes.collect::<Result<_, _>>()?;
    Ok((!hashes.is_empty()).then(|| hashes.join(" ")))
}

/// Returns the SHA-256 of a file, in hexadecimal. The file is never in memory as a whole.
fn hash(path: &Path) -> Result<String, PanoramaProblem> {
    // Opening a pipe would wait for its writer, and a device may have no end.
    if !fs::metadata(path)?.is_file() {
        return Err(PanoramaProblem::NotAFile);
    }
    let mut hasher = Sha256::new();
    let mut file = BufReader::with_capacity(1 << 16, File::open(path)?);
    loop {
        let read = file.fill_buf()?;
        if read.is_empty() {
            return Ok(digits(&hasher.finalize()));
        }
        hasher.update(read);
        let length = read.len();
        file.consume(length);
    }
}

/// Reads the files of a sky, where a frame takes `frame` bytes and all together may take `allowed`. Prints which rows
/// of a catalogue are no stars.
///
/// # Errors
/// A file that cannot be read, or that needs too much memory.
pub(in crate::cli) fn read(
    sky: &Sky,
    frame: u64,
    allowed: ByteSize,
    report: Report,
) -> anyhow::Result<SkySource> {
    let names: Vec<&str> = files(Some(sky))
        .map(|(file, _)| file.name.as_str())
        .collect();
    let _spinner =
        (!names.is_empty()).then(|| report.spinner(format!("reading {}", names.join(" and "))));
    let left = allowed.as_u64().saturating_sub(frame);
    if let Some(StarSource::Synthetic { count, .. }) = sky.stars.as_ref().map(|stars| &stars.source)
    {
        let needed = u64::from(*count) * size_of::<Star>() as u64;
        if needed > left {
            let what = format!("{count} stars take {} of memory", ByteSize(needed));
            return Err(too_much(&what, frame, allowed));
        }
    }
    let source = SkySource::open(sky, left).map_err(|error| match &error {
        SkyError::Panorama {
            path,
            problem: PanoramaProblem::Memory { needed, .. },
        } => {
            let (path, needed) = (path.display(), ByteSize(*needed));
            let what = format!("panorama {path}: reading it takes {needed} of memory");
            too_much(&what, frame, allowed)
        }
        SkyError::Catalogue(CatalogueError {
            path,
            fault: CatalogueFault::TooManyStars { stars, bytes },
        }) => {
            let (path, bytes) = (path.display(), ByteSize(*bytes));
            let what = format!(
                "star catalogue {path}: more than {stars} stars take over {bytes} of memory"
            );
            too_much(&what, frame, allowed)
        }
        _ => error.into(),
    })?;
    // The panorama takes memory first.
    let needed = bytes(&source);
    if needed > left {
        let what = format!("the sky takes {} of memory", ByteSize(needed));
        return Err(too_much(&what, frame, allowed));
    }
    if let Some(rows) = source.bad_rows().filter(|rows| rows.count > 0) {
        let catalogue = files(Some(sky)).last().map(|(file, _)| &file.path);
        tell_bad_rows(catalogue.map_or(Path::new(""), |path| path), rows);
    }
    Ok(source)
}

/// Returns the bytes of memory that a sky takes once it is read.
pub(super) fn bytes(source: &SkySource) -> u64 {
    let stars = source.stars().map_or(0, |field| field.stars.len());
    let panorama = source.panorama().map_or(0, Panorama::bytes);
    panorama + (stars * size_of::<Star>()) as u64
}

/// The error of a sky for which there is too little memory.
fn too_much(what: &str, frame: u64, allowed: ByteSize) -> anyhow::Error {
    misuse(format!(
        "{what}, a frame {}, and {allowed} are allowed; allow more with --max-memory, or choose a smaller sky",
        ByteSize(frame)
    ))
}

/// Prints how many rows of a catalogue are left out, and the first of them.
fn tell_bad_rows(catalogue: &Path, rows: &BadRows) {
    let (noun, verb) = if rows.count == 1 {
        ("row", "is no star and is")
    } else {
        ("rows", "are no stars and are")
    };
    let mut text = format!(
        "star catalogue {}: {} {noun} {verb} left out",
        catalogue.display(),
        rows.count
    );
    for row in rows.first.iter().take(ROWS_TOLD) {
        let _ = write!(text, "\n  {row}");
    }
    if rows.count > ROWS_TOLD as u64 {
        let _ = write!(text, "\n  and {} more", rows.count - ROWS_TOLD as u64);
    }
    warn(text);
}
