//! Commands name examples that exist: `--example NAME` or `--example=NAME` is a file of some crate's `examples`.

use std::collections::BTreeSet;

use super::Problem;
use super::files::SourceFile;

/// How a command names an example.
const OPTION: &str = "--example";

pub(crate) fn check(files: &[SourceFile]) -> Vec<Problem> {
    let known: BTreeSet<&str> = files
        .iter()
        .filter_map(|file| example(&file.path))
        .collect();
    let mut problems = Vec::new();
    for file in files.iter().filter(|file| !file.path.starts_with("xtask/")) {
        for (at, line) in file.text.lines().enumerate() {
            for name in named(line).filter(|name| !known.contains(name)) {
                let message = format!(
                    "no crate has the example `{name}`: write examples/{name}.rs, or mend the command"
                );
                problems.push(Problem::new(&file.path, at + 1, message));
            }
        }
    }
    problems
}

/// The example that a file is, or begins.
fn example(path: &str) -> Option<&str> {
    let (_, inside) = path.split_once("/examples/")?;
    let name = inside
        .strip_suffix("/main.rs")
        .or_else(|| inside.strip_suffix(".rs"))?;
    (!name.contains('/')).then_some(name)
}

/// The examples that a line names.
fn named(line: &str) -> impl Iterator<Item = &str> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let names = line.split(OPTION).skip(1);
    names
        .filter_map(|rest| rest.strip_prefix([' ', '=']))
        .map(move |rest| rest.split(|c| !is_name(c)).next().unwrap_or_default())
        .filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> SourceFile {
        SourceFile {
            path: path.to_owned(),
            text: text.to_owned(),
        }
    }

    #[test]
    fn an_example_that_is_not_there_is_a_problem() {
        let files = [
            file("crates/a/examples/cost.rs", ""),
            file("crates/a/examples/statics/main.rs", ""),
            file("crates/a/examples/statics/parts.rs", ""),
            file(
                "docs/a.md",
                "cargo run --example cost -- 3\n`--example statics`\ncargo run --example parts --example=gone --examples x",
            ),
        ];
        let problems = check(&files);
        let lines: Vec<usize> = problems.iter().map(|p| p.line).collect();
        assert_eq!(lines, [3, 3]);
        assert!(problems[1].message.contains("`gone`"));
    }
}
