//! The book in `docs`: every page is in its table of contents, it is no longer than it may be, and the tests that it
//! names exist.

use std::collections::BTreeSet;

use super::files::SourceFile;
use super::{Problem, find, invariants};

/// The table of contents.
const SUMMARY: &str = "docs/SUMMARY.md";

/// Most words of all pages together but the one that the program writes. Marks of tables and code alone do not count.
const MOST_WORDS: usize = 31_000;

/// The page that the program writes: the options with their help.
const WRITTEN: &str = "docs/options.md";

/// Pages of formulas, whose paragraphs that begin with "Tests:" name the tests that hold them.
const THEORY: &str = "docs/theory/";

pub(crate) fn check(files: &[SourceFile]) -> Vec<Problem> {
    let Some(summary) = find(files, SUMMARY) else {
        let message = "the file is missing: write it, with a link to every page";
        return vec![Problem::new(SUMMARY, 1, message)];
    };
    let pages = || {
        let is_page =
            |path: &str| path.starts_with("docs/") && path.ends_with(".md") && path != SUMMARY;
        files.iter().filter(move |file| is_page(&file.path))
    };
    let mut problems = Vec::new();
    for page in pages() {
        let link = format!("]({})", page.path.trim_start_matches("docs/"));
        if !summary.text.contains(&link) {
            let message = format!("the page is not in {SUMMARY}: add it");
            problems.push(Problem::new(&page.path, 1, message));
        }
    }
    let counted = pages().filter(|page| page.path != WRITTEN);
    let words: usize = counted.map(|page| words(&page.text)).sum();
    if words > MOST_WORDS {
        let message = format!("the book has {words} words, {MOST_WORDS} are allowed: shorten it");
        problems.push(Problem::new(SUMMARY, 1, message));
    }
    let functions = invariants::functions(files);
    for page in pages().filter(|page| page.path.starts_with(THEORY)) {
        problems.extend(named_tests(&page.path, &page.text, &functions));
    }
    problems
}

/// Words with a letter or a digit.
fn words(text: &str) -> usize {
    let is_word = |word: &&str| word.contains(char::is_alphanumeric);
    text.split_whitespace().filter(is_word).count()
}

/// Names between backticks in the paragraphs of tests that are no functions of the tree.
fn named_tests(path: &str, text: &str, functions: &BTreeSet<&str>) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut is_list = false;
    for (line, number) in text.lines().zip(1..) {
        is_list = !line.trim().is_empty() && (is_list || line.starts_with("Tests:"));
        if is_list {
            for name in line.split('`').skip(1).step_by(2) {
                if !functions.contains(name) {
                    let message = format!("there is no test `{name}`: name one that exists");
                    problems.push(Problem::new(path, number, message));
                }
            }
        }
    }
    problems
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
    fn pages_outside_the_contents_and_tests_that_are_gone_are_found() {
        let files = [
            file(SUMMARY, "- [A](a.md)\n- [B](theory/b.md)\n"),
            file("docs/a.md", "one | two `x`\n"),
            file("docs/c.md", ""),
            file(
                "docs/theory/b.md",
                "`other`\n\nTests: `here`,\n`gone`.\n\n`none`\n",
            ),
            file("crates/a.rs", "fn here() {\n"),
        ];
        let places: Vec<_> = check(&files)
            .into_iter()
            .map(|p| (p.path, p.line))
            .collect();
        let wanted = [("docs/c.md", 1), ("docs/theory/b.md", 4)];
        assert_eq!(places, wanted.map(|(path, line)| (path.to_owned(), line)));
        assert_eq!(check(&files[1..]).len(), 1);
    }

    #[test]
    fn a_long_book_is_told() {
        assert_eq!(words("a | --- | b-c\n\n2 =\n"), 3);
        let long = "word ".repeat(MOST_WORDS + 1);
        let files = [file(SUMMARY, "[A](a.md)"), file("docs/a.md", &long)];
        assert_eq!(check(&files).len(), 1);
    }
}
