//! The colour bar.

use super::canvas::Image;
use super::colour::{Srgb, viridis};
use super::font;

const INK: Srgb = Srgb([0x33, 0x33, 0x33]);

/// Draws a bar from 0 to `last` in the strip of `width` pixels at the right edge.
pub(super) fn draw(image: &mut Image, width: f64, last: u32, title: &str) {
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
    for tick in ticks(last) {
        let y = bottom - (bottom - top) * f64::from(tick) / f64::from(last.max(1));
        image.stroke(
            &[[[right, y], [right + 0.5 * text, y]]],
            line,
            INK,
            |_, _| 1.0,
        );
        image.write(&tick.to_string(), [right + text, y + 0.5 * text], text, INK);
    }
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

/// Round numbers from 0 to `last`, about six, then `last` itself.
fn ticks(last: u32) -> Vec<u32> {
    let steps = (0..9).flat_map(|power| [1, 2, 5].map(|digit| digit * 10_u32.pow(power)));
    let step = steps
        .into_iter()
        .find(|step| last / step <= 6)
        .unwrap_or(u32::MAX);
    let mut ticks: Vec<u32> = (0..=last / step).map(|k| k * step).collect();
    // The last number stands at the end of the bar, and takes the place of one too near to it.
    ticks.retain(|tick| *tick == 0 || last - tick >= step.div_ceil(2));
    if last > 0 {
        ticks.push(last);
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_end_with_the_last() {
        assert_eq!(ticks(0), [0]);
        assert_eq!(ticks(1), [0, 1]);
        assert_eq!(ticks(499), [0, 100, 200, 300, 400, 499]);
        assert_eq!(ticks(520), [0, 100, 200, 300, 400, 520]);
        assert_eq!(ticks(10_999), [0, 2000, 4000, 6000, 8000, 10_999]);
        assert_eq!(ticks(u32::MAX).last(), Some(&u32::MAX));
    }
}
