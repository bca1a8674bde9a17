//! The tests named in the table of invariants against the tests that exist.

use std::collections::BTreeSet;

use super::Problem;
use super::files::SourceFile;

const HEADING: &str = "## Invariants";

/// Every name with an underscore between backticks in the table must be a function of the tree,
/// and every row must name one.
pub(crate) fn check(path: &str, text: &str, files: &[SourceFile]) -> Vec<Problem> {
    let functions = functions(files);
    let rows = text
        .lines()
        .zip(1..)
        .skip_while(|(line, _)| line.trim() != HEADING)
        .skip(1)
        .take_while(|(line, _)| !line.starts_with("## "))
        .filter(|(line, _)| line.starts_with("| **"));
    let mut problems = Vec::new();
    for (row, number) in rows {
        let names: Vec<&str> = names(row).collect();
        if names.is_empty() {
            let message = "the invariant has no test: write one and name it here";
            problems.push(Problem::new(path, number, message));
        }
        for name in names.iter().filter(|name| !functions.contains(*name)) {
            let message = format!("there is no test `{name}`: name one that exists");
            problems.push(Problem::new(path, number, message));
        }
    }
    problems
}

/// The names of all functions of the tree.
pub(crate) fn functions(files: &[SourceFile]) -> BTreeSet<&str> {
    files
        .iter()
        .filter(|file| file.extension() == "rs")
        .flat_map(|file| file.text.lines().filter_map(function))
        .collect()
}

/// The name of the function that a line opens.
fn function(line: &str) -> Option<&str> {
    let rest = line.trim_start().strip_prefix("fn ")?;
    rest.split_once('(').map(|(name, _)| name)
}

/// Code in a row that has the form of a test's name.
fn names(row: &str) -> impl Iterator<Item = &str> {
    let is_name = |text: &&str| {
        text.contains('_') && text.chars().all(|c| c == '_' || c.is_ascii_alphanumeric())
    };
    row.split('`').skip(1).step_by(2).filter(is_name)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "## Other\n| **x** | `not_here` |\n## Invariants\n\n| name | tests |\n|---|---|\n\
                         | **One** | it is `f64`; a: `holds_once`, `holds_twice`; `cargo xtask ci` |\n\
                         | **Two** | prose only |\n## Next\n| **y** | `nor_here` |\n";

    fn tree(text: &str) -> Vec<SourceFile> {
        vec![SourceFile {
            path: "crates/a/tests/t.rs".to_owned(),
            text: text.to_owned(),
        }]
    }

    #[test]
    fn missing_tests_and_rows_without_one_are_found() {
        let problems = check("d.md", TABLE, &tree("#[test]\n    fn holds_once() {\n"));
        let places: Vec<_> = problems.iter().map(|p| p.line).collect();
        assert_eq!(places, [7, 8]);
        assert!(problems[0].message.contains("`holds_twice`"));
    }

    #[test]
    fn tests_with_arguments_count_and_other_files_do_not() {
        let text = "fn holds_once(x in 0..3) {\nfn holds_twice() {\n";
        assert_eq!(check("d.md", TABLE, &tree(text)).len(), 1);
        let mut prose = tree(text);
        prose[0].path = "notes.md".to_owned();
        assert_eq!(check("d.md", TABLE, &prose).len(), 3);
    }
}
