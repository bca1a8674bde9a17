//! Numbers one after another, in text or binary.

use crate::MeshError;
use crate::io::text::{coordinate, ends_with_cr_alone, number, problem, shortened, split_line};

/// How numbers are written after the format is known.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What is still to be read.
pub(super) struct Values<'a> {
    rest: &'a [u8],
    pub(super) encoding: Encoding,
    cr_alone: bool,
    line: usize,
}

impl<'a> Values<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            rest: bytes,
            encoding: Encoding::Ascii,
            cr_alone: ends_with_cr_alone(bytes),
            line: 1,
        }
    }

    /// An error at this place of the file.
    pub(super) fn problem(&self, what: impl Into<String>) -> MeshError {
        problem(self.line, what)
    }

    /// The last byte of a line's end.
    fn line_end(&self) -> u8 {
        if self.cr_alone { b'\r' } else { b'\n' }
    }

    fn advance(&mut self, bytes: usize) -> &'a [u8] {
        let (taken, rest) = self.rest.split_at(bytes.min(self.rest.len()));
        let end = self.line_end();
        self.line += taken.iter().filter(|&&b| b == end).count();
        self.rest = rest;
        taken
    }

    /// The next word of text.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        self.advance(start);
        let end = self.rest.iter().position(u8::is_ascii_whitespace);
        Some(self.advance(end.unwrap_or(self.rest.len())))
    }

    /// Goes on behind the next place where `mark` stands at the start of a line; whether there is
    /// one. Linear in the length of the file: the mark is only compared at the starts of lines, and it holds no line
    /// end.
    pub(super) fn pass(&mut self, mark: &[u8]) -> bool {
        let end = self.line_end();
        let starts_line = |at: usize| at == 0 || self.rest[at - 1] == end;
        let mut places = self.rest.windows(mark.len()).enumerate();
        let found = places.find(|(at, bytes)| starts_line(*at) && *bytes == mark);
        match found {
            None => false,
            Some((at, _)) => {
                self.advance(at + mark.len());
                true
            }
        }
    }

    /// Goes on behind the end of this line.
    pub(super) fn end_line(&mut self) {
        let rest = split_line(self.rest, self.cr_alone).1.len();
        self.advance(self.rest.len() - rest);
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let taken = self.rest.split_first_chunk::<N>();
        let (&(mut bytes), rest) = taken.ok_or_else(|| self.ended())?;
        self.rest = rest;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn ended(&self) -> MeshError {
        self.problem("the file ends where a number should stand: it is cut off")
    }

    fn text(&mut self) -> Result<&'a [u8], MeshError> {
        self.word().ok_or_else(|| self.ended())
    }

    /// A whole number, of 4 bytes in binary files.
    pub(super) fn int(&mut self) -> Result<i64, MeshError> {
        if self.encoding != Encoding::Ascii {
            return Ok(i64::from(i32::from_le_bytes(self.bytes()?)));
        }
        let word = self.text()?;
        number(word)
            .ok_or_else(|| self.problem(format!("\"{}\" is no whole number", shortened(word))))
    }

    /// A count or tag, of 8 bytes in binary files.
    pub(super) fn size(&mut self) -> Result<u64, MeshError> {
        if self.encoding != Encoding::Ascii {
            return Ok(u64::from_le_bytes(self.bytes()?));
        }
        let word = self.text()?;
        number(word).ok_or_else(|| {
            let word = shortened(word);
            self.problem(format!(
                "\"{word}\" is no count or tag: a whole number from 0"
            ))
        })
    }

    /// A coordinate, of 8 bytes in binary files.
    pub(super) fn real(&mut self) -> Result<f64, MeshError> {
        if self.encoding != Encoding::Ascii {
            return Ok(f64::from_le_bytes(self.bytes()?));
        }
        let word = self.text()?;
        coordinate(word, self.line)
    }
}
