//! The common parts of the pages of all studies.

use anyhow::Result;

use super::case::{Found, cost};
use super::run::COLUMNS;
use super::runs::Runs;
use crate::validate::report::{Check, Report};

/// A page of packs: the text of a study, then cost, missing runs, and the table of runs.
pub(super) fn page(name: &'static str, title: String, text: String, found: &[Found]) -> Report {
    let gaps = match missing(found).as_str() {
        "" => String::new(),
        list => format!("\n\nNot run: {list}."),
    };
    Report {
        name,
        title,
        text: format!("{text}\n\n{}{}{gaps}", cost(found), recorded(found)),
        commands: found.iter().flat_map(|f| f.commands.clone()).collect(),
        checks: checks(found),
        columns: COLUMNS.to_vec(),
        rows: found.iter().flat_map(|f| f.rows.clone()).collect(),
        attachments: Vec::new(),
    }
}

/// The number of runs taken from the last page.
fn recorded(found: &[Found]) -> String {
    match found.iter().map(|f| f.recorded).sum::<usize>() {
        0 => String::new(),
        number => format!(" {number} runs are those of the table of before."),
    }
}

/// Values under names, in the order in which the names were added.
type Named<T> = Vec<(String, T)>;

/// Cases with missing runs. Those that share all except the first word of their labels are grouped, and among
/// these those that lack the same number of the same number of runs.
fn missing(found: &[Found]) -> String {
    let mut groups: Named<Named<Vec<String>>> = Vec::new();
    for f in found.iter().filter(|f| f.missing > 0) {
        let label = &f.case.label;
        let (first, rest) = label.split_once(", ").unwrap_or((label, ""));
        let seeds = match (f.missing, f.case.jobs.len()) {
            (lacking, all) if lacking < all => format!(" ({lacking} of {all} seeds)"),
            _ => String::new(),
        };
        named(named(&mut groups, rest), &seeds).push(first.to_owned());
    }
    let told = |(rest, entries): &(String, Named<Vec<String>>)| {
        let entries: Vec<String> = (entries.iter())
            .map(|(seeds, firsts)| firsts.join(", ") + seeds)
            .collect();
        match rest.as_str() {
            "" => entries.join("; "),
            rest => format!("{rest}: {}", entries.join("; ")),
        }
    };
    groups.iter().map(told).collect::<Vec<_>>().join(". ")
}

/// The entry of a name in a list, added at its end if it is not there.
fn named<'a, T: Default>(list: &'a mut Named<T>, name: &str) -> &'a mut T {
    let at = list.iter().position(|(n, _)| n == name).unwrap_or_else(|| {
        list.push((name.to_owned(), T::default()));
        list.len() - 1
    });
    &mut list[at].1
}

/// A word with a capital.
pub(super) fn capital(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

/// The mean penetration of bodies is below this part of d.
const MEAN_PENETRATION: f64 = 0.005;

fn checks(found: &[Found]) -> Vec<Check> {
    let restless: usize = found.iter().map(|f| f.restless).sum();
    let packs: usize = found.iter().map(|f| f.packs.len()).sum();
    let missing: usize = found.iter().map(|f| f.missing).sum();
    let penetration = found
        .iter()
        .filter(|f| !f.case.aims_deeper_than(MEAN_PENETRATION))
        .flat_map(|f| &f.packs)
        .filter_map(|pack| pack.run.summary.number("penetration.mean_over_d").ok())
        .fold(f64::NAN, f64::max);
    vec![
        Check::holds(
            "packs at rest with all bodies awake, no drag and no local damping; others do not count",
            "all",
            format!("{packs} of {}", packs + restless),
            restless == 0 && packs > 0,
        ),
        Check::holds("runs", "all", format!("{missing} missing"), missing == 0),
        Check::at_most(
            "largest mean penetration over d, but of packs that aim at more",
            penetration,
            MEAN_PENETRATION,
            "",
        ),
    ]
}

impl Runs<'_> {
    /// Puts a picture next to a page.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(super) fn attach(&self, report: &mut Report, file: &str, svg: &str) -> Result<()> {
        let path = self.workshop().write(file, svg.as_bytes())?;
        report.attachments.push(path);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::Case;
    use super::super::job::Size;
    use super::*;

    #[test]
    fn what_is_missing_is_told_in_groups() {
        let found = |shape: &str, seeds, missing| {
            let size = Size::small(0.4);
            let label = format!("{shape}, drag, small");
            Found {
                missing,
                ..Found::none(&Case::new(label, (shape, size), 0.6, seeds, ""))
            }
        };
        let all = [
            found("A1", 3, 2),
            found("A3", 3, 0),
            found("A5", 1, 1),
            found("P1", 3, 2),
        ];
        assert_eq!(missing(&all), "drag, small: A1, P1 (2 of 3 seeds); A5");
        assert_eq!(missing(&all[1..2]), "");
        let met: Vec<bool> = checks(&all).iter().map(|check| check.met).collect();
        assert_eq!(met, [false; 3]);
    }
}
