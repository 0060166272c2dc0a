//! The fields of one line of a CSV file.

use csv_core::{ReadRecordResult, Reader};

/// A line has at most so many bytes.
pub(super) const LONGEST_LINE: usize = 1 << 16;

const MOST_FIELDS: usize = 1024;

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
    /// A reason if a quotation mark is not closed or the line has more than 1024 fields.
    pub(super) fn parse(&mut self, line: &[u8]) -> Result<(), String> {
        self.reader.reset();
        let (result, _, _, field_count) =
            self.reader
                .read_record(line, &mut self.text, &mut self.ends);
        self.field_count = field_count;
        match result {
            ReadRecordResult::Record => Ok(()),
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
