//! Line charts as SVG, for pages.

use std::fmt::Write;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const MARGIN: [f64; 4] = [60.0, 20.0, 50.0, 170.0];
/// Colours of series.
pub(crate) const COLOURS: [&str; 6] = [
    "#0b6e8f", "#c8553d", "#4d7c31", "#7a4fa3", "#b58900", "#555555",
];

/// A named line through points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 2]>,
}

/// A chart of lines with dots at their points, as many as 40 each.
pub(crate) fn svg(labels: [&str; 2], x: [f64; 2], y: [f64; 2], series: &[Series]) -> String {
    let [left, top, bottom, right] = MARGIN;
    let across = |v: f64| left + (v - x[0]) / (x[1] - x[0]) * (WIDTH - left - right);
    let up = |v: f64| HEIGHT - bottom - (v - y[0]) / (y[1] - y[0]) * (HEIGHT - top - bottom);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    for k in 0..=5 {
        let part = |range: [f64; 2]| range[0] + (range[1] - range[0]) * f64::from(k) / 5.0;
        let (vx, vy) = (part(x), part(y));
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {top}V{1:.1}M{left} {2:.1}H{3:.1}\" stroke=\"#ddd\" fill=\"none\"/>\
             <text x=\"{0:.1}\" y=\"{4:.1}\" text-anchor=\"middle\">{vx:.3}</text>\
             <text x=\"{5:.1}\" y=\"{6:.1}\" text-anchor=\"end\">{vy:.3}</text>",
            across(vx),
            HEIGHT - bottom,
            up(vy),
            WIDTH - right,
            HEIGHT - bottom + 16.0,
            left - 6.0,
            up(vy) + 4.0
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
         <text x=\"14\" y=\"{:.1}\" text-anchor=\"middle\" transform=\"rotate(-90 14 {3:.1})\">{}</text>",
        0.5 * (left + WIDTH - right),
        HEIGHT - 10.0,
        labels[0],
        0.5 * (top + HEIGHT - bottom),
        labels[1]
    );
    for (k, line) in series.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let dash = ["", "6 3", "2 3"][k / COLOURS.len() % 3];
        let places: Vec<String> = line
            .points
            .iter()
            .filter(|p| p.iter().all(|v| v.is_finite()))
            .map(|p| format!("{:.1} {:.1}", across(p[0]), up(p[1])))
            .collect();
        let _ = writeln!(
            svg,
            "<path d=\"M{}\" stroke=\"{colour}\" stroke-width=\"1.5\" stroke-dasharray=\"{dash}\" fill=\"none\"/>",
            places.join("L")
        );
        if places.len() <= 40 {
            for [a, b] in line.points.iter().map(|p| [across(p[0]), up(p[1])]) {
                let _ = writeln!(
                    svg,
                    "<circle cx=\"{a:.1}\" cy=\"{b:.1}\" r=\"2.5\" fill=\"{colour}\"/>"
                );
            }
        }
        let at = top + 14.0 + 16.0 * k as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{0:.1} {1:.1}h18\" stroke=\"{colour}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>\
             <text x=\"{2:.1}\" y=\"{at:.1}\">{3}</text>",
            WIDTH - right + 8.0,
            at - 4.0,
            WIDTH - right + 30.0,
            line.name
        );
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_the_ranges_are_the_corners_of_the_frame() {
        let line = Series {
            name: "a".to_owned(),
            points: vec![[0.0, 1.0], [2.0, 3.0]],
        };
        let text = svg(["x", "y"], [0.0, 2.0], [1.0, 3.0], &[line]);
        assert!(text.contains("d=\"M60.0 350.0L470.0 20.0\""), "{text}");
        assert_eq!(text.matches("<circle").count(), 2);
    }
}
