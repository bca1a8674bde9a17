//! Lengths of the Rust files.

use std::fmt;

use super::Problem;
use super::files::SourceFile;

/// No file may have more lines.
const LONGEST: usize = 800;
/// At most one file in ten may have more lines.
const LONG: usize = 450;
/// The median file may not have more lines.
const MEDIAN: usize = 200;

/// Lines per Rust file, longest first.
pub(crate) struct Lengths {
    by_length: Vec<(usize, String)>,
}

/// Counts the lines of the Rust files.
pub(crate) fn measure(files: &[SourceFile]) -> Lengths {
    let mut by_length: Vec<_> = files
        .iter()
        .filter(|file| file.extension() == "rs")
        .map(|file| (file.text.lines().count(), file.path.clone()))
        .collect();
    by_length.sort_by(|a, b| b.cmp(a));
    Lengths { by_length }
}

impl Lengths {
    /// The middle length; the smaller of the two middle ones for an even count.
    fn median(&self) -> usize {
        self.by_length
            .get(self.by_length.len() / 2)
            .map_or(0, |(lines, _)| *lines)
    }

    fn long(&self) -> impl Iterator<Item = &(usize, String)> {
        self.by_length.iter().take_while(|(lines, _)| *lines > LONG)
    }

    /// Violations of the limits.
    pub(crate) fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        for (lines, path) in self.long().filter(|(lines, _)| *lines > LONGEST) {
            let message = format!("{lines} lines, at most {LONGEST}: split the file by topic");
            problems.push(Problem::new(path, LONGEST + 1, message));
        }
        let (count, long) = (self.by_length.len(), self.long().count());
        if long * 10 > count {
            for (lines, path) in self.long() {
                let message = format!(
                    "{lines} lines, and {long} of {count} files have over {LONG} \
                     (at most one in ten): split some of them"
                );
                problems.push(Problem::new(path, LONG + 1, message));
            }
        }
        if self.median() > MEDIAN {
            let message = format!(
                "the median Rust file has {} lines, at most {MEDIAN}: split the longer files",
                self.median()
            );
            problems.push(Problem::new("Cargo.toml", 1, message));
        }
        problems
    }
}

impl fmt::Display for Lengths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (longest, path) = self
            .by_length
            .first()
            .map_or((0, "none"), |(lines, path)| (*lines, path.as_str()));
        write!(
            f,
            "{} Rust files, median {} lines, {} over {LONG}, longest {longest} ({path})",
            self.by_length.len(),
            self.median(),
            self.long().count(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(lengths: &[usize]) -> Lengths {
        let files: Vec<_> = lengths
            .iter()
            .enumerate()
            .map(|(index, lines)| SourceFile {
                path: format!("src/f{index}.rs"),
                text: "x\n".repeat(*lines),
            })
            .collect();
        measure(&files)
    }

    #[test]
    fn limits_hold_up_to_the_last_line() {
        let mut lengths = vec![100; 9];
        lengths.push(800);
        assert_eq!(tree(&lengths).problems(), []);
        lengths[9] = 801;
        let problems = tree(&lengths).problems();
        assert_eq!(problems.len(), 1);
        assert_eq!(problems[0].path, "src/f9.rs");
    }

    #[test]
    fn more_than_one_long_file_in_ten_is_a_problem_for_each() {
        let mut lengths = vec![100; 18];
        lengths.extend([451, 450]);
        assert_eq!(tree(&lengths).problems(), []);
        lengths.extend([460, 470]);
        assert_eq!(tree(&lengths).problems().len(), 3);
    }

    #[test]
    fn median_is_the_middle_one_and_is_limited() {
        assert_eq!(tree(&[1, 9, 5]).median(), 5);
        assert_eq!(tree(&[1, 9, 5, 7]).median(), 5);
        assert_eq!(tree(&[]).median(), 0);
        assert_eq!(tree(&[200, 200, 200]).problems(), []);
        assert_eq!(tree(&[201, 201, 201]).problems().len(), 1);
    }

    #[test]
    fn other_files_do_not_count() {
        let file = SourceFile {
            path: "README.md".to_owned(),
            text: "x\n".repeat(5000),
        };
        assert_eq!(measure(&[file]).problems(), []);
    }
}
