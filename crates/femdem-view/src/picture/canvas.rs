//! The finished picture, with lines and text on it.

use std::io::Write;

use super::colour::{Srgb, viridis};
use super::font::{self, Segment};
use crate::output::base64;

/// An opaque picture, row by row from the top.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Srgb>,
}

impl Image {
    pub(super) fn new(width: usize, pixels: Vec<Srgb>) -> Self {
        let height = pixels.len() / width.max(1);
        Self {
            width,
            height,
            pixels,
        }
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue of a pixel (sRGB); `None` outside the picture.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        let inside = x < self.width && y < self.height;
        inside.then(|| self.pixels[y * self.width + x].0)
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_png(&self, writer: impl Write) -> std::io::Result<()> {
        let too_large = |_| std::io::Error::other("the picture is too large");
        let width = u32::try_from(self.width).map_err(too_large)?;
        let height = u32::try_from(self.height).map_err(too_large)?;
        let mut encoder = png::Encoder::new(writer, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|pixel| pixel.0).collect();
        let mut png = encoder.write_header()?;
        png.write_image_data(&bytes)?;
        png.finish()?;
        Ok(())
    }

    /// Writes the picture as SVG: the same pixels in a frame that text programs can place and scale.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_svg(&self, mut writer: impl Write) -> std::io::Result<()> {
        let mut png = Vec::new();
        self.write_png(&mut png)?;
        let (width, height) = (self.width, self.height);
        writeln!(
            writer,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\">\n<image width=\"{width}\" \
             height=\"{height}\" href=\"data:image/png;base64,{}\"/>\n</svg>",
            base64(&png)
        )
    }

    /// Copies another picture into this one; parts beyond the edge are lost.
    pub(super) fn paste(&mut self, tile: &Self, [left, top]: [usize; 2]) {
        for y in 0..tile.height {
            for x in 0..tile.width {
                self.blend(left + x, top + y, tile.pixels[y * tile.width + x], 1.0);
            }
        }
    }

    pub(super) fn blend(&mut self, x: usize, y: usize, colour: Srgb, amount: f64) {
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[y * self.width + x];
            *pixel = pixel.towards(colour, amount.clamp(0.0, 1.0) as f32);
        }
    }

    /// Draws lines of a width in pixels with round ends, as one mark, so that they do not darken each other
    /// where they meet. `shown` is the visible part of the mark at a pixel.
    pub(super) fn stroke(
        &mut self,
        segments: &[Segment],
        width: f64,
        colour: Srgb,
        shown: impl Fn(usize, usize) -> f64,
    ) {
        let reach = 0.5 * width + 1.0;
        let range = |k: usize, size: usize| {
            let values = || segments.iter().flatten().map(|p| p[k]);
            let low = (values().fold(f64::INFINITY, f64::min) - reach).max(0.0) as usize;
            let high = (values().fold(f64::NEG_INFINITY, f64::max) + reach).max(0.0) as usize;
            low.min(size)..high.saturating_add(1).min(size)
        };
        for y in range(1, self.height) {
            for x in range(0, self.width) {
                let centre = [x as f64 + 0.5, y as f64 + 0.5];
                let near = segments
                    .iter()
                    .map(|s| distance(centre, s))
                    .fold(f64::INFINITY, f64::min);
                let covered = (0.5 * width + 0.5 - near).clamp(0.0, 1.0);
                if covered > 0.0 {
                    self.blend(x, y, colour, covered * shown(x, y));
                }
            }
        }
    }

    /// Writes a line of text with capitals of a height in pixels; `at` is the left end of the
    /// baseline.
    pub(super) fn write(&mut self, text: &str, at: [f64; 2], height: f64, colour: Srgb) {
        let mut x = at[0];
        for c in text.chars() {
            let segments = font::segments(c, [x, at[1]], height);
            self.stroke(&segments, 0.115 * height, colour, |_, _| 1.0);
            x += font::advance(c, height);
        }
    }

    pub(super) fn fill(
        &mut self,
        [left, top]: [usize; 2],
        [right, bottom]: [usize; 2],
        colour: impl Fn(usize) -> Srgb,
    ) {
        for y in top..bottom {
            for x in left..right {
                self.blend(x, y, colour(y), 1.0);
            }
        }
    }
}

fn distance(p: [f64; 2], [a, b]: &Segment) -> f64 {
    let (along, from) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length2 = along[0] * along[0] + along[1] * along[1];
    let t = if length2 > 0.0 {
        ((from[0] * along[0] + from[1] * along[1]) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from[0] - t * along[0]).hypot(from[1] - t * along[1])
}

/// A small picture of values, 0 to 1, row by row from the top, in viridis as PNG.
pub(crate) fn viridis_png(
    width: usize,
    values: impl Iterator<Item = f64>,
) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Image::new(width, values.map(viridis).collect()).write_png(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Srgb = Srgb([255; 3]);
    const BLACK: Srgb = Srgb([0; 3]);

    #[test]
    fn a_line_covers_its_width_times_its_length() {
        let mut image = Image::new(60, vec![WHITE; 60 * 40]);
        image.stroke(&[[[10.0, 10.3], [50.0, 30.1]]], 3.0, BLACK, |_, _| 1.0);
        let ink: f64 = image
            .pixels
            .iter()
            .map(|p| 1.0 - f64::from(p.0[0]) / 255.0)
            .sum();
        // With its round ends.
        let expected = 3.0 * 40.0_f64.hypot(19.8) + std::f64::consts::PI * 1.5 * 1.5;
        assert!((ink / expected - 1.0).abs() < 0.02, "{ink} {expected}");
    }

    #[test]
    fn lines_and_letters_may_leave_the_picture() {
        let mut image = Image::new(10, vec![WHITE; 100]);
        image.stroke(&[[[-1e9, -1e9], [1e9, 1e9]]], 1.0, BLACK, |_, _| 1.0);
        image.write("far away", [-20.0, 500.0], 12.0, BLACK);
        assert_eq!(image.pixel(5, 5), Some([0; 3]));
        assert_eq!(image.pixel(9, 0), Some([255; 3]));
        assert_eq!(image.pixel(10, 0), None);
    }

    #[test]
    fn png_holds_the_pixels() {
        let mut image = Image::new(7, vec![WHITE; 35]);
        image.blend(3, 2, Srgb([10, 20, 30]), 1.0);
        let mut bytes = Vec::new();
        image.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert_eq!(pixels.len(), 7 * 5 * 3);
        assert_eq!(pixels[(2 * 7 + 3) * 3..][..3], [10, 20, 30]);
    }
}
