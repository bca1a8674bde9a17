//! `cargo xtask tidy`: checks of the tree that the compiler does not make.
//!
//! Each checker is a pure function from text to a list of [`Problem`]s; this module reads the tree, calls them
//! and prints the problems found.

mod book;
mod circles;
mod crates;
mod examples;
mod files;
mod graph;
mod invariants;
mod lengths;
mod links;
mod metadata;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

use anyhow::Result;

use files::SourceFile;

/// Where the crate graph is documented.
const ARCHITECTURE: &str = "docs/architecture.md";

/// A problem, with its place and how to solve it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Problem {
    /// Path from the workspace root, with `/` between folders.
    path: String,
    /// Line number from 1.
    line: usize,
    /// What is wrong and what to do.
    message: String,
}

impl Problem {
    fn new(path: &str, line: usize, message: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            line,
            message: message.into(),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.message)
    }
}

/// Checks the whole tree and prints a report; returns whether no problem was found.
///
/// # Errors
/// When the tree or `cargo metadata` cannot be read.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let files = files::read_tree(root)?;
    let packages = metadata::packages(root)?;

    let lengths = lengths::measure(&files);
    let mut problems = lengths.problems();
    problems.extend(check_architecture(&files, &packages));
    problems.extend(words::check(&files));
    problems.extend(crates::check(&files, &packages));
    problems.extend(circles::check(&files));
    problems.extend(check_links(root, &files));
    problems.extend(book::check(&files));
    problems.extend(examples::check(&files));
    problems.sort();

    for problem in &problems {
        println!("{problem}");
    }
    println!("tidy: {lengths}");
    match problems.len() {
        0 => println!("tidy: nothing to mend"),
        1 => println!("tidy: 1 problem"),
        count => println!("tidy: {count} problems"),
    }
    Ok(problems.is_empty())
}

fn check_architecture(files: &[SourceFile], packages: &[metadata::Package]) -> Vec<Problem> {
    match find(files, ARCHITECTURE) {
        Some(file) => {
            let mut problems = graph::check(&file.path, &file.text, packages);
            problems.extend(invariants::check(&file.path, &file.text, files));
            problems
        }
        None => vec![Problem::new(
            ARCHITECTURE,
            1,
            "the file is missing: write it, with the crate graph in a `crate-graph` block",
        )],
    }
}

fn check_links(root: &Path, files: &[SourceFile]) -> Vec<Problem> {
    let mut problems = Vec::new();
    if find(files, "README.md").is_none() {
        problems.push(Problem::new(
            "README.md",
            1,
            "the file is missing: write it",
        ));
    }
    let known: BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
    let exists = |path: &str| known.contains(path) || root.join(path).exists();
    let texts: BTreeMap<&str, &str> = files
        .iter()
        .filter(|file| file.extension() == "md")
        .map(|file| (file.path.as_str(), file.text.as_str()))
        .collect();
    for file in files.iter().filter(|file| links::is_guide(&file.path)) {
        problems.extend(links::check(&file.path, &file.text, &texts, exists));
    }
    problems
}

fn find<'a>(files: &'a [SourceFile], path: &str) -> Option<&'a SourceFile> {
    files.iter().find(|file| file.path == path)
}
