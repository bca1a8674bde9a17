//! The scale bar.

use super::canvas::Image;
use super::colour::Srgb;
use super::font;
use crate::output::short_number;

const INK: Srgb = Srgb([0x33, 0x33, 0x33]);

/// The longest bar, in picture widths.
const LONGEST: f64 = 0.2;

/// Height of the strip for the bar, in picture heights.
pub(super) const STRIP: f64 = 0.045;

/// Draws a bar of a round length at the lower left. It holds in the middle of what is drawn: in a perspective nearer things
/// look larger.
pub(super) fn draw(image: &mut Image, pixels_per_metre: f64) {
    let (width, height) = (image.width() as f64, image.height() as f64);
    let Some(length) = round_below(LONGEST * width / pixels_per_metre) else {
        return;
    };
    let text = (0.012 * height).max(5.0);
    let (left, bottom) = (0.035 * width, height - 0.02 * height);
    let right = left + length * pixels_per_metre;
    let tick = 0.5 * text;
    let lines = [
        [[left, bottom], [right, bottom]],
        [[left, bottom - tick], [left, bottom]],
        [[right, bottom - tick], [right, bottom]],
    ];
    image.stroke(&lines, 0.15 * text, INK, |_, _| 1.0);
    let name = name(length);
    let start = 0.5 * (left + right - font::width(&name, text));
    image.write(&name, [start, bottom - 1.2 * text], text, INK);
}

/// The largest of 1, 2 and 5 times a power of ten up to `most`; `None` unless that is a length.
fn round_below(most: f64) -> Option<f64> {
    if !(most > 0.0 && most.is_finite()) {
        return None;
    }
    let power = 10_f64.powf(most.log10().floor());
    let fits = [5.0, 2.0, 1.0].into_iter().find(|x| x * power <= most);
    Some(fits.unwrap_or(1.0) * power)
}

/// A length \[m\] with a unit that makes its number short.
fn name(length: f64) -> String {
    let (unit, name) = match length {
        x if x >= 0.999 => (1.0, "m"),
        x if x >= 0.999e-3 => (1e-3, "mm"),
        _ => (1e-6, "um"),
    };
    format!("{} {name}", short_number(length / unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_have_units() {
        for (most, text) in [
            (0.37, "200 mm"),
            (0.6, "500 mm"),
            (1.0, "1 m"),
            (7.3e-3, "5 mm"),
            (1.7e-5, "10 um"),
            (42.0, "20 m"),
        ] {
            assert_eq!(name(round_below(most).unwrap()), text);
        }
        assert!(round_below(0.0).is_none() && round_below(f64::INFINITY).is_none());
    }

    /// The bar is as long as the scale says.
    #[test]
    fn a_bar_has_its_length() {
        let mut image = Image::new(400, vec![Srgb([255; 3]); 400 * 300]);
        draw(&mut image, 1000.0);
        // 0.08 m fit a fifth of the width: 50 mm are 50 pixels.
        let dark = |y: usize| {
            (0..400)
                .filter(|&x| image.pixel(x, y).unwrap()[0] < 250)
                .count()
        };
        let longest = (250..300).map(dark).max().unwrap();
        assert!((50..=52).contains(&longest), "{longest}");
    }
}
