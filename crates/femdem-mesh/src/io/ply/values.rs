//! The data: one number after another.

use crate::MeshError;
use crate::io::text::{Lines, coordinate, problem, shortened};

/// Encoding of the numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

impl Encoding {
    pub(super) fn named(name: &[u8], line: usize) -> Result<Self, MeshError> {
        match name {
            b"ascii" => Ok(Self::Ascii),
            b"binary_little_endian" => Ok(Self::LittleEndian),
            b"binary_big_endian" => Ok(Self::BigEndian),
            _ => {
                let name = shortened(name);
                let allowed = "ascii, binary_little_endian, binary_big_endian";
                Err(problem(
                    line,
                    format!("the format \"{name}\" is none of {allowed}"),
                ))
            }
        }
    }
}

/// The type of a number.
#[derive(Clone, Copy)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn named(name: &[u8], line: usize) -> Result<Self, MeshError> {
        Ok(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => {
                let what = format!("\"{}\" is no type of a PLY property", shortened(name));
                return Err(problem(line, what));
            }
        })
    }

    const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of bytes in little endian order, padded with zeros.
    fn value(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => f64::from(i8::from_le_bytes([a])),
            Self::U8 => f64::from(a),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(bytes),
        }
    }
}

/// The numbers not yet read.
pub(super) struct Values<'a> {
    rest: &'a [u8],
    lines: Lines<'a>,
    encoding: Encoding,
}

impl<'a> Values<'a> {
    /// The numbers in the lines after the header.
    pub(super) fn new(lines: Lines<'a>, encoding: Encoding) -> Self {
        let rest = match encoding {
            Encoding::Ascii => &[],
            _ => lines.rest(),
        };
        Self {
            rest,
            lines,
            encoding,
        }
    }

    /// The next number; `cut_off` if there is none. In binary data whether it is finite is checked later.
    pub(super) fn scalar(
        &mut self,
        scalar: Scalar,
        cut_off: impl Fn() -> MeshError,
    ) -> Result<f64, MeshError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word().ok_or_else(cut_off)?;
            return coordinate(word, self.lines.number);
        }
        let size = scalar.bytes();
        let (number, rest) = self.rest.split_at_checked(size).ok_or_else(cut_off)?;
        self.rest = rest;
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(number);
        if self.encoding == Encoding::BigEndian {
            bytes[..size].reverse();
        }
        Ok(scalar.value(bytes))
    }

    /// The next number, which must be a non-negative integer.
    pub(super) fn whole(
        &mut self,
        scalar: Scalar,
        cut_off: impl Fn() -> MeshError,
    ) -> Result<u32, MeshError> {
        let value = self.scalar(scalar, cut_off)?;
        if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
            return Ok(value as u32);
        }
        Err(MeshError::OutOfRange {
            what: "a list's length or vertex number in the PLY data",
            value,
            allowed: "a whole number from 0 to 4294967295",
        })
    }

    fn word(&mut self) -> Option<&'a [u8]> {
        self.rest = self.rest.trim_ascii_start();
        while self.rest.is_empty() {
            self.rest = self.lines.next()?.1.trim_ascii_start();
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest;
        Some(word)
    }

    /// Binary data must end where the header says; otherwise they do not match it.
    pub(super) fn check_end(&self, encoding: Encoding) -> Result<(), MeshError> {
        if encoding == Encoding::Ascii || self.rest.iter().all(u8::is_ascii_whitespace) {
            return Ok(());
        }
        Err(MeshError::Unsupported {
            what: format!(
                "{} bytes after the data that its header describes",
                self.rest.len()
            ),
            advice: "the header does not fit the data, or the file is damaged",
        })
    }
}
