//! Sizes of bodies as text: shares, sieve curves and distributions.

use femdem_pack::{Grading, Measure, SizeClass, Sizes};
use femdem_view::output::{counted, short_number};

use super::{Scene, metres, words};
use crate::Error;
use crate::error::wrong;
use crate::results::percent;

/// What is written where sizes are expected.
const FORMS: &str = "give sizes with their shares of the mass, such as 20mm:0.3,30mm:0.7; a sieve curve, such as \
                     sieve:10mm:0,20mm:0.4,30mm:1; or lognormal-mass:MEDIAN:SIGMA, lognormal-number:MEDIAN:SIGMA or \
                     weibull-mass:SIZE:EXPONENT, if you like with limits, such as lognormal-mass:20mm:0.3:10mm..40mm";

/// Error of the sieve curve at a point or a twentieth of it, as part of the mass, from which a note warns.
const FAR: f64 = 0.02;

/// Reads the sizes of a shape.
pub(super) fn parse(text: &str) -> Result<Sizes, Error> {
    let wrong = || Error::Option {
        name: "sizes",
        value: text.chars().take(80).collect(),
        allowed: FORMS,
    };
    let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
    match kind.trim() {
        "sieve" => Ok(Sizes::Sieve(pairs(rest, None).ok_or_else(wrong)?)),
        "lognormal-mass" | "lognormal-number" => {
            let (median, sigma, limits) = parameters(rest).ok_or_else(wrong)?;
            Ok(Sizes::LogNormal {
                measure: match kind.trim() {
                    "lognormal-mass" => Measure::Mass,
                    _ => Measure::Number,
                },
                median,
                sigma,
                limits,
            })
        }
        "weibull-mass" => {
            let (size, exponent, limits) = parameters(rest).ok_or_else(wrong)?;
            Ok(Sizes::Weibull {
                size,
                exponent,
                limits,
            })
        }
        _ => Ok(Sizes::Shares(pairs(text, Some(1.0)).ok_or_else(wrong)?)),
    }
}

/// Sizes, each with a number, or with the usual one if it may be left out.
fn pairs(text: &str, usual: Option<f64>) -> Option<Vec<[f64; 2]>> {
    let pair = |text: &str| {
        let (size, number) = match text.split_once(':') {
            Some((size, number)) => (size, number.trim().parse().ok()?),
            None => (text, usual?),
        };
        Some([metres(size).ok()?, number])
    };
    text.split(',').map(pair).collect()
}

/// A size, a number, and limits of the size, as in 20mm:0.3:10mm..40mm.
fn parameters(text: &str) -> Option<(f64, f64, Option<[f64; 2]>)> {
    let mut parts = text.split(':');
    let size = metres(parts.next()?).ok()?;
    let number = parts.next()?.trim().parse().ok()?;
    let limits = parts.next().map(|limits| {
        let (least, largest) = limits.split_once("..")?;
        Some([metres(least).ok()?, metres(largest).ok()?])
    });
    let limits = match limits {
        Some(limits) => Some(limits?),
        None => None,
    };
    parts.next().is_none().then_some((size, number, limits))
}

/// The grading that `sizes` or `sieve` of an entry gives, if one of them does.
pub(crate) fn grading(sizes: Option<&str>, sieve: Option<&str>) -> Result<Option<Grading>, Error> {
    let text = match (sizes, sieve) {
        (None, None) => return Ok(None),
        (Some(sizes), None) => sizes.to_owned(),
        (None, Some(curve)) => format!("sieve:{curve}"),
        (Some(_), Some(_)) => {
            let allowed = "only one of the two";
            return Err(wrong("sizes and sieve", "both", allowed));
        }
    };
    let grading = parse(&text)?.grading();
    grading.map(Some).map_err(words::in_words_of_scenes)
}

impl Scene {
    /// The gradings of the shapes, one each; none if the scene gives no sizes.
    pub(super) fn gradings(&self) -> Result<Vec<Grading>, Error> {
        let both = !self.sizes.is_empty() && !self.sieve.is_empty();
        let measures = [self.diameter, self.size, self.mass];
        let given = !self.sizes.is_empty() || !self.sieve.is_empty();
        if both || (given && measures.iter().any(Option::is_some)) {
            return Err(Error::Option {
                name: "sizes, sieve, diameter, size and mass",
                value: "several".to_owned(),
                allowed: "only one of the five; a curve beside other sizes is sizes = \"sieve:10mm:0,20mm:1\"",
            });
        }
        let curves = self.sieve.iter().map(|curve| format!("sieve:{curve}"));
        let texts: Vec<String> = self.sizes.iter().cloned().chain(curves).collect();
        let gradings = texts.iter().map(|text| {
            let grading = parse(text)?.grading();
            grading.map_err(words::in_words_of_scenes)
        });
        let mut gradings = gradings.collect::<Result<Vec<_>, _>>()?;
        if gradings.len() == 1 {
            gradings = vec![gradings[0].clone(); self.shape.len()];
        }
        if given && gradings.len() != self.shape.len() {
            return Err(Error::Option {
                name: "sizes",
                value: format!("{} entries", gradings.len()),
                allowed: "one for all shapes, or one for each shape, in the order of the shapes",
            });
        }
        Ok(gradings)
    }
}

/// What came of the sizes of a shape and its variants, in a sentence; there is at least one body.
pub(super) fn note(grading: &Grading, bodies: &[SizeClass], variants: u32) -> String {
    let ends = [bodies[0], bodies[bodies.len() - 1]];
    let [least, largest] = ends.map(|class| short_number(1e3 * class.diameter));
    let count: u32 = bodies.iter().map(|class| class.count).sum();
    let error = grading.deviation(bodies);
    let dealt = match variants {
        1 => String::new(),
        _ => format!(" and {variants} variants"),
    };
    let mut text = format!(
        "{} of {least} to {largest} mm in {}{dealt}, sieve curve met to {} of the mass",
        counted(count as usize, "body", "bodies"),
        counted(bodies.len(), "size", "sizes"),
        percent(error),
    );
    let [below, above] = grading.cut();
    if below + above > 0.0 {
        text += &format!(
            "; of the distribution {} below and {} above are cut off",
            percent(below),
            percent(above)
        );
    }
    if error > FAR {
        text += "\n  warning: so few bodies cannot follow the curve: give more, or a larger smallest size";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes said are those of the bodies: the mean of a stratum lies within the limits of the curve.
    #[test]
    fn a_note_has_the_sizes_of_the_bodies() {
        let grading = parse("sieve:10mm:0,20mm:1").unwrap().grading().unwrap();
        let one = grading.bodies(1);
        let said = note(&grading, &one, 1);
        let size = short_number(1e3 * one[0].diameter);
        assert!(
            said.starts_with(&format!("1 body of {size} to {size} mm in 1 size, ")),
            "{said}"
        );
        assert!(said.contains("warning: so few bodies"), "{said}");
    }

    #[test]
    fn sizes_are_shares_curves_or_distributions() {
        assert_eq!(
            parse("20mm:0.3, 0.03:0.7").unwrap(),
            Sizes::Shares(vec![[0.02, 0.3], [0.03, 0.7]])
        );
        assert_eq!(parse("2cm").unwrap(), Sizes::Shares(vec![[0.02, 1.0]]));
        assert_eq!(
            parse("sieve:10mm:0,20mm:0.4,30mm:1").unwrap(),
            Sizes::Sieve(vec![[0.01, 0.0], [0.02, 0.4], [0.03, 1.0]])
        );
        assert_eq!(
            parse("lognormal-number:20mm:0.3:10mm..4cm").unwrap(),
            Sizes::LogNormal {
                measure: Measure::Number,
                median: 0.02,
                sigma: 0.3,
                limits: Some([0.01, 0.04]),
            }
        );
        assert_eq!(
            parse("weibull-mass:30mm:2.5").unwrap(),
            Sizes::Weibull {
                size: 0.03,
                exponent: 2.5,
                limits: None,
            }
        );
        for bad in [
            "",
            "lognormal:20mm:0.3",
            "20mm:x",
            "sieve:10mm,20mm:1",
            "weibull-mass:30mm",
            "weibull-mass:30mm:2:10mm",
            "weibull-mass:30mm:2:10mm..40mm:3",
        ] {
            let message = parse(bad).unwrap_err().to_string();
            assert!(
                message.contains("lognormal-mass:MEDIAN:SIGMA"),
                "{bad}: {message}"
            );
        }
    }
}
