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

/// Lines with their numbers, from 1, up to a comment if a character that starts comments is given.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    comment: Option<u8>,
    /// Number of the last line returned.
    pub(super) number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8], comment: Option<u8>) -> Self {
        Self {
            rest: without_mark(bytes),
            comment,
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
        let end = self.rest.iter().position(|&b| b == b'\n');
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
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
        assert_eq!(lines.filled(), Some((1, &b"a b\r"[..])));
        let (number, line) = lines.filled().unwrap();
        assert_eq!(
            (number, words(line).collect::<Vec<_>>()),
            (4, vec![&b"d"[..]])
        );
        assert_eq!(lines.rest(), b"f");
        assert_eq!(lines.filled(), Some((5, &b"f"[..])));
        assert_eq!(lines.filled(), None);
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
