//! Sizes of the bodies of a shape: shares of the mass, sieve curves and distributions, and the bodies that have them.

use crate::error::{PackError, check, check_positive};

/// Mass share and ratio of diameters over which neighbouring bodies keep sizes of their own; below both they have one.
const CLASS_MASS: f64 = 0.005;
const CLASS_RATIO: f64 = 1.05;

/// Pieces of the curve of a formula, each straight over the logarithm of the size.
const PIECES: u32 = 2000;

/// Largest over smallest size: beyond it the small bodies are dust, and their number explodes.
const WIDEST: f64 = 1000.0;

/// Most sizes with shares, or points of a sieve curve.
const MOST: usize = 100;

/// Mass at either end that a distribution without limits loses.
const TAIL: f64 = 0.01;

/// Standard normal deviate below which all but the tail of 1 % lies.
const TAIL_DEVIATE: f64 = 2.326_347_874_040_840_8;

/// What a share or a distribution counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// The mass of the bodies.
    Mass,
    /// Their number.
    Number,
}

/// The sizes of the bodies of one shape. A size is the circumscribed diameter d of a body, m: of a body that is no ball this
/// is not the opening of the square mesh that it falls through, which is closer to its middle width. All bodies of a shape
/// have one form and one density, so that their mass goes with d³.
///
/// ```
/// use femdem_pack::Sizes;
///
/// // A sieve curve: 40 % of the mass is finer than 20 mm.
/// let wanted = Sizes::Sieve(vec![[0.01, 0.0], [0.02, 0.4], [0.03, 1.0]]).grading()?;
/// let bodies = wanted.bodies(1000);
/// assert_eq!(bodies.iter().map(|class| class.count).sum::<u32>(), 1000);
/// assert!(wanted.deviation(&bodies) < 0.01);
/// # Ok::<(), femdem_pack::PackError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Sizes {
    /// Sizes (m), rising, each with its share of the mass; shares are relative to each other.
    Shares(Vec<[f64; 2]>),
    /// A sieve curve: rising sizes (m), each with the part of the mass that is finer, from 0 to 1. Between the points the
    /// passing is linear over the logarithm of the size, as grading curves are drawn and read (ISO 17892-4, semi-logarithmic).
    Sieve(Vec<[f64; 2]>),
    /// The logarithm of the size is normally distributed.
    LogNormal {
        /// What the distribution counts. One by number with the median m is one by mass with the median
        /// m exp(3 sigma²) (Hatch and Choate 1929).
        measure: Measure,
        /// Median, m.
        median: f64,
        /// Standard deviation of the natural logarithm.
        sigma: f64,
        /// Smallest and largest size, m; `None`: those which 1 % and 99 % of the mass pass.
        limits: Option<[f64; 2]>,
    },
    /// By mass, passing = 1 - exp(-(d/size)^exponent): the distribution of Weibull, of Rosin and Rammler (1933) for
    /// ground material.
    Weibull {
        /// Size that 63.2 % of the mass passes, m.
        size: f64,
        /// Exponent; the larger, the narrower.
        exponent: f64,
        /// As of [`Sizes::LogNormal`].
        limits: Option<[f64; 2]>,
    },
}

/// Bodies of one size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SizeClass {
    /// Circumscribed diameter, m.
    pub diameter: f64,
    /// Number of bodies.
    pub count: u32,
}

/// A sieve curve by mass that bodies can be drawn from: that of [`Sizes`], with the tails of a distribution cut off and the
/// rest scaled to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Grading {
    form: Form,
    /// Sizes, m, with the wanted passing there: where bodies are compared with the curve.
    points: Vec<[f64; 2]>,
    cut: [f64; 2],
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    /// Sizes, m, and shares of the mass.
    Steps(Vec<[f64; 2]>),
    Curve(Vec<Node>),
}

/// A point of a curve whose passing is linear over the logarithm of the size up to the next point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    /// ln(d/largest).
    log: f64,
    /// Part of the mass that is finer.
    passing: f64,
    /// Number of finer bodies, in bodies of the largest size that have the mass of all.
    finer: f64,
    /// d, m.
    size: f64,
}

impl Sizes {
    /// The sieve curve.
    ///
    /// # Errors
    /// [`PackError::Parameter`] for sizes, shares or parameters out of range, or that do not rise.
    pub fn grading(&self) -> Result<Grading, PackError> {
        match self {
            Self::Shares(list) => steps(list),
            Self::Sieve(list) => {
                check_sieve(list)?;
                let nodes = curve(list);
                Ok(Grading {
                    points: list.iter().copied().chain(twentieths(&nodes)).collect(),
                    form: Form::Curve(nodes),
                    cut: [0.0; 2],
                })
            }
            Self::LogNormal {
                measure,
                median,
                sigma,
                limits,
            } => {
                check_positive("median of the sizes", *median)?;
                check(
                    "sigma of the sizes",
                    *sigma,
                    *sigma > 0.0 && *sigma <= 2.0,
                    "above 0 and at most 2",
                )?;
                let shift = match measure {
                    Measure::Mass => 0.0,
                    Measure::Number => 3.0 * sigma * sigma,
                };
                let size = |deviate: f64| median * (shift + sigma * deviate).exp();
                let passing = |d: f64| normal_below(((d / median).ln() - shift) / sigma);
                truncated(
                    limits.unwrap_or([size(-TAIL_DEVIATE), size(TAIL_DEVIATE)]),
                    [size(-8.0), size(8.0)],
                    passing,
                )
            }
            Self::Weibull {
                size,
                exponent,
                limits,
            } => {
                check_positive("size of the Weibull distribution", *size)?;
                check(
                    "exponent of the Weibull distribution",
                    *exponent,
                    (0.5..=100.0).contains(exponent),
                    "from 0.5 to 100",
                )?;
                let at = |depth: f64| size * depth.powf(1.0 / exponent);
                let passing = |d: f64| -(-(d / size).powf(*exponent)).exp_m1();
                truncated(
                    limits.unwrap_or([at(-(1.0 - TAIL).ln()), at(-TAIL.ln())]),
                    [at(1e-14), at(40.0)],
                    passing,
                )
            }
        }
    }
}

impl Grading {
    /// Smallest and largest size, m.
    pub fn range(&self) -> [f64; 2] {
        match &self.form {
            Form::Steps(steps) => [steps[0][0], steps[steps.len() - 1][0]],
            Form::Curve(nodes) => [nodes[0].size, nodes[nodes.len() - 1].size],
        }
    }

    /// Parts of the mass of the distribution that lie below and above its limits, and are cut off.
    pub fn cut(&self) -> [f64; 2] {
        self.cut
    }

    /// So many bodies, by rising size.
    ///
    /// They are the strata of the distribution by number: body k of n stands for the part k/n to (k+1)/n and has the mean mass of
    /// it. Thus the mass up to the end of each part is exact, and the curve is missed nowhere by more than the mass of
    /// one body. Neighbours that together have less than 0.5 % of the mass, and sizes within 5 %, have one size. Of sizes
    /// with shares the numbers are the whole ones that come closest to the curve.
    pub fn bodies(&self, count: u32) -> Vec<SizeClass> {
        match &self.form {
            _ if count == 0 => Vec::new(),
            Form::Steps(steps) => self.apportioned(steps, count),
            Form::Curve(nodes) => strata(nodes, count),
        }
    }

    /// Sizes, m, by rising size, and their shares of the mass; of a curve those of so many [`bodies`](Self::bodies).
    pub fn mass_shares(&self, count: u32) -> Vec<[f64; 2]> {
        match &self.form {
            Form::Steps(steps) => steps.clone(),
            Form::Curve(nodes) => {
                let bodies = strata(nodes, count.max(1));
                let of = |class: &SizeClass| f64::from(class.count) * class.diameter.powi(3);
                let total: f64 = bodies.iter().map(of).sum();
                let share = |class: &SizeClass| [class.diameter, of(class) / total];
                bodies.iter().map(share).collect()
            }
        }
    }

    /// Largest error of the passing of bodies at the points of the curve: each size with a share, those of a sieve curve, and
    /// every twentieth of the mass of a sieve curve or of a formula. Bodies come by rising size.
    pub fn deviation(&self, bodies: &[SizeClass]) -> f64 {
        let of = |class: &SizeClass| f64::from(class.count) * class.diameter.powi(3);
        let total: f64 = bodies.iter().map(of).sum();
        let error = |[size, wanted]: &[f64; 2]| {
            let finer = bodies.iter().filter(|class| class.diameter <= *size);
            (finer.map(of).sum::<f64>() / total - wanted).abs()
        };
        self.points.iter().map(error).fold(0.0, f64::max)
    }

    /// Whole numbers of bodies of given sizes: rounded along the curve, then improved one body at a time.
    fn apportioned(&self, steps: &[[f64; 2]], count: u32) -> Vec<SizeClass> {
        let weights: Vec<f64> = steps.iter().map(|[d, share]| share / d.powi(3)).collect();
        let total: f64 = weights.iter().sum();
        let (mut sum, mut placed) = (0.0, 0);
        let mut bodies: Vec<SizeClass> = Vec::with_capacity(steps.len());
        for ([diameter, _], weight) in steps.iter().zip(weights) {
            sum += weight;
            let end = (sum / total * f64::from(count)).round() as u32;
            let end = end.clamp(placed, count);
            bodies.push(SizeClass {
                diameter: *diameter,
                count: end - placed,
            });
            placed = end;
        }
        let mut error = self.deviation(&bodies);
        loop {
            let mut best = None;
            for from in 0..bodies.len() {
                for to in 0..bodies.len() {
                    if from == to || bodies[from].count == 0 {
                        continue;
                    }
                    let mut other = bodies.clone();
                    other[from].count -= 1;
                    other[to].count += 1;
                    let its = self.deviation(&other);
                    if its < error * (1.0 - 1e-9) {
                        (error, best) = (its, Some(other));
                    }
                }
            }
            match best {
                Some(better) => bodies = better,
                None => break,
            }
        }
        bodies.retain(|class| class.count > 0);
        bodies
    }
}

fn steps(list: &[[f64; 2]]) -> Result<Grading, PackError> {
    check_list(list)?;
    for [_, share] in list {
        check_positive("share of a size", *share)?;
    }
    let total: f64 = list.iter().map(|[_, share]| share).sum();
    let steps: Vec<_> = list.iter().map(|[d, share]| [*d, share / total]).collect();
    let mut sum = 0.0;
    let points = steps.iter().map(|[d, share]| {
        sum += share;
        [*d, sum]
    });
    Ok(Grading {
        points: points.collect(),
        form: Form::Steps(steps),
        cut: [0.0; 2],
    })
}

fn check_sieve(list: &[[f64; 2]]) -> Result<(), PackError> {
    check_list(list)?;
    let [first, last] = [list[0][1], list[list.len() - 1][1]];
    check(
        "passing of the first sieve",
        first,
        first == 0.0,
        "0: nothing is finer than it",
    )?;
    check(
        "passing of the last sieve",
        last,
        last == 1.0,
        "1: everything is finer than it",
    )?;
    for pair in list.windows(2) {
        check(
            "passing of a sieve",
            pair[1][1],
            pair[1][1] >= pair[0][1],
            "at least that of the sieve below",
        )?;
    }
    Ok(())
}

/// Sizes above 0 that rise, and not too far.
fn check_list(list: &[[f64; 2]]) -> Result<(), PackError> {
    check(
        "number of sizes",
        list.len() as f64,
        (1..=MOST).contains(&list.len()),
        "from 1 to 100",
    )?;
    for [size, _] in list {
        check_positive("size", *size)?;
    }
    for pair in list.windows(2) {
        check(
            "size",
            pair[1][0],
            pair[1][0] > pair[0][0],
            "above the one before: order them from small to large",
        )?;
    }
    check_width(list[0][0], list[list.len() - 1][0])
}

fn check_width(least: f64, largest: f64) -> Result<(), PackError> {
    check(
        "largest over smallest size",
        largest / least,
        largest / least <= WIDEST,
        "at most 1000: the number of bodies of the small sizes grows with its cube",
    )
}

/// The curve of a formula between limits; beyond `whole` it has no mass worth counting.
fn truncated(
    limits: [f64; 2],
    whole: [f64; 2],
    passing: impl Fn(f64) -> f64,
) -> Result<Grading, PackError> {
    let [least, largest] = limits;
    check_positive("smallest size", least)?;
    check(
        "largest size",
        largest,
        largest > least,
        "above the smallest size",
    )?;
    let [low, high] = [least.max(whole[0]), largest.min(whole[1])];
    let [below, within] = [passing(low), passing(high) - passing(low)];
    check(
        "part of the mass between the limits of the sizes",
        within,
        within >= TAIL,
        "at least 0.01: move the limits to where the distribution has its mass",
    )?;
    check_width(low, high)?;
    let point = |k: u32| {
        let size = low * (high / low).powf(f64::from(k) / f64::from(PIECES));
        [size, (passing(size) - below) / within]
    };
    let mut list: Vec<[f64; 2]> = (0..=PIECES).map(point).collect();
    list[0] = [low, 0.0];
    list[PIECES as usize] = [high, 1.0];
    let nodes = curve(&list);
    Ok(Grading {
        points: twentieths(&nodes).collect(),
        cut: [below, 1.0 - below - within],
        form: Form::Curve(nodes),
    })
}

/// Sizes, m, that every twentieth of the mass passes, and these parts.
fn twentieths(nodes: &[Node]) -> impl Iterator<Item = [f64; 2]> {
    (1..20).map(|k| {
        let wanted = f64::from(k) / 20.0;
        let end = nodes.partition_point(|node| node.passing < wanted);
        let [a, b] = [nodes[end - 1], nodes[end]];
        let part = (wanted - a.passing) / (b.passing - a.passing);
        [a.size * (b.size / a.size).powf(part), wanted]
    })
}

/// The nodes of a curve through points.
fn curve(list: &[[f64; 2]]) -> Vec<Node> {
    let largest = list[list.len() - 1][0];
    let mut nodes: Vec<Node> = Vec::with_capacity(list.len());
    for &[size, passing] in list {
        let log = (size / largest).ln();
        // Of a straight piece over x = ln d the number is the integral of exp(-3 x) times its slope.
        let finer = nodes.last().map_or(0.0, |before| {
            let slope = (passing - before.passing) / (log - before.log);
            before.finer + slope / 3.0 * ((-3.0 * before.log).exp() - (-3.0 * log).exp())
        });
        nodes.push(Node {
            log,
            passing,
            finer,
            size,
        });
    }
    nodes
}

/// Where so many bodies are finer: size, m, and passing.
fn where_finer(nodes: &[Node], finer: f64) -> [f64; 2] {
    let end = nodes.partition_point(|node| node.finer < finer);
    let end = end.clamp(1, nodes.len() - 1);
    let [a, b] = [nodes[end - 1], nodes[end]];
    if finer >= b.finer {
        return [b.size, b.passing];
    }
    let slope = (b.passing - a.passing) / (b.log - a.log);
    let log = ((-3.0 * a.log).exp() - 3.0 * (finer - a.finer) / slope).ln() / -3.0;
    let log = log.clamp(a.log, b.log);
    [
        a.size * (log - a.log).exp(),
        a.passing + slope * (log - a.log),
    ]
}

/// The bodies of a curve, one for each equal part of the number.
fn strata(nodes: &[Node], count: u32) -> Vec<SizeClass> {
    let last = nodes[nodes.len() - 1];
    let each = last.finer / f64::from(count);
    let mut classes: Vec<SizeClass> = Vec::new();
    let mut below = [nodes[0].size, 0.0];
    // The class so far: its bodies, their mass, where it began.
    let (mut held, mut mass, mut least) = (0, 0.0, below[0]);
    let size_of = |held: u32, mass: f64| last.size * (mass / (f64::from(held) * each)).cbrt();
    for k in 1..=count {
        let above = where_finer(nodes, f64::from(k) * each);
        let its = above[1] - below[1];
        if held > 0 && (mass + its > CLASS_MASS || above[0] > CLASS_RATIO * least) {
            classes.push(SizeClass {
                diameter: size_of(held, mass).clamp(least, below[0]),
                count: held,
            });
            (held, mass, least) = (0, 0.0, below[0]);
        }
        held += 1;
        mass += its;
        below = above;
    }
    classes.push(SizeClass {
        diameter: size_of(held, mass).clamp(least, below[0]),
        count: held,
    });
    classes
}

/// Part of a standard normal distribution below a deviate of at most 8 in size, by Simpson's rule.
fn normal_below(deviate: f64) -> f64 {
    const INTERVALS: u32 = 200;
    let density = |t: f64| (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
    let end = deviate.clamp(-9.0, 9.0);
    let step = end / f64::from(INTERVALS);
    let inner = (1..INTERVALS).map(|k| {
        let weight = if k % 2 == 1 { 4.0 } else { 2.0 };
        weight * density(f64::from(k) * step)
    });
    0.5 + step / 3.0 * (density(0.0) + inner.sum::<f64>() + density(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Passing of bodies at a size, by mass.
    fn passing(bodies: &[SizeClass], size: f64) -> f64 {
        let of = |c: &SizeClass| f64::from(c.count) * c.diameter.powi(3);
        let finer: f64 = bodies.iter().filter(|c| c.diameter <= size).map(of).sum();
        finer / bodies.iter().map(of).sum::<f64>()
    }

    fn bodies(sizes: &Sizes, count: u32) -> Vec<SizeClass> {
        let bodies = sizes.grading().unwrap().bodies(count);
        assert_eq!(bodies.iter().map(|c| c.count).sum::<u32>(), count);
        assert!(bodies.windows(2).all(|w| w[0].diameter < w[1].diameter));
        bodies
    }

    #[test]
    fn a_sieve_curve_comes_out_as_it_went_in() {
        let curves = [
            vec![[0.01, 0.0], [0.02, 0.4], [0.03, 1.0]],
            vec![
                [0.01, 0.0],
                [0.012, 0.1],
                [0.016, 0.3],
                [0.02, 0.65],
                [0.025, 1.0],
            ],
            // A gap between two fractions.
            vec![[0.01, 0.0], [0.012, 0.5], [0.018, 0.5], [0.02, 1.0]],
        ];
        for curve in curves {
            for (count, error) in [(200, 0.01), (1000, 0.006), (20_000, 0.005)] {
                let made = bodies(&Sizes::Sieve(curve.clone()), count);
                for [size, wanted] in &curve {
                    let got = passing(&made, *size);
                    assert!(
                        (got - wanted).abs() <= error,
                        "{count} {size}: {got}, not {wanted}"
                    );
                }
                assert!(made.len() < 320, "{}", made.len());
            }
        }
    }

    /// Between the points of a sieve curve the passing is linear over the logarithm: at the geometric mean it is the mean.
    #[test]
    fn sieve_curves_are_straight_over_the_logarithm() {
        let made = bodies(&Sizes::Sieve(vec![[0.01, 0.0], [0.04, 1.0]]), 100_000);
        assert!((passing(&made, 0.02) - 0.5).abs() < 0.005);
    }

    #[test]
    fn shares_of_sizes_are_shares_of_mass() {
        let made = bodies(&Sizes::Shares(vec![[0.02, 0.3], [0.03, 0.7]]), 200);
        // 0.3/8 to 0.7/27 by number.
        assert_eq!(made[0].count, 118);
        assert!((passing(&made, 0.02) - 0.3).abs() < 0.005);
        // One large body has the mass of 125 small ones: no whole number is exact, and two are best.
        let made = bodies(&Sizes::Shares(vec![[0.01, 1.0], [0.05, 1.0]]), 200);
        assert_eq!(made[1].count, 2);
        assert_eq!(bodies(&Sizes::Shares(vec![[0.02, 5.0]]), 7).len(), 1);
    }

    /// Mean and standard deviation of ln d by mass are those of the distribution, and by number those that Hatch and Choate
    /// give; cut at 4 standard deviations.
    #[test]
    fn log_normal_sizes_have_their_moments_by_mass_and_by_number() {
        let (median, sigma) = (0.02_f64, 0.25_f64);
        for measure in [Measure::Mass, Measure::Number] {
            let middle = match measure {
                Measure::Mass => median,
                Measure::Number => median * (3.0 * sigma * sigma).exp(),
            };
            let limits = Some([-4.0_f64, 4.0].map(|t| middle * (sigma * t).exp()));
            let sizes = Sizes::LogNormal {
                measure,
                median,
                sigma,
                limits,
            };
            let made = bodies(&sizes, 100_000);
            let power = if measure == Measure::Mass { 3 } else { 0 };
            let weight = |c: &SizeClass| f64::from(c.count) * c.diameter.powi(power);
            let total: f64 = made.iter().map(weight).sum();
            let mean = |of: &dyn Fn(f64) -> f64| {
                made.iter()
                    .map(|c| weight(c) * of((c.diameter / median).ln()))
                    .sum::<f64>()
                    / total
            };
            let centre = mean(&|x| x);
            let spread = mean(&|x| (x - centre).powi(2)).sqrt();
            assert!(centre.abs() < 0.01, "{measure:?} {centre}");
            assert!((spread / sigma - 1.0).abs() < 0.02, "{measure:?} {spread}");
        }
    }

    #[test]
    fn a_weibull_distribution_passes_what_rosin_and_rammler_say() {
        let sizes = Sizes::Weibull {
            size: 0.03,
            exponent: 3.0,
            limits: None,
        };
        let grading = sizes.grading().unwrap();
        for part in grading.cut() {
            assert!((part - 0.01).abs() < 1e-12);
        }
        let made = bodies(&sizes, 20_000);
        for (ratio, whole) in [(0.5_f64, 0.117_503), (1.0, 0.632_121), (1.4, 0.935_679)] {
            // Of what is left between the limits.
            let wanted = (whole - 0.01) / 0.98;
            let got = passing(&made, 0.03 * ratio);
            assert!((got - wanted).abs() < 0.005, "{ratio}: {got}, not {wanted}");
        }
        assert!(grading.deviation(&made) < 0.005);
    }

    /// Few bodies cannot follow a wide curve, and the deviation says so, also of a curve without points on the way.
    #[test]
    fn too_few_bodies_are_told_by_the_deviation() {
        for points in [
            vec![[0.001, 0.0], [0.03, 0.5], [0.1, 1.0]],
            vec![[0.001, 0.0], [0.1, 1.0]],
        ] {
            let wide = Sizes::Sieve(points).grading().unwrap();
            assert!(wide.deviation(&wide.bodies(100)) > 0.2);
        }
    }

    #[test]
    fn sizes_out_of_range_are_named() {
        let says = |sizes: Sizes| sizes.grading().unwrap_err().to_string();
        assert!(says(Sizes::Shares(vec![])).contains("number of sizes = 0"));
        assert!(says(Sizes::Shares(vec![[0.02, -1.0]])).contains("share of a size = -1"));
        assert!(says(Sizes::Shares(vec![[0.02, 1.0], [0.02, 1.0]])).contains("order them"));
        assert!(says(Sizes::Sieve(vec![[0.01, 0.1], [0.02, 1.0]])).contains("first sieve = 0.1"));
        assert!(says(Sizes::Sieve(vec![[0.01, 0.0], [0.02, 0.9]])).contains("last sieve = 0.9"));
        let falling = vec![[0.01, 0.0], [0.02, 0.5], [0.03, 0.4], [0.04, 1.0]];
        assert!(says(Sizes::Sieve(falling)).contains("passing of a sieve = 0.4"));
        assert!(says(Sizes::Sieve(vec![[1e-5, 0.0], [0.02, 1.0]])).contains("at most 1000"));
        let normal = |sigma, limits| Sizes::LogNormal {
            measure: Measure::Mass,
            median: 0.02,
            sigma,
            limits,
        };
        assert!(says(normal(0.0, None)).contains("sigma of the sizes = 0"));
        assert!(says(normal(0.3, Some([0.03, 0.02]))).contains("largest size = 0.02"));
        assert!(says(normal(0.1, Some([0.2, 0.3]))).contains("between the limits"));
        assert!(says(normal(0.3, Some([0.01, f64::INFINITY]))).contains("largest size = inf"));
    }
}
