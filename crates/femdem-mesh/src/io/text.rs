//! Lines, words and numbers of text files of any encoding.

use crate::{MeshError, Point3};
use std::str::FromStr;

/// The start of a word, for messages about files that are not text.
pub(super) fn shortened(word: &[u8]) -> String {
    let start = &word[..word.len().min(40)];
    String::from_utf8_lossy(start).into_owned()
}

/// The text without the byte order mark with which some editors begin it.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

pub(super) fn problem(line: usize, problem: impl Into<String>) -> MeshError {
    MeshError::Parse {
        line,
        problem: problem.into(),
    }
}

/// Length of the line end at the start of `bytes`: LF, CR, or CR LF; of CR alone where that is the line end of the
/// whole file, so that binary data after the last line are not cut.
fn line_end(bytes: &[u8], cr_alone: bool) -> usize {
    match bytes {
        [b'\r', b'\n', ..] if !cr_alone => 2,
        [b'\r' | b'\n', ..] => 1,
        _ => 0,
    }
}

/// Place of the next line end.
fn find_line_end(bytes: &[u8]) -> Option<usize> {
    bytes.iter().position(|b| matches!(b, b'\r' | b'\n'))
}

/// Whether the first line ends with CR alone, as all do in files of old programs.
pub(super) fn ends_with_cr_alone(bytes: &[u8]) -> bool {
    let end = find_line_end(bytes).map_or(&[][..], |end| &bytes[end..]);
    end.first() == Some(&b'\r') && end.get(1) != Some(&b'\n')
}

/// Splits off the first line; the second part begins behind its end.
pub(super) fn split_line(bytes: &[u8], cr_alone: bool) -> (&[u8], &[u8]) {
    let (line, rest) = bytes.split_at(find_line_end(bytes).unwrap_or(bytes.len()));
    (line, &rest[line_end(rest, cr_alone)..])
}

/// Lines with their numbers, from 1, up to a comment if a character that starts comments is given.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    comment: Option<u8>,
    cr_alone: bool,
    /// Number of the last line returned.
    pub(super) number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8], comment: Option<u8>) -> Self {
        Self {
            rest: without_mark(bytes),
            comment,
            cr_alone: ends_with_cr_alone(bytes),
            number: 0,
        }
    }

    /// The next line that contains a word.
    pub(super) fn filled(&mut self) -> Option<(usize, &'a [u8])> {
        self.find(|(_, line)| !line.trim_ascii().is_empty())
    }

    /// The rest after the lines returned.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let (line, rest) = split_line(self.rest, self.cr_alone);
        self.rest = rest;
        self.number += 1;
        let end = self.comment.and_then(|c| line.iter().position(|&b| b == c));
        Some((self.number, &line[..end.unwrap_or(line.len())]))
    }
}

/// Words between white space.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// A number, if the word is one.
pub(super) fn number<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Reads a coordinate.
pub(super) fn coordinate(word: &[u8], line: usize) -> Result<f64, MeshError> {
    match number::<f64>(word) {
        Some(value) if value.is_finite() => Ok(value),
        _ => {
            let word = shortened(word);
            Err(problem(line, format!("\"{word}\" is not a finite number")))
        }
    }
}

/// Reads the three coordinates that a line starts with.
pub(super) fn point<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    line: usize,
) -> Result<Point3, MeshError> {
    let mut at = [0.0; 3];
    for (found, x) in at.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            let needs = format!("a vertex needs 3 coordinates, found {found}");
            return Err(problem(line, needs));
        };
        *x = coordinate(word, line)?;
    }
    Ok(at.into())
}

/// Reads a count.
pub(super) fn count(word: Option<&[u8]>, what: &str, line: usize) -> Result<u64, MeshError> {
    word.and_then(number).ok_or_else(|| {
        let word = shortened(word.unwrap_or_default());
        problem(
            line,
            format!("\"{word}\" is no number of {what}: a whole number, 0 or more"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_and_cut_at_comments() {
        let mut lines = Lines::new(b"a b\r\n\n# c\n d # e\nf", Some(b'#'));
        assert_eq!(lines.filled(), Some((1, &b"a b"[..])));
        let (number, line) = lines.filled().unwrap();
        assert_eq!(
            (number, words(line).collect::<Vec<_>>()),
            (4, vec![&b"d"[..]])
        );
        assert_eq!(lines.rest(), b"f");
        assert_eq!(lines.filled(), Some((5, &b"f"[..])));
        assert_eq!(lines.filled(), None);
    }

    /// A byte of binary data behind the last line that looks like LF is kept if lines end with CR alone.
    #[test]
    fn lines_end_with_lf_or_cr_or_both() {
        for (text, rest) in [
            (&b"a\nb\n\r"[..], &b"\r"[..]),
            (b"a\r\nb\r\n\n", b"\n"),
            (b"a\rb\r\n", b"\n"),
        ] {
            let mut lines = Lines::new(text, None);
            assert_eq!(lines.next(), Some((1, &b"a"[..])));
            assert_eq!(lines.next(), Some((2, &b"b"[..])));
            assert_eq!(lines.rest(), rest);
        }
    }

    #[test]
    fn numbers_are_finite_and_messages_short() {
        assert_eq!(coordinate(b"-1.5e3", 1).unwrap(), -1500.0);
        for word in [
            &b"nan"[..],
            b"inf",
            b"1e999",
            b"",
            b"\xff\xfe",
            &[b'x'; 1000],
        ] {
            let message = coordinate(word, 7).unwrap_err().to_string();
            assert!(message.starts_with("line 7: "), "{message}");
            assert!(message.len() < 200, "{message}");
        }
        assert!(count(Some(b"-3"), "faces", 1).is_err());
        assert_eq!(count(Some(b"3"), "faces", 1).unwrap(), 3);
    }
}
