//! A chart with two axes, as SVG.

use std::fmt::Write as _;

use super::axis::Axis;

/// Size of a chart and of its margins, in SVG units.
pub(super) const WIDTH: f64 = 380.0;
pub(super) const HEIGHT: f64 = 280.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 46.0;

/// Colour of a mark, from the style sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hue {
    First,
    Second,
    Third,
    Fourth,
    Fifth,
    /// That of the text: what others are compared with.
    Ink,
}

impl Hue {
    /// All, in the order in which they are taken.
    pub const ALL: [Self; 6] = [
        Self::First,
        Self::Second,
        Self::Third,
        Self::Fourth,
        Self::Ink,
        Self::Fifth,
    ];

    const fn class(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Second => "second",
            Self::Third => "third",
            Self::Fourth => "fourth",
            Self::Fifth => "fifth",
            Self::Ink => "ink",
        }
    }
}

/// A point, and the ends of its error bar along y.
pub(super) type Dot = ([f64; 2], Option<[f64; 2]>);

/// A chart under construction.
pub(super) struct Chart {
    x: Axis,
    y: Axis,
    marks: String,
    names: Vec<(Hue, String)>,
    key_at_left: bool,
}

impl Chart {
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            marks: String::new(),
            names: Vec::new(),
            key_at_left: false,
        }
    }

    /// Position of a point in SVG units; kept near the chart.
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let across = self.x.place(x).clamp(-0.5, 1.5);
        let up = self.y.place(y).clamp(-0.5, 1.5);
        [
            LEFT + (WIDTH - LEFT - RIGHT) * across,
            HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * up,
        ]
    }

    /// Adds a name for a colour to the key.
    pub fn name(&mut self, hue: Hue, name: &str) {
        self.names.push((hue, name.to_owned()));
    }

    /// Moves the key to the upper left, for lines that rise.
    pub fn key_at_left(&mut self) {
        self.key_at_left = true;
    }

    /// A line through points, broken where one is not finite.
    pub fn line(&mut self, hue: Hue, points: &[[f64; 2]]) {
        let finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
        for part in points.split(|p| !finite(p)).filter(|part| part.len() > 1) {
            let path = self.path(part);
            let _ = writeln!(
                self.marks,
                "<path class=\"line {}\" d=\"{path}\"/>",
                hue.class()
            );
        }
    }

    /// The area between two lines.
    pub fn band(&mut self, hue: Hue, low: &[[f64; 2]], high: &[[f64; 2]]) {
        let around: Vec<[f64; 2]> = low.iter().chain(high.iter().rev()).copied().collect();
        if around.iter().flatten().all(|x| x.is_finite()) && around.len() > 3 {
            let path = self.path(&around);
            let _ = writeln!(
                self.marks,
                "<path class=\"band {}\" d=\"{path}Z\"/>",
                hue.class()
            );
        }
    }

    /// Dots, each with the ends of its error bar along y.
    pub fn dots(&mut self, hue: Hue, dots: &[Dot]) {
        for (point, error) in dots.iter().filter(|(p, _)| p.iter().all(|x| x.is_finite())) {
            let [x, y] = self.at(*point);
            if let Some([low, high]) = error {
                let [[_, bottom], [_, top]] = [*low, *high].map(|y| self.at([point[0], y]));
                let (bottom, top) = (bottom.min(HEIGHT - BOTTOM), top.max(TOP));
                let _ = writeln!(
                    self.marks,
                    "<path class=\"line thin {}\" d=\"M{x:.1} {bottom:.1}V{top:.1}\"/>",
                    hue.class()
                );
            }
            let _ = writeln!(
                self.marks,
                "<circle class=\"dot {}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\"/>",
                hue.class()
            );
        }
    }

    /// An upright bar from 0, with a text that appears on hovering.
    pub fn bar(&mut self, hue: Hue, [from, to]: [f64; 2], height: f64, words: &str) {
        let ([left, top], [right, bottom]) = (self.at([from, height]), self.at([to, 0.0]));
        let (width, tall) = ((right - left).max(0.5), (bottom - top).max(0.0));
        let _ = writeln!(
            self.marks,
            "<rect class=\"bar {}\" x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" \
             height=\"{tall:.1}\"><title>{words}</title></rect>",
            hue.class()
        );
    }

    /// A dashed horizontal line at a value of y.
    pub fn level(&mut self, y: f64) {
        let [_, y] = self.at([0.0, y]);
        let _ = writeln!(
            self.marks,
            "<path class=\"rule\" d=\"M{LEFT} {y:.1}H{:.1}\"/>",
            WIDTH - RIGHT
        );
    }

    /// A dashed vertical line at a value of x.
    pub fn upright(&mut self, x: f64) {
        let [x, _] = self.at([x, 0.0]);
        let _ = writeln!(
            self.marks,
            "<path class=\"rule\" d=\"M{x:.1} {:.1}V{TOP}\"/>",
            HEIGHT - BOTTOM
        );
    }

    fn path(&self, points: &[[f64; 2]]) -> String {
        let mut path = String::new();
        for (k, point) in points.iter().enumerate() {
            let [x, y] = self.at(*point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
        }
        path
    }

    /// The contents of the SVG element.
    pub fn finish(self) -> String {
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        let mut svg = String::new();
        let _ = writeln!(svg, "<g class=\"grid\">");
        let mut numbers = String::new();
        for tick in self.x.ticks() {
            let [x, _] = self.at([tick, 0.0]);
            let _ = writeln!(svg, "<path d=\"M{x:.1} {TOP}V{bottom:.1}\"/>");
            let y = bottom + 16.0;
            let _ = writeln!(
                numbers,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{}</text>",
                self.x.text(tick)
            );
        }
        for tick in self.y.ticks() {
            let [_, y] = self.at([0.0, tick]);
            let _ = writeln!(svg, "<path d=\"M{LEFT} {y:.1}H{right:.1}\"/>");
            let (x, y) = (LEFT - 7.0, y + 4.0);
            let _ = writeln!(
                numbers,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>",
                self.y.text(tick)
            );
        }
        let (middle, low) = (0.5 * (LEFT + right), HEIGHT - 8.0);
        let (x, y) = (14.0, 0.5 * (TOP + bottom));
        let _ = write!(
            svg,
            "</g>\n<svg x=\"{LEFT}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\" viewBox=\"{LEFT} {TOP} {:.1} {:.1}\">\n{}</svg>\n\
             <path class=\"axes\" d=\"M{LEFT} {TOP}V{bottom:.1}H{right:.1}\"/>\n{numbers}\
             <text class=\"label\" x=\"{middle:.1}\" y=\"{low:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text class=\"label\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 {x:.1} {y:.1})\">{}</text>\n",
            right - LEFT,
            bottom - TOP,
            right - LEFT,
            bottom - TOP,
            self.marks,
            self.x.label,
            self.y.label
        );
        let (ends, text, anchor) = if self.key_at_left {
            ([LEFT + 8.0, LEFT + 20.0], LEFT + 26.0, "start")
        } else {
            ([right - 20.0, right - 8.0], right - 26.0, "end")
        };
        let mut y = TOP + 16.0;
        for (hue, name) in &self.names {
            let _ = writeln!(
                svg,
                "<text class=\"key\" x=\"{text:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{name}</text>\
                 <path class=\"line key {}\" d=\"M{:.1} {:.1}H{:.1}\"/>",
                hue.class(),
                ends[0],
                y - 4.0,
                ends[1]
            );
            y += 16.0;
        }
        svg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        Chart::new(
            Axis::linear("x / m", 0.0, 10.0),
            Axis::linear("y", 0.0, 1.0),
        )
    }

    #[test]
    fn the_corners_of_the_axes_are_the_corners_of_the_frame() {
        assert_eq!(chart().at([0.0, 0.0]), [LEFT, HEIGHT - BOTTOM]);
        assert_eq!(chart().at([10.0, 1.0]), [WIDTH - RIGHT, TOP]);
    }

    #[test]
    fn lines_break_where_a_number_is_missing() {
        let mut chart = chart();
        chart.line(
            Hue::First,
            &[
                [0.0, 0.5],
                [1.0, 0.5],
                [2.0, f64::NAN],
                [3.0, 0.5],
                [4.0, 0.5],
            ],
        );
        assert_eq!(chart.marks.matches("<path").count(), 2);
    }

    #[test]
    fn a_bar_stands_on_zero_and_says_its_words() {
        let mut chart = chart();
        chart.bar(Hue::First, [2.0, 4.0], 0.5, "half");
        let width = (WIDTH - LEFT - RIGHT) * 0.2;
        let height = (HEIGHT - TOP - BOTTOM) * 0.5;
        assert!(
            chart
                .marks
                .contains(&format!("width=\"{width:.1}\" height=\"{height:.1}\""))
        );
        assert!(chart.finish().contains("<title>half</title>"));
    }
}
