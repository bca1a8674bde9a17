//! A number over a parameter that was varied.

use super::axis::Axis;
use super::chart::{Chart, Dot, Hue};
use super::svg::{Plot, escape};

/// Results over the values of a parameter, the others being as `name` says.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Values of the other parameters; empty if there are none.
    pub name: String,
    /// Value of the parameter, mean of the results, and its standard error.
    pub points: Vec<(String, f64, Option<f64>)>,
}

/// A chart of a number named `y` over the `values` of a parameter `x`, with its standard errors. Values that are numbers have
/// their places on an axis, others stand side by side in their order. `None` without a result, or for one value alone.
///
/// ```
/// use femdem_view::plot::{Series, sweep};
///
/// let values = ["0.2", "0.4"].map(str::to_owned);
/// let points = vec![(values[0].clone(), 0.64, Some(0.01)), (values[1].clone(), 0.60, None)];
/// let series = [Series { name: String::new(), points }];
/// let plot = sweep("friction", "packing density", &values, &series).ok_or("no plot")?;
/// assert!(plot.svg().contains("friction"));
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn sweep(x: &str, y: &str, values: &[String], series: &[Series]) -> Option<Plot> {
    let numbers: Option<Vec<f64>> = values.iter().map(|text| text.parse().ok()).collect();
    let numbers = numbers.filter(|all: &Vec<f64>| all.iter().all(|x| x.is_finite()));
    let place = |value: &String| {
        let at = values.iter().position(|known| known == value)?;
        Some(numbers.as_ref().map_or(at as f64, |all| all[at]))
    };
    let dots = |series: &Series| {
        let points = series.points.iter();
        let known = points.filter_map(|(value, mean, error)| Some((place(value)?, *mean, *error)));
        let known = known.filter(|(_, mean, _)| mean.is_finite());
        let mut dots: Vec<Dot> = known
            .map(|(x, mean, error)| ([x, mean], error.map(|e| [mean - e, mean + e])))
            .collect();
        dots.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        dots
    };
    let all: Vec<_> = series.iter().map(dots).collect();
    let ends = |of: &dyn Fn(&Dot) -> [f64; 2]| {
        let each = || all.iter().flatten().map(of);
        let low = each().map(|[low, _]| low).fold(f64::INFINITY, f64::min);
        let high = each()
            .map(|[_, high]| high)
            .fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    };
    let [left, right] = ends(&|(point, _)| [point[0]; 2]);
    let [low, high] = ends(&|(point, error)| error.unwrap_or([point[1]; 2]));
    if right <= left || !low.is_finite() {
        return None;
    }
    let names: Vec<&str> = values.iter().map(String::as_str).collect();
    let label = escape(x);
    let across = match numbers {
        Some(_) => {
            let margin = 0.05 * (right - left);
            Axis::linear(&label, left - margin, right + margin)
        }
        None => Axis::classes(&label, &names),
    };
    // A number that does not change stands in the middle.
    let margin = if high > low {
        0.1 * (high - low)
    } else {
        0.5 * high.abs().max(1.0)
    };
    let mut chart = Chart::new(
        across,
        Axis::linear(&escape(y), low - margin, high + margin),
    );
    let hues = [Hue::First, Hue::Second];
    for ((dots, series), hue) in all.iter().zip(series).zip(hues.into_iter().cycle()) {
        let points: Vec<[f64; 2]> = dots.iter().map(|(point, _)| *point).collect();
        chart.line(hue, &points);
        chart.dots(hue, dots);
        if all.len() > 1 && all.len() <= hues.len() {
            chart.name(hue, &escape(&series.name));
        }
    }
    let several = match all.len() {
        0 | 1 => String::new(),
        _ => {
            let names: Vec<&str> = series.iter().map(|s| s.name.as_str()).collect();
            format!(" One line for each of: {}.", names.join("; "))
        }
    };
    let caption =
        format!("Means of the jobs with the same values; bars are standard errors.{several}");
    Some(Plot::of("sweep", &format!("{y} over {x}"), caption, chart))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(name: &str, points: &[(&str, f64)]) -> Series {
        let point = |&(value, mean): &(&str, f64)| (value.to_owned(), mean, Some(0.1));
        Series {
            name: name.to_owned(),
            points: points.iter().map(point).collect(),
        }
    }

    fn values(of: &[&str]) -> Vec<String> {
        of.iter().map(|&text| text.to_owned()).collect()
    }

    #[test]
    fn numbers_have_their_places_and_names_stand_in_order() {
        // Given out of order; on the axis they are in order, the middle one nearer to the left.
        let of_numbers = series("", &[("0.8", 3.0), ("0.2", 1.0), ("0.3", 2.0)]);
        let plot = sweep(
            "friction",
            "density",
            &values(&["0.8", "0.2", "0.3"]),
            &[of_numbers],
        );
        let content = plot.unwrap().content;
        let places = |content: &str| -> Vec<f64> {
            let marks = content.split("cx=\"").skip(1);
            marks
                .map(|mark| mark.split('"').next().unwrap().parse().unwrap())
                .collect()
        };
        let x = places(&content);
        assert_eq!(x.len(), 3);
        assert!(
            ((x[1] - x[0]) / (x[2] - x[0]) - 1.0 / 6.0).abs() < 1e-3,
            "{x:?}"
        );
        let of_names = series("", &[("P5", 1.0), ("A10", 2.0), ("A1", 2.0)]);
        let content = sweep(
            "shape",
            "density",
            &values(&["P5", "A10", "A1"]),
            &[of_names],
        )
        .unwrap()
        .content;
        let x = places(&content);
        assert!((x[2] - 2.0 * x[1] + x[0]).abs() < 0.3, "{x:?}");
        assert!(content.contains(">A10<"));
    }

    #[test]
    fn series_are_named_and_nothing_is_no_chart() {
        let both = [
            series("seed <1", &[("1", 1.0), ("2", 2.0)]),
            series("b", &[("1", 3.0)]),
        ];
        let plot = sweep("x", "y", &values(&["1", "2"]), &both).unwrap();
        assert!(plot.content.contains("seed &lt;1") && plot.caption.contains("seed <1; b"));
        for none in [
            &[][..],
            &[series("", &[("1", 1.0)])],
            &[series("", &[("1", f64::NAN), ("2", 1.0)])],
        ] {
            assert!(sweep("x", "y", &values(&["1", "2"]), none).is_none());
        }
    }
}
