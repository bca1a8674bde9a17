//! Figure 7: force chains and numbers of contacts of A5, A10 and P3.

use anyhow::{Context, Result};

use super::Scale;
use super::case::{Case, Found, beside, by_reading, find, with_error};
use super::job::kinds;
use super::page::{capital, page};
use super::paper::{Contacts, FIGURE7, solid};
use super::readings::{READINGS, Reading, explained};
use super::run::Analysis;
use super::runs::Runs;
use super::statistics::{Estimate, bootstrap_difference};
use crate::validate::report::{Report, markdown_table};

const FRICTION: f64 = 0.6;

/// Error of the means that the paper states with two digits.
const MEAN_ERROR: f64 = 0.003;

/// The rules for chains: the key in the analysis and a description.
const RULES: [(&str, &str); 2] = [
    (
        "chains_by_weight",
        "the paper's rule (F_c/W above 1.5 times its mean)",
    ),
    ("chains_by_stress", "Peters et al. (2005), by stress"),
];

/// The measures of the backbone of a chain; the paper says that A10 has more of all except turns.
const MEASURES: [&str; 4] = [
    "bodies in a chain",
    "length of the backbone / d",
    "straightness of the backbone",
    "turn from link to link / rad",
];

/// The packs of the study: by size, then reading, then solid.
pub(super) fn cases(scale: Scale) -> Vec<Case> {
    let mut cases = Vec::new();
    for kind in kinds(scale) {
        for reading in READINGS {
            for Contacts { name, .. } in FIGURE7 {
                let size = (kind.size)(solid(name).map_or(0.0, |solid| solid.volume));
                let label = format!("{name}, {}, {}", reading.key, kind.name);
                cases.push(Case::new(
                    label,
                    (name, size),
                    FRICTION,
                    kind.seeds,
                    reading.options,
                ));
            }
        }
    }
    cases
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let all = find(runs, &cases(scale))?;
    let mut text = introduction();
    let blocks = all.chunks(READINGS.len() * FIGURE7.len());
    for (kind, block) in kinds(scale).into_iter().zip(blocks) {
        let word = kind.name;
        let readings = by_reading(block, FIGURE7.len());
        if !readings.is_empty() {
            text += &format!("\n## {} packs\n\n{}", capital(word), overview(&readings));
        }
        for (reading, found) in readings {
            let key = reading.key;
            text += &format!(
                "\n## Reading \"{key}\", {word} packs\n\n{}\n",
                numbers(found)
            );
            for (rule, name) in RULES {
                text += &format!("\n### Chains by {name}\n\n{}", chains(found, rule)?);
            }
        }
    }
    let title = "Figure 7: numbers of contacts and force chains".to_owned();
    Ok(page("figure7", title, text, &all))
}

fn introduction() -> String {
    format!(
        "Figure 7 of Xiang, Latham and Farsi (DEM7, 2016): rhombicosidodecahedra (A5), truncated dodecahedra (A10) and \
         dodecahedra (P3) at friction 0.6. Are the chains of A10 longer and straighter, as the paper says?\n\n{}\n\
         A backbone is the longest of the shortest ways within a chain; its straightness is the distance of its ends \
         over its length. Differences have 95 % intervals by the bootstrap over chains, for the turn over sub-boxes and \
         seeds.\n",
        explained()
    )
}

/// Means and shares of contacts, compared with the paper's.
fn numbers(found: &[Found]) -> String {
    let rows: Vec<Vec<String>> = FIGURE7
        .iter()
        .zip(found)
        .map(|(contacts, found)| {
            let mean = found.mean(|analysis| mean_with_error(analysis, "mean_coordination"));
            let published = Some((contacts.mean, MEAN_ERROR));
            let apart = |key: &str| match shares(found, key) {
                list if list.is_empty() => "not run".to_owned(),
                list => format!("{:.1} %", moved(contacts, &list)),
            };
            vec![
                contacts.name.to_owned(),
                contacts.mean.to_string(),
                beside(found.core_coordination(), published),
                beside(mean, published),
                apart("core_coordination"),
                apart("coordination"),
            ]
        })
        .collect();
    let heads = [
        "solid",
        "paper's mean",
        "core",
        "all bodies",
        "bodies in other bars, core",
        "all",
    ];
    markdown_table(&heads, &rows)
}

/// Mean numbers of contacts in all readings, compared with the paper's.
fn overview(readings: &[(Reading, &[Found])]) -> String {
    let mut heads = vec!["mean number of contacts", "paper"];
    heads.extend(readings.iter().map(|(reading, _)| reading.key));
    let mut rows = Vec::new();
    for (place, contacts) in FIGURE7.iter().enumerate() {
        let line = |name: &str, mean: &dyn Fn(&Found) -> Option<Estimate>| {
            let mut row = vec![
                format!("{}, {name}", contacts.name),
                contacts.mean.to_string(),
            ];
            row.extend(readings.iter().map(|(_, found)| {
                let mean = found.get(place).and_then(mean);
                with_error(mean, 2)
            }));
            row
        };
        rows.push(line("core", &Found::core_coordination));
        rows.push(line("all bodies", &|found| {
            found.mean(|analysis| mean_with_error(analysis, "mean_coordination"))
        }));
    }
    markdown_table(&heads, &rows)
}

fn mean_with_error(analysis: &Analysis, key: &str) -> (f64, f64) {
    let number = |part: &str| analysis.number(&format!("{key}.{part}"));
    (number("mean"), number("standard_error"))
}

/// Percent of the bodies of all packs with 0, 1, 2 ... partners.
fn shares(found: &Found, key: &str) -> Vec<f64> {
    let mut counts: Vec<f64> = Vec::new();
    for pack in &found.packs {
        for (k, count) in pack
            .analysis
            .numbers(&format!("{key}.histogram"))
            .into_iter()
            .enumerate()
        {
            counts.resize(counts.len().max(k + 1), 0.0);
            counts[k] += count;
        }
    }
    let sum: f64 = counts.iter().sum();
    counts.iter().map(|count| 100.0 * count / sum).collect()
}

/// Percent of the bodies that would have to change their bar to give the paper's histogram.
fn moved(contacts: &Contacts, shares: &[f64]) -> f64 {
    let longest = shares.len().max(contacts.percent.len());
    let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or_default();
    let difference = |k| (at(shares, k) - at(&contacts.percent, k)).abs();
    0.5 * (0..longest).map(difference).sum::<f64>()
}

/// Chains of the packs of a case by one rule.
struct Chains {
    /// Values of the first three measures, chain by chain.
    lists: [Vec<f64>; 3],
    /// The last measure.
    turn: Estimate,
}

fn read(found: &Found, rule: &str) -> Result<Option<Chains>> {
    let mut lists = [Vec::new(), Vec::new(), Vec::new()];
    for pack in &found.packs {
        let diameter = pack.run.summary.number("diameter")?;
        let keys = [("bodies", 1.0), ("length", diameter), ("straightness", 1.0)];
        for (list, (key, unit)) in lists.iter_mut().zip(keys) {
            let values = pack.analysis.column(&format!("{rule}.chains"), key);
            list.extend(values.into_iter().map(|value| value / unit));
        }
    }
    let turn = found.mean(|analysis| mean_with_error(analysis, &format!("{rule}.turning")));
    Ok(turn.map(|turn| Chains { lists, turn }))
}

/// Means of the solids, and the differences of A10 to the others with intervals.
fn chains(found: &[Found], rule: &str) -> Result<String> {
    let all = found
        .iter()
        .map(|f| read(f, rule))
        .collect::<Result<Vec<_>>>()?;
    let claimed = FIGURE7
        .iter()
        .position(|c| c.name == "A10")
        .context("A10 is not in the figure")?;
    let mut heads = vec!["measure".to_owned()];
    heads.extend(FIGURE7.iter().map(|c| c.name.to_owned()));
    let others: Vec<usize> = (0..FIGURE7.len()).filter(|i| *i != claimed).collect();
    for other in &others {
        heads.push(format!("A10 less {}, 95 %", FIGURE7[*other].name));
        heads.push("as the paper says".to_owned());
    }
    let mut count = vec!["chains".to_owned()];
    let chains_of = |c: &Option<Chains>| c.as_ref().map_or(0, |c| c.lists[0].len()).to_string();
    count.extend(all.iter().map(chains_of));
    count.extend(vec![String::new(); 2 * others.len()]);
    let mut rows = vec![count];
    for (measure, name) in MEASURES.iter().enumerate() {
        let mut row = vec![(*name).to_owned()];
        row.extend(all.iter().map(|c| {
            c.as_ref()
                .map_or_else(|| "not run".to_owned(), |c| c.told(measure))
        }));
        for other in &others {
            let interval = match (&all[claimed], &all[*other]) {
                (Some(a), Some(b)) => a.less(b, measure),
                _ => None,
            };
            row.extend(verdict(interval, measure));
        }
        rows.push(row);
    }
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    Ok(markdown_table(&heads, &rows))
}

impl Chains {
    fn told(&self, measure: usize) -> String {
        match self.lists.get(measure) {
            Some(list) if list.is_empty() => "none".to_owned(),
            Some(list) => format!("{:.3}", list.iter().sum::<f64>() / list.len() as f64),
            None => with_error(Some(self.turn), 3),
        }
    }

    /// The 95 % interval of the mean here minus the mean there.
    fn less(&self, other: &Self, measure: usize) -> Option<[f64; 2]> {
        if let (Some(a), Some(b)) = (self.lists.get(measure), other.lists.get(measure)) {
            return bootstrap_difference(a, b, 2000);
        }
        let (difference, _) = self.turn.against(other.turn.mean, 0.0);
        let half = 1.96 * self.turn.error.hypot(other.turn.error);
        half.is_finite()
            .then_some([difference - half, difference + half])
    }
}

/// The interval, and whether it supports the paper's statement: more of everything except turns.
fn verdict(interval: Option<[f64; 2]>, measure: usize) -> [String; 2] {
    let Some([low, high]) = interval else {
        return ["unknown".to_owned(), "unknown".to_owned()];
    };
    let (yes, no) = if measure == MEASURES.len() - 1 {
        (high < 0.0, low > 0.0)
    } else {
        (low > 0.0, high < 0.0)
    };
    let word = match (yes, no) {
        (true, _) => "yes",
        (_, true) => "no, the contrary",
        _ => "undecided",
    };
    [format!("{low:+.3} to {high:+.3}"), word.to_owned()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_that_agree_move_nothing_and_others_all() {
        let contacts = &FIGURE7[0];
        assert!(moved(contacts, &contacts.percent) < 1e-12);
        let far: Vec<f64> = std::iter::repeat_n(0.0, 15).chain([100.0]).collect();
        assert!((moved(contacts, &far) - 100.0).abs() < 0.5);
    }

    #[test]
    fn straight_chains_turn_less() {
        let word = |interval, measure| verdict(Some(interval), measure)[1].clone();
        assert_eq!(word([0.1, 0.3], 0), "yes");
        assert_eq!(word([0.1, 0.3], 3), "no, the contrary");
        assert_eq!(word([-0.3, -0.1], 3), "yes");
        assert_eq!(word([-0.1, 0.1], 2), "undecided");
        assert_eq!(verdict(None, 0)[0], "unknown");
    }

    #[test]
    fn differences_have_their_sign() {
        let chains = |bodies: &[f64], mean| Chains {
            lists: [bodies.to_vec(), bodies.to_vec(), vec![]],
            turn: Estimate {
                mean,
                error: 0.01,
                count: 1,
            },
        };
        let (long, short) = (chains(&[7.0, 8.0, 9.0], 0.5), chains(&[3.0, 4.0, 3.0], 0.8));
        assert!(long.less(&short, 0).unwrap()[0] > 0.0);
        assert!(long.less(&short, 3).unwrap()[1] < 0.0);
        assert_eq!(long.less(&short, 2), None);
    }
}
