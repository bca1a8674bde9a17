//! Packs that differ in the seed alone, and their combined results.

use anyhow::Result;

use super::job::{Job, Size};
use super::pack::Pack;
use super::readings::{READINGS, Reading};
use super::record::Record;
use super::run::Analysis;
use super::runs::Runs;
use super::statistics::{Estimate, estimate};
use crate::validate::report::short;

/// A pack to be made with one seed or more.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Case {
    /// Label in the table of runs.
    pub(super) label: String,
    pub(super) inset: f64,
    pub(super) jobs: Vec<Job>,
}

/// Results of a case. Packs that are not settled are not among `packs`.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub(super) case: Case,
    pub(super) packs: Vec<Pack>,
    /// Rows of the table of runs, settled or not.
    pub(super) rows: Vec<Vec<String>>,
    /// Commands of the runs.
    pub(super) commands: Vec<String>,
    /// Runs that are missing.
    pub(super) missing: usize,
    /// Runs taken from the last page.
    pub(super) recorded: usize,
    /// Runs that are not settled.
    pub(super) restless: usize,
}

impl Case {
    /// A shape at a friction coefficient, with the seeds 1 to `seeds` and more options.
    pub(super) fn new(
        label: String,
        (shape, size): (&str, Size),
        friction: f64,
        seeds: u32,
        more: &str,
    ) -> Self {
        Self {
            label,
            inset: size.inset,
            jobs: (1..=seeds)
                .map(|seed| size.job(shape, friction, seed, more))
                .collect(),
        }
    }

    /// Whether its options set a mean penetration above `limit`, over d.
    pub(super) fn aims_deeper_than(&self, limit: f64) -> bool {
        self.jobs.iter().any(|job| {
            let mut words = job.options.split_whitespace();
            let asked = words.find(|word| *word == "--penetration");
            let depth = asked.and_then(|_| words.next()?.parse::<f64>().ok());
            depth.is_some_and(|depth| depth > limit)
        })
    }
}

/// Finds or makes the runs of all cases, and measures them.
///
/// # Errors
/// When the program fails.
pub(super) fn find(runs: &Runs, cases: &[Case]) -> Result<Vec<Found>> {
    find_recorded(runs, cases, &Record::default())
}

/// The same; runs that are missing and not to be made are taken from the record.
///
/// # Errors
/// When the program fails, or the record lacks a column.
pub(super) fn find_recorded(runs: &Runs, cases: &[Case], record: &Record) -> Result<Vec<Found>> {
    let jobs: Vec<Job> = cases.iter().flat_map(|case| case.jobs.clone()).collect();
    let made = runs.all(&jobs)?;
    cases
        .iter()
        .map(|case| {
            let mut found = Found::none(case);
            for (job, seed) in case.jobs.iter().zip(1..) {
                let label = format!("{}, seed {seed}", case.label);
                let pack = if let Some(run) = made.get(&job.key()).cloned() {
                    let analysis = run.analysis(runs.program(), case.inset)?;
                    Pack { run, analysis }
                } else if let Some(pack) = record.pack(&label, job)? {
                    found.recorded += 1;
                    pack
                } else {
                    found.missing += 1;
                    continue;
                };
                found.commands.push(format!("femdem pack {}", job.options));
                found.rows.push(pack.run.row(&label, &pack.analysis)?);
                if pack.run.summary.is_settled() {
                    found.packs.push(pack);
                } else {
                    found.restless += 1;
                }
            }
            Ok(found)
        })
        .collect()
}

impl Found {
    /// Empty results.
    pub(super) fn none(case: &Case) -> Self {
        Self {
            case: case.clone(),
            packs: Vec::new(),
            rows: Vec::new(),
            commands: Vec::new(),
            missing: 0,
            recorded: 0,
            restless: 0,
        }
    }

    /// Packing density of the core.
    pub(super) fn density(&self) -> Option<Estimate> {
        self.mean(Analysis::density)
    }

    /// Coordination number of the bodies in the core.
    pub(super) fn core_coordination(&self) -> Option<Estimate> {
        self.mean(|analysis| {
            let number = |key: &str| analysis.number(&format!("core_mean_coordination.{key}"));
            (number("mean"), number("standard_error"))
        })
    }

    /// The mean of a number of each pack and of its error.
    pub(super) fn mean(&self, number: impl Fn(&Analysis) -> (f64, f64)) -> Option<Estimate> {
        let values: Vec<(f64, f64)> = self.packs.iter().map(|p| number(&p.analysis)).collect();
        estimate(&values).filter(|found| found.mean.is_finite())
    }

    /// Densities of the packs.
    pub(super) fn densities(&self) -> Vec<f64> {
        self.packs
            .iter()
            .map(|pack| pack.analysis.density().0)
            .collect()
    }
}

/// A mean and its error, such as "0.5743 ± 0.0021".
pub(super) fn with_error(found: Option<Estimate>, digits: usize) -> String {
    match found {
        Some(Estimate { mean, error, .. }) if error.is_finite() => {
            format!("{mean:.digits$} ± {error:.digits$}")
        }
        Some(Estimate { mean, .. }) => format!("{mean:.digits$}"),
        None => "not run".to_owned(),
    }
}

/// A mean with its difference from a published value: "0.574 ± 0.002 (+0.004, 1.2 s)", s being the combined
/// standard error.
pub(super) fn beside(found: Option<Estimate>, published: Option<(f64, f64)>) -> String {
    let text = with_error(found, 3);
    match (found, published) {
        (Some(found), Some((value, error))) => {
            let (difference, sigmas) = found.against(value, error);
            if sigmas.is_finite() {
                format!("{text} ({difference:+.3}, {sigmas:+.1} s)")
            } else {
                format!("{text} ({difference:+.3})")
            }
        }
        _ => text,
    }
}

/// Blocks of cases, each of a reading, without blocks that have no results.
pub(super) fn by_reading(found: &[Found], each: usize) -> Vec<(Reading, &[Found])> {
    let blocks = READINGS.into_iter().zip(found.chunks(each.max(1)));
    blocks
        .filter(|(_, block)| block.iter().any(|f| !f.packs.is_empty()))
        .collect()
}

/// Total cost of the runs of cases.
pub(super) fn cost(found: &[Found]) -> String {
    let sum = |path: &str| -> f64 {
        let packs = found.iter().flat_map(|f| &f.packs);
        packs
            .filter_map(|pack| pack.run.summary.number(path).ok())
            .sum()
    };
    let bodies = sum("count");
    let (cpu, wall) = (sum("cpu_seconds"), sum("wall_seconds"));
    let packs: usize = found.iter().map(|f| f.packs.len()).sum();
    format!(
        "Cost: {packs} packs of {} bodies in all, {} s of processor time ({} ms for each body), {} s on the \
         clock if run one after another.",
        short(bodies),
        short(cpu),
        short(1e3 * cpu / bodies),
        short(wall)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packs_that_aim_deeper_are_told_apart() {
        let aims = |options: &str| {
            Case::new(String::new(), ("A1", Size::small(0.4)), 0.6, 2, options)
                .aims_deeper_than(0.005)
        };
        assert!(
            aims("--penetration 0.01") && aims("--drag 0.6/fall --penetration 0.006 --explicit")
        );
        assert!(!aims("") && !aims("--penetration 0.005") && !aims("--drag 0.6/fall"));
    }

    #[test]
    fn values_are_told_with_what_is_known() {
        let found = |error| {
            Some(Estimate {
                mean: 0.5741,
                error,
                count: 1,
            })
        };
        assert_eq!(with_error(found(0.003), 3), "0.574 ± 0.003");
        assert_eq!(with_error(found(f64::NAN), 2), "0.57");
        assert_eq!(with_error(None, 3), "not run");
        assert_eq!(
            beside(found(0.003), Some((0.5641, 0.004))),
            "0.574 ± 0.003 (+0.010, +2.0 s)"
        );
        assert_eq!(
            beside(found(f64::NAN), Some((0.5641, 0.004))),
            "0.574 (+0.010)"
        );
        assert_eq!(beside(found(0.003), None), "0.574 ± 0.003");
    }

    #[test]
    fn seeds_make_the_jobs_of_a_case() {
        let size = Size::small(0.4);
        let case = Case::new("A10".to_owned(), ("A10", size), 0.6, 3, "--drag 0.6/fall");
        assert_eq!(case.jobs.len(), 3);
        assert!(case.jobs[2].options.ends_with("--seed 3 --drag 0.6/fall"));
        assert_eq!(case.inset, 2.0);
    }
}
