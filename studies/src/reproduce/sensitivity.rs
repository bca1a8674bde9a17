//! Sensitivity of the packing density to everything that the paper does not state.

use anyhow::Result;

use super::Scale;
use super::case::{Case, Found, find_recorded, with_error};
use super::job::Size;
use super::page::page;
use super::paper::solid;
use super::record::Record;
use super::runs::Runs;
use super::statistics::{Estimate, estimate, pooled, student};
use crate::validate::report::{Report, markdown_table};

const FRICTION: f64 = 0.6;

/// A change of one parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Variant {
    what: &'static str,
    options: &'static str,
    /// Whether a quick trial includes it.
    quick: bool,
}

const fn variant(what: &'static str, options: &'static str) -> Variant {
    Variant {
        what,
        options,
        quick: false,
    }
}

const fn also_quick(what: &'static str, options: &'static str) -> Variant {
    Variant {
        what,
        options,
        quick: true,
    }
}

/// The variants; the first is the program's default.
const VARIANTS: [Variant; 28] = [
    also_quick("default", ""),
    variant("batches of 5", "--batch 5"),
    variant("batches of 20", "--batch 20"),
    variant("batches of 80", "--batch 80"),
    variant("poured, 200 bodies per second", "--protocol pour"),
    variant(
        "poured, 1,000 bodies per second",
        "--protocol pour --rate 1000",
    ),
    also_quick(
        "all released at once",
        "--protocol release --penetration 0.0035 --explicit",
    ),
    variant("contact damping 0.1 of critical", "--damping 0.1"),
    variant("contact damping 0.3", "--damping 0.3"),
    variant("contact damping 0.7", "--damping 0.7"),
    variant("drag 0.2 sqrt(g/d)", "--drag 0.2/fall"),
    also_quick("drag 0.6", "--drag 0.6/fall"),
    variant("drag 1.5", "--drag 1.5/fall"),
    variant("drag 10, overdamped", "--drag 10/fall"),
    variant(
        "local damping 0.3, no dashpot",
        "--damping 0 --local-damping 0.3",
    ),
    also_quick(
        "local damping 0.6, no dashpot",
        "--damping 0 --local-damping 0.6",
    ),
    variant(
        "local damping 0.8, no dashpot",
        "--damping 0 --local-damping 0.8",
    ),
    variant("local damping 0.6, with the dashpot", "--local-damping 0.6"),
    variant("walls without friction", "--wall-friction 0"),
    variant("wall friction 0.3", "--wall-friction 0.3"),
    variant("friction springs 0.4 of k_n", "--tangential-ratio 0.4"),
    variant("friction springs 1.6 of k_n", "--tangential-ratio 1.6"),
    variant("penetration 0.1 % d aimed at", "--penetration 0.001"),
    also_quick("penetration 1 % d", "--penetration 0.01"),
    variant("diameter 5 mm", "--diameter 0.005"),
    variant("diameter 0.5 m", "--diameter 0.5"),
    variant("gravity of the moon, 1.62 m/s²", "--gravity 1.62"),
    variant(
        "all released at once, drag 0.6",
        "--protocol release --penetration 0.0035 --explicit --drag 0.6/fall",
    ),
];

/// Insets of the core at which the default packs are measured, too, in d.
const INSETS: [f64; 5] = [1.0, 1.5, 2.0, 2.5, 3.0];

fn shapes(scale: Scale) -> &'static [&'static str] {
    match scale {
        Scale::Quick => &["A10"],
        Scale::Full => &["A10", "P3", "A1"],
    }
}

fn variants(scale: Scale) -> Vec<Variant> {
    let chosen = VARIANTS.iter().filter(|v| v.quick || scale == Scale::Full);
    chosen.copied().collect()
}

fn size(shape: &str, scale: Scale) -> Size {
    let volume = solid(shape).map_or(0.0, |solid| solid.volume);
    match scale {
        Scale::Quick => Size::quick(volume),
        Scale::Full => Size::small(volume),
    }
}

/// The packs of the study: by shape, then variant.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let seeds = if scale == Scale::Quick { 2 } else { 3 };
    let of = |shape: &&'static str| {
        let (shape, size) = (*shape, size(shape, scale));
        variants(scale).into_iter().map(move |v| {
            Case::new(
                format!("{shape}, {}", v.what),
                (shape, size),
                FRICTION,
                seeds,
                v.options,
            )
        })
    };
    shapes(scale).iter().flat_map(of).collect()
}

/// # Errors
/// When the program fails.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let record = Record::of(runs, "sensitivity", scale)?;
    let all = find_recorded(runs, &cases(scale), &record)?;
    let blocks: Vec<&[Found]> = all.chunks(variants(scale).len()).collect();
    let text = format!(
        "{}\n{}\n## The inset of the core\n\nThe default packs, measured with other distances of the core \
         from walls, floor and top; mean and standard error. The scatter of small cores is large.\n\n{}",
        introduction(scale),
        table(&blocks, scale),
        insets(runs, &blocks, scale)?
    );
    let title = "Sensitivity of the packing density".to_owned();
    Ok(page("sensitivity", title, text, &all))
}

fn introduction(scale: Scale) -> String {
    let packs: String = shapes(scale)
        .iter()
        .map(|shape| {
            let Size {
                bodies,
                width,
                inset,
            } = size(shape, scale);
            format!("- {shape}: {bodies} bodies, box {width} d wide, core {inset} d from walls, floor and top\n")
        })
        .collect();
    format!(
        "Packs at friction {FRICTION}, each with one thing changed from the program's defaults (in sequence, \
         contact dashpot of 0.6 of critical, no drag; walls with the friction of the bodies; friction springs 0.8 \
         times as stiff as normal contact):\n\n{packs}\n\
         Cells are the density, and in brackets its difference to the default with the 95 % interval: Student's, with the scatter \
         between seeds pooled over all variants of a shape.\n"
    )
}

fn table(blocks: &[&[Found]], scale: Scale) -> String {
    let mut heads = vec!["what", "options"];
    heads.extend(shapes(scale));
    let scatters: Vec<Option<(f64, usize)>> = blocks
        .iter()
        .map(|found| pooled(&found.iter().map(Found::densities).collect::<Vec<_>>()))
        .collect();
    let was_run = |place: usize| {
        let mut cells = blocks.iter().filter_map(|found| found.get(place));
        cells.any(|found| !found.packs.is_empty())
    };
    let rows: Vec<Vec<String>> = variants(scale)
        .iter()
        .enumerate()
        .filter(|(place, _)| was_run(*place))
        .map(|(place, variant)| {
            let mut row = vec![
                variant.what.to_owned(),
                format!("`{}`", variant.options).replace("``", ""),
            ];
            row.extend(blocks.iter().zip(&scatters).map(|(found, scatter)| {
                match (found.get(place), found.first()) {
                    (Some(this), Some(base)) => cell(this, base, *scatter, place == 0),
                    _ => String::new(),
                }
            }));
            row
        })
        .collect();
    markdown_table(&heads, &rows)
}

fn cell(this: &Found, base: &Found, scatter: Option<(f64, usize)>, is_base: bool) -> String {
    let text = with_error(this.density(), 3);
    let (a, b) = (this.densities(), base.densities());
    match scatter {
        Some((deviation, freedom)) if !is_base && !a.is_empty() && !b.is_empty() => {
            let [low, high] = interval(&a, &b, deviation, freedom);
            format!("{text} ({low:+.3} to {high:+.3})")
        }
        _ => text,
    }
}

/// The 95 % interval of mean(a) - mean(b), with the scatter of both known to the given degrees of freedom.
fn interval(a: &[f64], b: &[f64], deviation: f64, freedom: usize) -> [f64; 2] {
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let half = student(freedom) * deviation * (1.0 / a.len() as f64 + 1.0 / b.len() as f64).sqrt();
    let difference = mean(a) - mean(b);
    [difference - half, difference + half]
}

fn insets(runs: &Runs, blocks: &[&[Found]], scale: Scale) -> Result<String> {
    let mut heads = vec!["inset / d"];
    heads.extend(shapes(scale));
    let mut rows = Vec::new();
    for inset in INSETS {
        let mut row = vec![inset.to_string()];
        for base in blocks.iter().filter_map(|found| found.first()) {
            let values = base
                .packs
                .iter()
                .filter(|pack| pack.run.has_tables())
                .map(|pack| {
                    let analysis = pack.run.analysis(runs.program(), inset)?;
                    let kept = analysis.number("core.inset_over_d");
                    Ok(((kept - inset).abs() < 1e-6).then(|| analysis.density()))
                })
                .collect::<Result<Vec<_>>>()?;
            let values: Vec<(f64, f64)> = values.into_iter().flatten().collect();
            let found: Option<Estimate> = estimate(&values);
            let none = if base.packs.iter().any(|pack| pack.run.has_tables()) {
                "too narrow"
            } else {
                "tables gone"
            };
            row.push(found.map_or_else(|| none.to_owned(), |f| with_error(Some(f), 3)));
        }
        rows.push(row);
    }
    Ok(markdown_table(&heads, &rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_change_one_thing_and_are_told_apart() {
        assert!(VARIANTS[0].options.is_empty());
        for (i, a) in VARIANTS.iter().enumerate() {
            assert!(
                VARIANTS
                    .iter()
                    .skip(i + 1)
                    .all(|b| a.options != b.options && a.what != b.what)
            );
        }
        let quick = cases(Scale::Quick);
        assert!(quick.len() == 5 && quick.iter().all(|case| case.jobs.len() == 2));
        assert_eq!(cases(Scale::Full).len(), 3 * VARIANTS.len());
    }

    /// Against the two-sample t-test of a textbook's form.
    #[test]
    fn intervals_are_students() {
        let [low, high] = interval(&[0.62, 0.64], &[0.60, 0.60], 0.01, 2);
        let half = 4.302_653 * 0.01;
        assert!((low - (0.03 - half)).abs() < 1e-9 && (high - (0.03 + half)).abs() < 1e-9);
    }
}
