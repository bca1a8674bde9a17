//! Plots of the contacts between bodies.

use femdem_analysis::{Coordination, TiltGroup};

use super::axis::Axis;
use super::chart::{Chart, Hue};
use super::svg::Plot;
use crate::tables::Tables;

/// The histogram of the coordination number: of the core, or of all bodies without one.
pub(super) fn coordination(tables: &Tables) -> Option<Plot> {
    let core = tables.core_coordination.as_ref();
    let core = core.filter(|_| !tables.has_thin_core());
    let (which, shown) = match (core, &tables.coordination) {
        (Some(core), _) => ("the core", core),
        (None, Some(all)) => ("the whole pack", all),
        (None, None) => return None,
    };
    let Coordination {
        mean,
        sd,
        histogram,
        bodies,
        ..
    } = shown;
    let share = |count: u64| count as f64 / (*bodies).max(1) as f64;
    let most = histogram.len().saturating_sub(1) as f64;
    let x = Axis::whole("coordination number", 0.0, most.max(8.0));
    let y = Axis::from_zero("share of bodies", histogram.iter().map(|n| share(*n)));
    let mut chart = Chart::new(x, y);
    for (k, count) in histogram.iter().enumerate() {
        let at = k as f64;
        let words = format!("{k} partners: {count} bodies");
        chart.bar(Hue::First, [at - 0.4, at + 0.4], share(*count), &words);
    }
    chart.upright(*mean);
    let caption = format!(
        "How many bodies and walls touch a body, for the {bodies} bodies of {which}; a pair counts once \
         however many contacts it has. Mean {mean:.2} (dashed), standard deviation {sd:.2}; without walls \
         {:.2}.",
        shown.mean_without_walls
    );
    Some(Plot::of(
        "coordination",
        "Coordination number",
        caption,
        chart,
    ))
}

/// The sieve curve.
pub(super) fn sieve(tables: &Tables) -> Option<Plot> {
    let points = &tables.sieve.as_ref()?.points;
    let x = Axis::log("size / m", points.iter().map(|point| point.size));
    let y = Axis::linear("part of the mass that is not larger", 0.0, 1.04);
    let mut chart = Chart::new(x, y);
    let mut line = Vec::with_capacity(2 * points.len());
    let mut passing = 0.0;
    for point in points {
        line.extend([[point.size, passing], [point.size, point.passing]]);
        passing = point.passing;
    }
    chart.line(Hue::First, &line);
    let caption = format!(
        "Part of the mass in bodies up to a size, for {} sizes. The size is the circumscribed diameter d, not the mesh of \
         a sieve that a body falls through, which for bodies that are no balls is smaller.",
        points.len()
    );
    Some(Plot::of("sieve", "Sieve curve", caption, chart))
}

/// Tilts in the core, or of all bodies, and near the side walls, over those of random directions.
pub(super) fn tilt(tables: &Tables) -> Option<Plot> {
    let found = tables.tilt.as_ref()?;
    let inner = match found.core.as_ref().filter(|core| core.bodies > 0) {
        Some(core) => ("core", core),
        None => ("all bodies", &found.all),
    };
    let walls = found.side_walls.as_ref().filter(|walls| walls.bodies > 0);
    let mut groups = vec![(Hue::First, inner.0, inner.1)];
    groups.extend(walls.map(|walls| (Hue::Second, "near side walls", walls)));
    let points = |group: &TiltGroup| -> Vec<[f64; 2]> {
        let ratio = |k: usize| {
            let share = f64::from(group.counts[k]) / f64::from(group.bodies);
            let middle = 0.5 * (found.edges[k] + found.edges[k + 1]);
            [middle, share / found.random[k]]
        };
        (0..found.random.len()).map(ratio).collect()
    };
    let lines: Vec<Vec<[f64; 2]>> = groups.iter().map(|group| points(group.2)).collect();
    let x = Axis::linear("tilt / degrees", 0.0, 90.0);
    let heights = lines.iter().flatten().map(|p| p[1]);
    let mut chart = Chart::new(
        x,
        Axis::from_zero("bodies over random", heights.chain([1.5])),
    );
    for ((hue, name, _), line) in groups.iter().zip(&lines) {
        chart.line(*hue, line);
        chart.name(*hue, name);
    }
    chart.level(1.0);
    let caption = format!(
        "Angle between the vertical and the body's axis, the principal axis whose moment of inertia differs most \
         from the other two: number of bodies over that for axes of random direction (dashed: 1), whose density is \
         the sine of the angle. {}.",
        groups
            .iter()
            .map(|(_, name, group)| format!("{} bodies: {name}", group.bodies))
            .collect::<Vec<_>>()
            .join(", ")
    );
    Some(Plot::of("tilt", "Tilt of the bodies", caption, chart))
}

/// The histogram of the local density.
pub(super) fn local_density(tables: &Tables) -> Option<Plot> {
    const BINS: usize = 30;
    let cells = tables.set_voronoi.as_ref()?;
    let counted = || cells.cells.iter().filter(|cell| cell.counted);
    let values: Vec<f64> = counted().map(|cell| cell.density).collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if values.len() < 2 || low >= high {
        return None;
    }
    let bins = BINS.min(values.len().isqrt().max(4));
    let width = (high - low) / bins as f64;
    let mut counts = vec![0_u32; bins];
    for value in &values {
        let bin = ((value - low) / width) as usize;
        if let Some(count) = counts.get_mut(bin.min(bins - 1)) {
            *count += 1;
        }
    }
    let height = |count: u32| f64::from(count) / (values.len() as f64 * width);
    let x = Axis::linear("local packing density", low - width, high + width);
    let y = Axis::from_zero("probability density", counts.iter().map(|n| height(*n)));
    let mut chart = Chart::new(x, y);
    for (k, count) in counts.iter().enumerate() {
        let from = low + width * k as f64;
        let words = format!("{from:.3} to {:.3}: {count} bodies", from + width);
        chart.bar(
            Hue::First,
            [from, from + 0.94 * width],
            height(*count),
            &words,
        );
    }
    let mean = cells.mean.mean;
    chart.upright(mean);
    let error = cells
        .mean
        .standard_error
        .map_or(String::new(), |e| format!(" \u{b1} {e:.4}"));
    let caption = format!(
        "Volume of a body over that of its Set-Voronoi cell, the space nearer to it than to any other \
         body, for {} bodies away from walls and top. Mean {mean:.4}{error} (dashed), standard deviation {:.4}.",
        values.len(),
        cells.deviation
    );
    Some(Plot::of(
        "local-density",
        "Local packing density",
        caption,
        chart,
    ))
}

/// Shares of the classes of contacts, by number and by force.
pub(super) fn classes(tables: &Tables) -> Option<Plot> {
    let classes = tables.classes.as_ref()?;
    let shown = &classes.bodies;
    let contacts: u64 = shown.iter().map(|class| class.contacts).sum();
    if contacts == 0 {
        return None;
    }
    let shares = shown
        .iter()
        .flat_map(|class| [class.share, class.force_share]);
    // Room for the key above the bars.
    let y = Axis::from_zero("share", shares.map(|share| 1.25 * share));
    let names = ["face on face", "edge on face", "point", "unknown"];
    let kinds = if shown[3].contacts > 0 { 4 } else { 3 };
    let x = Axis::classes("kind of contact", &names[..kinds]);
    let mut chart = Chart::new(x, y);
    for (k, (class, name)) in shown.iter().zip(names).take(kinds).enumerate() {
        let at = k as f64;
        let number = format!(
            "{name}: {} contacts, {:.1} %",
            class.contacts,
            100.0 * class.share
        );
        chart.bar(Hue::First, [at - 0.38, at - 0.02], class.share, &number);
        let force = format!(
            "{name}: {:.1} % of the normal forces",
            100.0 * class.force_share
        );
        chart.bar(
            Hue::Second,
            [at + 0.02, at + 0.38],
            class.force_share,
            &force,
        );
    }
    chart.name(Hue::First, "by number");
    chart.name(Hue::Second, "by normal force");
    let caption = format!(
        "How the surfaces of two bodies meet, for {contacts} contacts: their share by number, and of the \
         summed normal forces. A contact of faces also resists rotation."
    );
    Some(Plot::of("classes", "Kinds of contact", caption, chart))
}
