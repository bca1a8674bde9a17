//! The documented crate graph against the real one.
//!
//! The document contains one fenced block marked `crate-graph`, with a line for every package of the workspace:
//! `name -> dependency, dependency`, or `name -> nothing`.

use std::collections::{BTreeMap, BTreeSet};

use super::Problem;
use super::metadata::Package;

const FENCE: &str = "```crate-graph";
const NOTHING: &str = "nothing";

/// One line of the block.
#[derive(Debug, PartialEq, Eq)]
struct Entry {
    line: usize,
    dependencies: BTreeSet<String>,
}

/// The block as read: where it opens, and its lines by package.
#[derive(Debug)]
struct Graph {
    line: usize,
    entries: BTreeMap<String, Entry>,
}

/// Compares the block in `text` with `packages`, in both directions.
pub(crate) fn check(path: &str, text: &str, packages: &[Package]) -> Vec<Problem> {
    let mut problems = Vec::new();
    let Some(graph) = parse(path, text, &mut problems) else {
        return problems;
    };
    let names: BTreeSet<&str> = packages.iter().map(|p| p.name.as_str()).collect();
    for (name, entry) in &graph.entries {
        if !names.contains(name.as_str()) {
            let message = format!("the workspace has no package `{name}`: remove the line");
            problems.push(Problem::new(path, entry.line, message));
        }
    }
    for package in packages {
        match graph.entries.get(&package.name) {
            Some(entry) => problems.extend(compare(path, entry, package)),
            None => problems.push(Problem::new(
                path,
                graph.line,
                format!(
                    "package `{}` is not in the crate graph: add a line for it",
                    package.name
                ),
            )),
        }
    }
    problems
}

fn compare(path: &str, entry: &Entry, package: &Package) -> Vec<Problem> {
    let name = &package.name;
    let undocumented = package
        .dependencies
        .difference(&entry.dependencies)
        .map(|d| {
            format!(
                "`{name}` depends on `{d}`, which the graph does not show: \
                 drop the dependency, or document it if the architecture allows it"
            )
        });
    let gone = entry
        .dependencies
        .difference(&package.dependencies)
        .map(|d| {
            format!(
                "the graph shows `{name} -> {d}`, which {} does not have: remove it",
                package.manifest
            )
        });
    undocumented
        .chain(gone)
        .map(|message| Problem::new(path, entry.line, message))
        .collect()
}

/// Reads the block; `None` if there is none.
fn parse(path: &str, text: &str, problems: &mut Vec<Problem>) -> Option<Graph> {
    let mut lines = text.lines().zip(1..);
    let Some((_, opening)) = lines.find(|(line, _)| line.trim() == FENCE) else {
        let message = "there is no crate graph: add a fenced block marked `crate-graph`";
        problems.push(Problem::new(path, 1, message));
        return None;
    };
    let mut entries = BTreeMap::new();
    for (line, number) in lines.take_while(|(line, _)| !line.trim().starts_with("```")) {
        if line.trim().is_empty() {
            continue;
        }
        let Some((name, right)) = line.split_once("->") else {
            let message = "not a graph line: write `name -> dependency, dependency`";
            problems.push(Problem::new(path, number, message));
            continue;
        };
        let dependencies = right
            .split(',')
            .map(str::trim)
            .filter(|d| !d.is_empty() && *d != NOTHING)
            .map(str::to_owned)
            .collect();
        let entry = Entry {
            line: number,
            dependencies,
        };
        if entries.insert(name.trim().to_owned(), entry).is_some() {
            let message = format!("`{}` stands in the graph twice: keep one line", name.trim());
            problems.push(Problem::new(path, number, message));
        }
    }
    Some(Graph {
        line: opening,
        entries,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(name: &str, dependencies: &[&str]) -> Package {
        Package {
            name: name.to_owned(),
            manifest: format!("crates/{name}/Cargo.toml"),
            is_default: true,
            has_license: true,
            has_features: false,
            roots: Vec::new(),
            dependencies: dependencies.iter().map(|d| (*d).to_owned()).collect(),
        }
    }

    const DOCUMENT: &str = "# Title\n\n```crate-graph\na -> nothing\nb -> a\nc -> a, b\n```\n";

    #[test]
    fn an_equal_graph_is_clean() {
        let packages = [
            package("a", &[]),
            package("b", &["a"]),
            package("c", &["a", "b"]),
        ];
        assert_eq!(check("d.md", DOCUMENT, &packages), []);
    }

    #[test]
    fn both_directions_are_found_at_their_lines() {
        let packages = [
            package("a", &["b"]),
            package("b", &["a"]),
            package("c", &["a"]),
        ];
        let problems = check("d.md", DOCUMENT, &packages);
        let places: Vec<_> = problems.iter().map(|p| p.line).collect();
        assert_eq!(places, [4, 6]);
        assert!(problems[0].message.contains("`a` depends on `b`"));
        assert!(problems[1].message.contains("`c -> b`"));
    }

    #[test]
    fn missing_and_extra_packages_are_found() {
        let packages = [package("a", &[]), package("b", &["a"]), package("d", &[])];
        let problems = check("d.md", DOCUMENT, &packages);
        assert_eq!(problems.len(), 2);
        assert_eq!(problems[0].line, 6);
        assert!(problems[0].message.contains("no package `c`"));
        assert_eq!(problems[1].line, 3);
        assert!(
            problems[1]
                .message
                .contains("`d` is not in the crate graph")
        );
    }

    #[test]
    fn a_missing_block_and_bad_lines_are_found() {
        assert_eq!(check("d.md", "no graph here\n", &[]).len(), 1);
        let bad = "```crate-graph\na - b\na -> nothing\na -> nothing\n```\n";
        let problems = check("d.md", bad, &[package("a", &[])]);
        let places: Vec<_> = problems.iter().map(|p| p.line).collect();
        assert_eq!(places, [2, 4]);
    }
}
