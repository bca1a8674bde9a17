//! Random pairs through every contact kernel.

use std::collections::BTreeMap;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use super::program::Workshop;
use super::report::{Check, Report, short};

const THREADS: usize = 3;
const SEED: u32 = 1;

const COLUMNS: [&str; 4] = ["kernel", "pairs", "touching", "not_finite_or_negative"];

/// The output of the example `fuzz_pairs`: a line of numbers for each kernel, and single numbers.
#[derive(Debug, Default, PartialEq)]
struct Output {
    kernels: Vec<[String; 4]>,
    arrangements: Vec<[String; 2]>,
    numbers: BTreeMap<String, f64>,
}

impl Output {
    fn parse(text: &str) -> Self {
        let mut output = Self::default();
        for line in text.lines() {
            match line.split('\t').collect::<Vec<_>>()[..] {
                ["kernel", name, asked, touching, faults] => {
                    let row = [name, asked, touching, faults].map(str::to_owned);
                    output.kernels.push(row);
                }
                ["arrangement", name, count] => {
                    output.arrangements.push([name, count].map(str::to_owned));
                }
                [name, number] => {
                    let number = number.parse().unwrap_or(f64::NAN);
                    output.numbers.insert(name.to_owned(), number);
                }
                _ => {}
            }
        }
        output
    }

    /// A number by its name; NaN if it was not printed.
    fn number(&self, name: &str) -> f64 {
        self.numbers.get(name).copied().unwrap_or(f64::NAN)
    }

    fn faults(&self) -> f64 {
        let count = |row: &[String; 4]| row[3].parse::<f64>().unwrap_or(f64::NAN);
        self.kernels.iter().map(count).sum()
    }

    fn checks(&self, count: u32) -> Vec<Check> {
        let pairs = self.number("pairs");
        let faults = if self.kernels.is_empty() {
            f64::NAN
        } else {
            self.faults()
        };
        vec![
            Check::holds(
                "pairs",
                &count.to_string(),
                pairs,
                pairs == f64::from(count),
            ),
            Check::at_most("panics", self.number("panics"), 0.0, ""),
            Check::at_most("contacts not finite or negative", faults, 0.0, ""),
            Check::at_most(
                "energy of the convex kernel against the general one over p r^3",
                self.number("energy difference"),
                1e-9,
                "",
            ),
        ]
    }

    fn text(&self) -> String {
        let arrangements: Vec<String> = self
            .arrangements
            .iter()
            .map(|[name, count]| format!("{name} {count}"))
            .collect();
        format!(
            "Pairs drawn by `femdem_contact::strategies`: convex and other bodies, radii of {} to {} m, \
             at the origin and up to 1e5 m away from it ({} of them farther than 1e4 m), in the \
             arrangements {}. Numbers count as negative from 1e-9 of what a deep overlap gives. Kernels \
             with a cache are asked three times for each pair. Energies of the convex and the general kernel are \
             compared wherever a force acts, with r the radius of the smaller body.",
            short(self.number("smallest radius")),
            short(self.number("largest radius")),
            short(self.number("farther than 1e4 m")),
            arrangements.join(", "),
        )
    }
}

/// Draws `count` pairs and evaluates them with every kernel.
///
/// # Errors
/// When the example cannot be built or fails.
pub(crate) fn run(workshop: &Workshop, count: u32) -> Result<Report> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = format!(
        "run --release --locked -p femdem-contact --features proptest --example fuzz_pairs -- \
         {count} {THREADS} {SEED}"
    );
    let output = Command::new(cargo)
        .args(arguments.split_whitespace())
        .current_dir(workshop.root())
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .context("cannot start cargo")?;
    ensure!(output.status.success(), "the example fuzz_pairs failed");
    let output = Output::parse(&String::from_utf8_lossy(&output.stdout));
    Ok(Report {
        name: "fuzz-pairs",
        title: "Random pairs through every contact kernel".to_owned(),
        text: output.text(),
        commands: vec![format!("cargo {arguments}")],
        checks: output.checks(count),
        columns: COLUMNS.to_vec(),
        rows: output.kernels.iter().map(|row| row.to_vec()).collect(),
        attachments: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "kernel\tconvex\t10\t8\t0\nkernel\tgeneral, sum\t20\t9\t0\n\
                        arrangement\tGeneral\t20\npairs\t20\npanics\t0\nenergy difference\t1e-12\n";

    #[test]
    fn a_clean_run_meets_all() {
        let output = Output::parse(TEXT);
        assert_eq!(output.kernels.len(), 2);
        assert_eq!(output.kernels[0].len(), COLUMNS.len());
        assert!(output.checks(20).iter().all(|check| check.met));
        assert!(output.text().contains("General 20"));
    }

    #[test]
    fn faults_panics_and_missing_pairs_are_told() {
        let missed = |text: &str| {
            let checks = Output::parse(text).checks(20);
            checks.iter().filter(|check| !check.met).count()
        };
        assert_eq!(missed(&TEXT.replace("8\t0", "8\t1")), 1);
        assert_eq!(missed(&TEXT.replace("panics\t0", "panics\t2")), 1);
        assert_eq!(missed(&TEXT.replace("pairs\t20", "pairs\t19")), 1);
        assert_eq!(missed(""), 4);
    }
}
