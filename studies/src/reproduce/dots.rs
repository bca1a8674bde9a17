//! Charts of values with error bars over named positions, as SVG.

use std::fmt::Write;

use super::case::Found;
use super::readings::Reading;
use crate::validate::chart::COLOURS;

const HEIGHT: f64 = 400.0;
/// Left, top, bottom, right.
const MARGIN: [f64; 4] = [60.0, 20.0, 60.0, 130.0];
/// Width of a place.
const STEP: f64 = 46.0;

/// A value at a position, with its standard error if known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dot {
    pub(super) place: usize,
    pub(super) value: f64,
    pub(super) error: f64,
}

/// Dots of one colour.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) dots: Vec<Dot>,
}

impl Series {
    /// The densities of a reading's cases, each at its position.
    pub(super) fn of_reading(reading: &Reading, found: &[Found]) -> Self {
        let dot = |(place, found): (usize, &Found)| {
            let density = found.density()?;
            Some(Dot {
                place,
                value: density.mean,
                error: density.error,
            })
        };
        Self {
            name: reading.key.to_owned(),
            dots: found.iter().enumerate().filter_map(dot).collect(),
        }
    }
}

/// A chart with the positions side by side. Bars are one standard error up and down.
pub(super) fn svg(labels: [&str; 2], places: &[&str], series: &[Series]) -> String {
    let [left, top, bottom, right] = MARGIN;
    let width = left + right + STEP * places.len() as f64;
    let [low, high] = range(series);
    let up = |v: f64| HEIGHT - bottom - (v - low) / (high - low) * (HEIGHT - top - bottom);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    let lines = ((high - low) / 0.02).round().clamp(1.0, 20.0);
    for k in 0..=lines as u32 {
        let value = low + (high - low) * f64::from(k) / lines;
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {0:.1}H{1:.1}\" stroke=\"#ddd\"/><text x=\"{2:.1}\" y=\"{3:.1}\" \
             text-anchor=\"end\">{value:.2}</text>",
            up(value),
            width - right,
            left - 6.0,
            up(value) + 4.0
        );
    }
    let middle = |place: usize| left + STEP * (place as f64 + 0.5);
    for (place, name) in places.iter().enumerate() {
        let y = HEIGHT - bottom + 18.0;
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{name}</text>",
            middle(place)
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
         <text x=\"14\" y=\"{:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {3:.1})\">{}</text>",
        0.5 * (left + width - right),
        HEIGHT - 14.0,
        labels[0],
        0.5 * (top + HEIGHT - bottom),
        labels[1]
    );
    for (k, line) in series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let aside = STEP * 0.7 * ((k as f64 + 0.5) / series.len() as f64 - 0.5);
        for dot in line.dots.iter().filter(|dot| dot.value.is_finite()) {
            let x = middle(dot.place) + aside;
            let error = if dot.error.is_finite() {
                dot.error
            } else {
                0.0
            };
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"{colour}\" stroke-width=\"1.5\"/>\
                 <circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"3.2\" fill=\"{colour}\"/>",
                up(dot.value - error),
                up(dot.value + error),
                up(dot.value)
            );
        }
        let at = top + 14.0 + 16.0 * k as f64;
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3.2\" fill=\"{colour}\"/><text x=\"{:.1}\" y=\"{at:.1}\">{}</text>",
            width - right + 14.0,
            at - 4.0,
            width - right + 24.0,
            line.name
        );
    }
    svg + "</svg>\n"
}

/// A range of round hundredths about all values and bars.
fn range(series: &[Series]) -> [f64; 2] {
    let [mut low, mut high] = [f64::INFINITY, f64::NEG_INFINITY];
    for dot in series
        .iter()
        .flat_map(|s| &s.dots)
        .filter(|d| d.value.is_finite())
    {
        let error = if dot.error.is_finite() {
            dot.error
        } else {
            0.0
        };
        low = low.min(dot.value - error);
        high = high.max(dot.value + error);
    }
    if low > high {
        return [0.0, 1.0];
    }
    let step = 0.02;
    [
        (low / step - 0.25).floor() * step,
        (high / step + 0.25).ceil() * step,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_bars_are_inside_and_unknown_values_left_out() {
        let dot = |place, value, error| Dot {
            place,
            value,
            error,
        };
        let series = vec![
            Series {
                name: "ours".to_owned(),
                dots: vec![
                    dot(0, 0.57, 0.01),
                    dot(1, 0.61, f64::NAN),
                    dot(1, f64::NAN, 0.0),
                ],
            },
            Series {
                name: "paper".to_owned(),
                dots: vec![dot(0, 0.55, 0.003)],
            },
        ];
        let [low, high] = range(&series);
        assert!(low < 0.547 && low > 0.5 && high > 0.61 && high < 0.65);
        let text = svg(["shape", "density"], &["A", "B"], &series);
        // Three dots and two in the key.
        assert_eq!(text.matches("<circle").count(), 5);
        assert!(!text.contains("NaN") && text.contains(">paper<"));
        assert_eq!(range(&[]), [0.0, 1.0]);
    }
}
