//! What a panorama's file tells ahead of its decoding: the size that it claims, and whether it is whole.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use image::ImageFormat;

use crate::sky::PanoramaProblem;

/// The bytes at a file's start that tell its format and size; the most of a Radiance file's header.
pub(super) const HEAD: u64 = 1 << 16;

/// A file that tells whether more was read than it holds.
pub(super) struct Watched<'a> {
    pub(super) file: File,
    pub(super) has_ended: &'a Cell<bool>,
}

impl Read for Watched<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(bytes)?;
        if count == 0 && !bytes.is_empty() {
            self.has_ended.set(true);
        }
        Ok(count)
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.file.seek(place)
    }
}

/// Returns the width and height that a file's first bytes claim, where they are found at once: of JPEG, the decoder
/// tells them.
pub(super) fn claimed_size(format: ImageFormat, head: &[u8]) -> Option<(u64, u64)> {
    let after = |mark: &[u8]| {
        let at = head.windows(mark.len()).position(|window| window == mark);
        at.map(|at| &head[at + mark.len()..])
    };
    match format {
        ImageFormat::Png => {
            let (numbers, _) = after(b"IHDR")?.as_chunks::<4>();
            let value = |bytes: &[u8; 4]| bytes.iter().fold(0, |n, &b| n << 8 | u64::from(b));
            let number = |i: usize| numbers.get(i).map(value);
            Some((number(0)?, number(1)?))
        }
        ImageFormat::Hdr => {
            let line = after(b"\n\n")?.split(|&byte| byte == b'\n').next()?;
            let mut words = str::from_utf8(line).ok()?.split_whitespace();
            let mut side = |name| {
                let is_named = words.next()? == name;
                words.next()?.parse().ok().filter(|_| is_named)
            };
            let height = side("-Y")?;
            Some((side("+X")?, height))
        }
        ImageFormat::OpenExr => {
            let (numbers, _) = after(b"displayWindow\0box2i\0\x10\0\0\0")?.as_chunks::<4>();
            let number = |i: usize| Some(i64::from(i32::from_le_bytes(*numbers.get(i)?)));
            let side = |from: i64, to: i64| u64::try_from(to - from + 1).ok();
            Some((side(number(0)?, number(2)?)?, side(number(1)?, number(3)?)?))
        }
        _ => None,
    }
}

/// Checks that a JPEG file's last scan ends: the decoder fills with grey what a file that was cut short lacks.
pub(super) fn check_jpeg_end(path: &Path) -> Result<(), PanoramaProblem> {
    let mut file = BufReader::with_capacity(1 << 16, File::open(path)?);
    let (mut last, mut has_scan, mut is_whole) = (0, false, false);
    loop {
        let bytes = file.fill_buf()?;
        if bytes.is_empty() {
            return is_whole.then_some(()).ok_or(PanoramaProblem::Truncated);
        }
        for &byte in bytes {
            // Within a scan no other byte than 0 or a restart marker follows 0xFF.
            match (last, byte) {
                (0xFF, 0xDA) => (has_scan, is_whole) = (true, false),
                (0xFF, 0xD9) => is_whole = has_scan,
                _ => {}
            }
            last = byte;
        }
        let length = bytes.len();
        file.consume(length);
    }
}

/// Checks that a Radiance file's header ends, by an empty line and a line with the size, before it takes much memory.
pub(super) fn check_hdr_header(head: &[u8]) -> Result<(), PanoramaProblem> {
    let end = head.windows(2).position(|pair| pair == b"\n\n");
    let size = end.and_then(|end| head[end + 2..].iter().position(|&byte| byte == b'\n'));
    match size {
        Some(_) => Ok(()),
        // With carriage returns the header ends otherwise, and no decoder reads it.
        None if (head.len() as u64) < HEAD && !head.contains(&b'\r') => {
            Err(PanoramaProblem::Truncated)
        }
        None => Err(PanoramaProblem::Undecodable("its header has no end".into())),
    }
}
