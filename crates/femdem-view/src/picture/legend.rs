//! The colour bar.

use super::canvas::Image;
use super::colour::{Srgb, viridis};
use super::font;
use crate::BodyValues;
use crate::output::short_number;

const INK: Srgb = Srgb([0x33, 0x33, 0x33]);

/// Draws the bar of the values' scale in the strip of `width` pixels at the right edge.
pub(super) fn draw(image: &mut Image, width: f64, values: &BodyValues) {
    let text = (0.012 * image.height() as f64).max(5.0);
    let (top, bottom) = (0.2 * image.height() as f64, 0.8 * image.height() as f64);
    let left = image.width() as f64 - width;
    let right = left + 0.16 * width;
    image.fill(
        [left as usize, top as usize],
        [right as usize, bottom as usize],
        |y| viridis((bottom - y as f64 - 0.5) / (bottom - top)),
    );
    let line = 0.1 * text;
    let frame = [
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
        [left, top],
    ];
    let frame: Vec<_> = frame.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    image.stroke(&frame, line, INK, |_, _| 1.0);
    for tick in values.ticks() {
        let y = bottom - (bottom - top) * values.place(tick).unwrap_or(0.0);
        image.stroke(
            &[[[right, y], [right + 0.5 * text, y]]],
            line,
            INK,
            |_, _| 1.0,
        );
        image.write(
            &short_number(tick),
            [right + text, y + 0.5 * text],
            text,
            INK,
        );
    }
    let title = folded(&values.title, 12);
    let widest = title
        .lines()
        .map(|row| font::width(row, text))
        .fold(0.0, f64::max);
    let start = left.min(image.width() as f64 - widest - text);
    let mut y = top - 1.4 * text;
    for row in title.lines().rev() {
        image.write(row, [start, y], text, INK);
        y -= 1.9 * text;
    }
}

/// A title in lines of about `most` letters, broken between words.
fn folded(title: &str, most: usize) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in title.split(' ') {
        match lines.last_mut() {
            Some(line) if line.len() + word.len() < most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_are_broken_between_words() {
        assert_eq!(
            folded("sequence of placement", 12),
            "sequence of\nplacement"
        );
        assert_eq!(folded("tilt", 12), "tilt");
    }
}
