//! Plots of the packing density against position.

use femdem_analysis::{DensityProfile, ProfileBin, RadialBin};

use super::axis::Axis;
use super::chart::{Chart, Hue};
use super::svg::Plot;
use crate::output::short_number;
use crate::tables::Tables;

/// Density over height, with the heights upward.
pub(super) fn height(tables: &Tables) -> Option<Plot> {
    let bins = filled(tables.height_profile.as_ref()?);
    let (first, last) = (bins.first()?, bins.last()?);
    let x = density_axis(bins);
    let y = Axis::linear("height / m", first.low, last.high);
    let mut chart = Chart::new(x, y);
    let [low, high] = [-1.0, 1.0].map(|sign| points(bins, |bin| [shifted(bin, sign), middle(bin)]));
    chart.band(Hue::First, &low, &high);
    chart.line(Hue::First, &points(bins, |bin| [bin.density, middle(bin)]));
    let mut core_words = String::new();
    if let (Some(core), Some(density)) = (&tables.core, &tables.density) {
        let (low, high) = core.region.corners();
        core_words = if core.is_thin() {
            format!(
                " The core would be thinner than one body; the whole bed has {:.4}.",
                density.exact
            )
        } else {
            chart.level(low.z);
            chart.level(high.z);
            format!(
                " The core, {:.4}, lies between the dashed lines.",
                density.exact
            )
        };
    }
    let caption = format!(
        "Solid volume over volume of horizontal slabs of the container, by exact clipping; the band is the \
         standard error by block bootstrap. Layers on the floor show as waves.{core_words}"
    );
    Some(Plot::of(
        "height",
        "Packing density over height",
        caption,
        chart,
    ))
}

/// Density over the distance from the side walls.
pub(super) fn wall(tables: &Tables) -> Option<Plot> {
    let profile = tables.wall_profile.as_ref()?;
    let bins = profile.bins.as_slice();
    let last = bins.last()?;
    let d = tables.diameter;
    let x = Axis::linear("distance from the wall / d", 0.0, last.high / d);
    let mut chart = Chart::new(x, density_axis(bins));
    let [low, high] =
        [-1.0, 1.0].map(|sign| points(bins, |bin| [middle(bin) / d, shifted(bin, sign)]));
    chart.band(Hue::First, &low, &high);
    chart.line(
        Hue::First,
        &points(bins, |bin| [middle(bin) / d, bin.density]),
    );
    if let Some(density) = &tables.density {
        chart.level(density.exact);
    }
    let space = tables.density_space();
    let caption = format!(
        "Solid volume over volume of shells at equal distance from the nearest side wall, over the heights of the \
         {space}; the band is the standard error by block bootstrap. Walls order the bodies beside them: waves of \
         about one diameter, dying out inward. Dashed: the {space}. d is {} mm.",
        short_number(1e3 * d)
    );
    Some(Plot::of(
        "wall",
        "Packing density and walls",
        caption,
        chart,
    ))
}

/// The radial distribution function of the bodies' centres.
pub(super) fn radial(tables: &Tables) -> Option<Plot> {
    let found = tables.radial_distribution.as_ref()?;
    let bins: Vec<_> = found.bins.iter().filter(|bin| !bin.is_rare()).collect();
    let d = tables.diameter;
    let ends = |sign: f64| -> Vec<[f64; 2]> {
        let shifted = |bin: &&RadialBin| bin.value + sign * bin.standard_error.unwrap_or(0.0);
        let point = |bin: &&RadialBin| [0.5 * (bin.low + bin.high) / d, shifted(bin).max(0.0)];
        bins.iter().map(point).collect()
    };
    let [low, middle, high] = [-1.0, 0.0, 1.0].map(ends);
    let x = Axis::linear("distance of centres / d", 0.0, bins.last()?.high / d);
    let y = Axis::from_zero("g(r)", high.iter().map(|p| p[1]).chain([1.2]));
    let mut chart = Chart::new(x, y);
    chart.band(Hue::First, &low, &high);
    chart.line(Hue::First, &middle);
    chart.level(1.0);
    let caption = format!(
        "Pairs of centres at a distance over those of points strewn at random in the same box (dashed: 1), for \
         the {} bodies of the {}, with exact volumes of the shells; the band is the standard error. The first \
         peak is the shell of touching neighbours; its waves die out where the order ends. Distances at which \
         fewer than 5 pairs are expected are left out.",
        found.bodies,
        tables.density_space(),
    );
    Some(Plot::of(
        "radial",
        "Radial distribution function",
        caption,
        chart,
    ))
}

/// Without the empty bins above the pack.
fn filled(profile: &DensityProfile) -> &[ProfileBin] {
    let last = profile.bins.iter().rposition(|bin| bin.solid > 0.0);
    profile
        .bins
        .get(..last.map_or(0, |last| last + 1))
        .unwrap_or_default()
}

fn density_axis(bins: &[ProfileBin]) -> Axis {
    let most = bins
        .iter()
        .map(|bin| shifted(bin, 1.0))
        .filter(|x| x.is_finite());
    Axis::linear(
        "packing density",
        0.0,
        most.fold(0.2, f64::max).min(1.0) * 1.05,
    )
}

fn middle(bin: &ProfileBin) -> f64 {
    0.5 * (bin.low + bin.high)
}

/// The density shifted by its standard error, limited to the range of a density.
fn shifted(bin: &ProfileBin, sign: f64) -> f64 {
    (bin.density + sign * bin.standard_error.unwrap_or(0.0)).clamp(0.0, 1.0)
}

fn points(bins: &[ProfileBin], of: impl Fn(&ProfileBin) -> [f64; 2]) -> Vec<[f64; 2]> {
    bins.iter().map(of).collect()
}
