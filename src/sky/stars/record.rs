//! The lines of a CSV file and their fields, in bounded memory.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};

use csv_core::{ReadRecordResult, Reader};

use super::fault::{CatalogueFault, LONGEST_LINE};

const MOST_FIELDS: usize = 1024;

/// The lines of a file that are neither blank nor comments.
pub(super) struct LineReader {
    file: BufReader<File>,
    /// The line last read, with a line feed at its end.
    pub(super) line: Vec<u8>,
    /// Its number, from 1.
    pub(super) number: u64,
}

impl LineReader {
    pub(super) fn new(file: File) -> Self {
        Self {
            file: BufReader::with_capacity(LONGEST_LINE, file),
            line: Vec::new(),
            number: 0,
        }
    }

    /// Reads the next line. Returns false at the end of the file.
    pub(super) fn next(&mut self) -> Result<bool, CatalogueFault> {
        loop {
            self.line.clear();
            let length = (&mut self.file)
                .take(LONGEST_LINE as u64)
                .read_until(b'\n', &mut self.line)?;
            if length == 0 {
                return Ok(false);
            }
            self.number += 1;
            if !self.line.ends_with(b"\n") {
                if length == LONGEST_LINE {
                    return Err(CatalogueFault::LongLine(self.number));
                }
                self.line.push(b'\n');
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                self.line.drain(..3);
            }
            if !self.line.starts_with(b"#") && !self.line.trim_ascii().is_empty() {
                return Ok(true);
            }
        }
    }
}

/// One line's fields. The memory is the same for every line and does not grow.
///
/// Each line is parsed on its own: a quotation mark that is not closed spoils its own line and no other.
pub(super) struct Record {
    reader: Reader,
    text: Vec<u8>,
    /// The end of each field in `text`.
    ends: Vec<usize>,
    field_count: usize,
}

impl Record {
    pub(super) fn new() -> Self {
        Self {
            reader: Reader::new(),
            text: vec![0; LONGEST_LINE],
            ends: vec![0; MOST_FIELDS],
            field_count: 0,
        }
    }

    /// Splits a line, which ends with a line feed, into fields.
    ///
    /// # Errors
    /// A reason if a quotation mark is not closed, if the line has more than 1024 fields, or if it has more after a
    /// carriage return.
    pub(super) fn parse(&mut self, line: &[u8]) -> Result<(), String> {
        self.reader.reset();
        let (result, read, _, field_count) =
            self.reader
                .read_record(line, &mut self.text, &mut self.ends);
        self.field_count = field_count;
        match result {
            ReadRecordResult::Record if line[read..].trim_ascii().is_empty() => Ok(()),
            ReadRecordResult::Record => {
                Err("a carriage return is no end of a line; lines end with a line feed".into())
            }
            ReadRecordResult::OutputEndsFull => Err(format!("more than {MOST_FIELDS} fields")),
            _ => Err("a quotation mark is not closed".into()),
        }
    }

    /// Returns all fields, without the blanks around them.
    pub(super) fn fields(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.field_count).map(|index| self.field(index))
    }

    /// Returns a field without the blanks around it; empty if the line has fewer fields.
    pub(super) fn field(&self, index: usize) -> &[u8] {
        if index >= self.field_count {
            return &[];
        }
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        self.text[start..self.ends[index]].trim_ascii()
    }
}
