//! Plots of the distribution of forces.

use femdem_analysis::{ChainNetwork, ForceBin, StressSlab, TailLaw, ThresholdPoint};

use super::axis::Axis;
use super::chart::{Chart, Hue};
use super::svg::Plot;
use crate::output::short_number;
use crate::tables::Tables;

/// P(f) with a logarithmic axis, and the fitted tail.
pub(super) fn distribution(tables: &Tables) -> Option<Plot> {
    let p = tables.force_distribution.as_ref()?;
    let filled = || p.bins.iter().filter(|bin| bin.count > 0);
    let middle = |low: f64, high: f64| 0.5 * (low + high);
    let x = Axis::from_zero(
        "f, normal force over its mean",
        p.bins.iter().map(|bin| bin.high),
    );
    let y = Axis::log("P(f)", filled().map(|bin| bin.density));
    let mut chart = Chart::new(x, y);
    let dot = |bin: &ForceBin| {
        let error = [bin.density - bin.error, bin.density + bin.error];
        ([middle(bin.low, bin.high), bin.density], Some(error))
    };
    chart.dots(Hue::First, &filled().map(dot).collect::<Vec<_>>());
    let mut tail_words = String::new();
    if let Some(tail) = &p.tail {
        let all: u64 = p.bins.iter().map(|bin| bin.count).sum();
        let share = tail.count as f64 / (all.max(1)) as f64;
        let law = |f: f64| match tail.law {
            TailLaw::Exponential => {
                share * tail.exponent * (-tail.exponent * (f - tail.start)).exp()
            }
            TailLaw::Power => {
                share * (tail.exponent - 1.0) / tail.start * (f / tail.start).powf(-tail.exponent)
            }
        };
        let step = (p.largest - tail.start) / 60.0;
        let points = (0..=60).map(|k| tail.start + step * f64::from(k));
        chart.line(
            Hue::Second,
            &points.map(|f| [f, law(f)]).collect::<Vec<_>>(),
        );
        chart.name(Hue::First, "pairs of bodies");
        chart.name(Hue::Second, "fitted tail");
        let form = match tail.law {
            TailLaw::Exponential => "exp(\u{2212}βf) with β",
            TailLaw::Power => "a power of f with exponent",
        };
        tail_words = format!(
            " From f = {:.2} the tail falls as {form} = {:.2} ({:.0} % interval {:.2} to {:.2}).",
            tail.start,
            tail.exponent,
            100.0 * tail.confidence,
            tail.interval[0],
            tail.interval[1]
        );
    }
    let caption = format!(
        "Probability density of the normal force between two bodies over its mean, {} N; bars are \
         counting errors. A straight tail is exponential: few pairs carry several times the mean.{tail_words}",
        short_number(p.mean_force.mean)
    );
    Some(Plot::of(
        "forces",
        "Distribution of contact forces",
        caption,
        chart,
    ))
}

/// Components and cycles of the force network as the threshold rises.
pub(super) fn thresholds(tables: &Tables) -> Option<Plot> {
    let curve = tables.threshold_curve.as_ref()?;
    let points = &curve.points;
    if points.iter().all(|p| p.links == 0) {
        return None;
    }
    let x = Axis::from_zero(
        "threshold over mean normal force",
        points.iter().map(|p| p.threshold),
    );
    let counts = points.iter().flat_map(|p| [p.components, p.largest]);
    let y = Axis::from_zero("number", counts.map(|n| n as f64));
    let mut chart = Chart::new(x, y);
    let line = |of: fn(&ThresholdPoint) -> usize| -> Vec<[f64; 2]> {
        points.iter().map(|p| [p.threshold, of(p) as f64]).collect()
    };
    chart.line(Hue::First, &line(|p| p.components));
    chart.line(Hue::Second, &line(|p| p.largest));
    chart.name(Hue::First, "connected parts");
    chart.name(Hue::Second, "bodies of the largest part");
    let caption = "The network of pairs whose normal force is above the threshold: into how many connected \
                   parts it falls, and how many bodies the largest part has. Where the largest part \
                   collapses, strong forces no longer span the pack."
        .to_owned();
    Some(Plot::of(
        "thresholds",
        "Force network and threshold",
        caption,
        chart,
    ))
}

/// Lengths of the chains by both rules.
pub(super) fn chains(tables: &Tables) -> Option<Plot> {
    let by_weight = tables.chains_by_weight.as_ref();
    let by_stress = tables.chains_by_stress.as_ref();
    let lengths = |network: Option<&ChainNetwork>| -> Vec<f64> {
        let mut counts: Vec<f64> = Vec::new();
        for segment in network.iter().flat_map(|network| &network.segments) {
            if counts.len() <= segment.links {
                counts.resize(segment.links + 1, 0.0);
            }
            if let Some(count) = counts.get_mut(segment.links) {
                *count += 1.0;
            }
        }
        let all: f64 = counts.iter().sum();
        counts.iter().map(|count| count / all.max(1.0)).collect()
    };
    let [weight, stress] = [lengths(by_weight), lengths(by_stress)];
    let longest = weight.len().max(stress.len()).saturating_sub(1);
    if longest == 0 {
        return None;
    }
    let x = Axis::whole("links of an unbranched segment", 1.0, longest.max(4) as f64);
    let y = Axis::from_zero("share of segments", weight.iter().chain(&stress).copied());
    let mut chart = Chart::new(x, y);
    for (hue, shares, [from, to]) in [
        (Hue::First, &weight, [-0.38, -0.02]),
        (Hue::Second, &stress, [0.02, 0.38]),
    ] {
        for (links, share) in shares.iter().enumerate().skip(1) {
            let at = links as f64;
            let words = format!("{links} links: {:.1} %", 100.0 * share);
            chart.bar(hue, [at + from, at + to], *share, &words);
        }
    }
    chart.name(Hue::First, "Xiang et al. 2016");
    chart.name(Hue::Second, "Peters et al. 2005");
    let words = |name: &str, network: Option<&ChainNetwork>| {
        network.map_or(String::new(), |n| {
            format!(
                " {name}: {} chains hold {:.0} % of the bodies and {:.0} % of the force; mean length {:.2} \
                 links, straightness {:.3}, {} loops.",
                n.chains.len(),
                100.0 * n.share_of_bodies,
                100.0 * n.share_of_force,
                n.segment_links.mean,
                n.segment_straightness.mean,
                n.cycles
            )
        })
    };
    let caption = format!(
        "Length of force chains, by the rule of the founding paper (contacts above 1.5 times the mean of the \
         bodies' largest force over weight) and by that of Peters and others (bodies of high stress that \
         touch along it).{}{}",
        words("Xiang", by_weight),
        words("Peters", by_stress)
    );
    Some(Plot::of("chains", "Length of force chains", caption, chart))
}

/// Vertical and horizontal stress over height.
pub(super) fn stress(tables: &Tables) -> Option<Plot> {
    let slabs = &tables.stress_profile.as_ref()?.slabs;
    let middle = |slab: &StressSlab| 0.5 * (slab.z_min + slab.z_max);
    let vertical = |slab: &StressSlab| slab.stress.tensor[2][2].abs();
    let level = |slab: &StressSlab| {
        let t = &slab.stress.tensor;
        0.5 * (t[0][0] + t[1][1]).abs()
    };
    let values = slabs.iter().flat_map(|slab| [vertical(slab), level(slab)]);
    let x = Axis::from_zero("mean normal stress / Pa", values);
    let (low, high) = (slabs.first()?.z_min, slabs.last()?.z_max);
    let mut chart = Chart::new(x, Axis::linear("height / m", low, high));
    let line = |of: &dyn Fn(&StressSlab) -> f64| -> Vec<[f64; 2]> {
        slabs.iter().map(|slab| [of(slab), middle(slab)]).collect()
    };
    chart.line(Hue::First, &line(&vertical));
    chart.line(Hue::Second, &line(&level));
    chart.name(Hue::First, "vertical");
    chart.name(Hue::Second, "horizontal, mean of x and y");
    let caption = "Mean stress of horizontal slabs by the Love-Weber formula, voids included. Where walls carry \
                   weight by friction, the vertical stress grows less than in proportion to depth \
                   (Janssen)."
        .to_owned();
    Some(Plot::of("stress", "Stress over height", caption, chart))
}
