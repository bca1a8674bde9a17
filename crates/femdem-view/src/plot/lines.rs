//! Lines over time or strain.

use super::axis::Axis;
use super::chart::{Chart, Hue};
use super::svg::{Plot, escape};

/// Most lines of a chart: the colours that can be told apart.
const LINES: usize = 6;

/// Part of the largest line up to which another cannot be told from zero.
const SEEN: f64 = 1e-3;

/// Points of a line above which each part of it is drawn by its lowest and its highest.
const POINTS: usize = 600;

/// A quantity of several things over another, such as the forces on walls over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineChart {
    /// Short name for files.
    pub name: String,
    /// Title.
    pub title: String,
    /// Quantity and unit across, such as "time / s".
    pub x: String,
    /// Quantity and unit upwards.
    pub y: String,
    /// What the lines show.
    pub caption: String,
    /// Names of the things, and their points.
    pub lines: Vec<(String, Vec<[f64; 2]>)>,
}

impl LineChart {
    /// The chart. Lines that cannot be told from zero are left out, and of more than six the smaller ones, which the caption then
    /// says. `None` if no line is left, or x does not change.
    ///
    /// ```
    /// use femdem_view::plot::LineChart;
    ///
    /// let lines = vec![("lid".to_owned(), vec![[0.0, 0.0], [0.1, 5.0]]), ("floor".to_owned(), vec![[0.0, 0.0], [0.1, 0.0]])];
    /// let chart = LineChart { name: "forces".to_owned(), y: "force / N".to_owned(), lines, ..LineChart::default() };
    /// let svg = chart.plot().ok_or("no plot")?.svg();
    /// assert!(svg.contains(">lid<") && !svg.contains(">floor<"));
    /// # Ok::<(), &str>(())
    /// ```
    #[must_use]
    pub fn plot(&self) -> Option<Plot> {
        let size = |points: &[[f64; 2]]| {
            let finite = points.iter().map(|p| p[1].abs()).filter(|y| y.is_finite());
            finite.fold(0.0, f64::max)
        };
        let sizes: Vec<f64> = self.lines.iter().map(|(_, points)| size(points)).collect();
        let least = SEEN * sizes.iter().copied().fold(0.0, f64::max);
        let mut shown: Vec<usize> = (0..sizes.len()).filter(|&k| sizes[k] > least).collect();
        shown.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
        let left_out = shown.len().saturating_sub(LINES);
        shown.truncate(LINES);
        shown.sort_unstable();
        let lines: Vec<_> = shown.iter().map(|&k| &self.lines[k]).collect();
        let points = || lines.iter().flat_map(|(_, points)| points);
        let ends = |axis: usize| {
            let values = || points().map(|p| p[axis]).filter(|v| v.is_finite());
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            [low, high]
        };
        let ([left, right], [low, high]) = (ends(0), ends(1));
        if right <= left || !low.is_finite() {
            return None;
        }
        // From or to zero where no value lies beyond, with a little free where the lines end.
        let (low, high) = (low.min(0.0), high.max(0.0));
        let margin = 0.04 * (high - low);
        let beyond = |value: f64, by: f64| if value == 0.0 { value } else { value + by };
        let mut chart = Chart::new(
            Axis::linear(&escape(&self.x), left, right),
            Axis::linear(&escape(&self.y), beyond(low, -margin), beyond(high, margin)),
        );
        if low < 0.0 {
            chart.level(0.0);
        }
        // The key stands in the upper corner with fewer points.
        let crowd = |is_left: bool| {
            let across = |p: &[f64; 2]| (p[0] - left) / (right - left);
            let is_there = |p: &&[f64; 2]| {
                let across = if is_left { across(p) } else { 1.0 - across(p) };
                across < 0.5 && p[1] - low > 0.6 * (high - low)
            };
            points().filter(is_there).count()
        };
        if crowd(true) < crowd(false) {
            chart.key_at_left();
        }
        for ((name, points), hue) in lines.iter().zip(Hue::ALL) {
            chart.line(hue, &thinned(points));
            if self.lines.len() > 1 {
                chart.name(hue, &escape(name));
            }
        }
        let left_out = match left_out {
            0 => String::new(),
            count => format!(" The {LINES} largest are drawn, {count} more are not."),
        };
        let caption = format!("{}{left_out}", self.caption);
        Some(Plot::of(self.name.clone(), &self.title, caption, chart))
    }
}

/// At most about [`POINTS`] points, among them the ends, peaks and valleys.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= POINTS {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(POINTS + 4);
    let last = points.len() - 1;
    kept.push(points[0]);
    for part in points[1..last].chunks(points.len().div_ceil(POINTS / 2)) {
        let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let ends = [part.iter().min_by(by_height), part.iter().max_by(by_height)];
        let mut ends: Vec<[f64; 2]> = ends.into_iter().flatten().copied().collect();
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        kept.extend(ends);
    }
    kept.push(points[last]);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(name: &str, y: impl Fn(f64) -> f64, count: u32) -> (String, Vec<[f64; 2]>) {
        let points = (0..count).map(|k| [f64::from(k), y(f64::from(k))]);
        (name.to_owned(), points.collect())
    }

    fn chart(lines: Vec<(String, Vec<[f64; 2]>)>) -> LineChart {
        LineChart {
            lines,
            ..LineChart::default()
        }
    }

    #[test]
    fn the_largest_lines_are_drawn_and_the_others_counted() {
        let lines = (0..9).map(|k| line(&format!("w{k}"), |x| f64::from(k) * x, 5));
        let plot = chart(lines.collect()).plot().unwrap();
        let names = |name: &str| plot.content.contains(&format!(">{name}<"));
        assert!(names("w8") && names("w3") && !names("w2") && !names("w0"));
        // The one that is zero throughout is nothing to draw.
        assert!(plot.caption.contains("2 more"), "{}", plot.caption);
    }

    #[test]
    fn long_lines_keep_their_peak_and_their_ends() {
        let (_, points) = line("a", |x| if x == 4321.0 { 7.0 } else { 1e-3 * x }, 10_000);
        let kept = thinned(&points);
        assert!(kept.len() <= POINTS + 2, "{}", kept.len());
        assert_eq!((kept[0], kept.last()), (points[0], points.last()));
        assert!(kept.contains(&[4321.0, 7.0]));
        assert!(kept.windows(2).all(|pair| pair[0][0] <= pair[1][0]));
    }

    #[test]
    fn nothing_is_no_chart() {
        assert!(chart(Vec::new()).plot().is_none());
        assert!(chart(vec![line("a", |_| 0.0, 5)]).plot().is_none());
        assert!(chart(vec![line("a", |_| f64::NAN, 5)]).plot().is_none());
        assert!(chart(vec![line("a", |_| 1.0, 1)]).plot().is_none());
    }
}
