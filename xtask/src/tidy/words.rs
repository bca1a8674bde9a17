//! Leftovers in the text: markers of unfinished work, debugging macros, paths of one machine,
//! ignored tests without a reason, and unsafe code.
//!
//! The words to look for are put together from parts, so that this file passes its own check.

use super::Problem;
use super::crates::UNSAFE;
use super::files::SourceFile;

const MARKERS: [&str; 3] = [
    concat!("TO", "DO"),
    concat!("FIX", "ME"),
    concat!("X", "XX"),
];
const MACROS: [&str; 3] = ["dbg", "todo", "unimplemented"];
/// First folders of paths that exist on somebody's machine only.
const MACHINE_FOLDERS: [&str; 6] = ["home", "root", "Users", "work", "workspace", "mnt"];
/// What may follow the keyword in real unsafe code, as opposed to the word in a name.
const AFTER_UNSAFE: [&str; 6] = ["{", "(", "fn", "impl", "trait", "extern"];

/// Checks every file for the leftovers that are relevant for its kind.
pub(crate) fn check(files: &[SourceFile]) -> Vec<Problem> {
    files.iter().flat_map(check_file).collect()
}

fn check_file(file: &SourceFile) -> Vec<Problem> {
    let extension = file.extension();
    let is_rust = extension == "rs";
    let has_words = is_rust || extension == "toml" || extension == "md";
    let in_crate = file.path.strip_prefix("crates/");
    let is_library = is_rust
        && in_crate
            .is_some_and(|path| path.contains("/src/") && path.split('/').next() != Some(UNSAFE));
    let mut problems = Vec::new();
    for (line, number) in file.text.lines().zip(1..) {
        let mut report = |message: String| {
            problems.push(Problem::new(&file.path, number, message));
        };
        if has_words {
            for word in leftovers(line) {
                report(format!("`{word}` is left behind: finish it or remove it"));
            }
        }
        if let Some(path) = machine_path(line) {
            report(format!(
                "`{path}` exists on one machine only: write a relative path"
            ));
        }
        if is_rust && is_ignored_without_reason(line) {
            report("an ignored test says why and how to run it: `ignore = \"reason\"`".to_owned());
        }
        if is_library && is_unsafe(line) {
            report("the libraries hold no unsafe code: write it with safe means".to_owned());
        }
    }
    problems
}

/// Markers and macros of unfinished work in a line.
fn leftovers(line: &str) -> Vec<String> {
    let markers = MARKERS
        .iter()
        .filter(|marker| words(line, marker).next().is_some())
        .map(|marker| (*marker).to_owned());
    let macros = MACROS
        .iter()
        .filter(|name| words(line, name).any(|rest| rest.starts_with('!')))
        .map(|name| format!("{name}!"));
    markers.chain(macros).collect()
}

/// The start of an absolute path on somebody's machine, if the line holds one.
fn machine_path(line: &str) -> Option<String> {
    MACHINE_FOLDERS.iter().find_map(|folder| {
        let path = format!("/{folder}/");
        let found = line.match_indices(&path).any(|(at, _)| {
            let before = line.get(..at).and_then(|text| text.chars().next_back());
            // Part of a longer path or of a web address otherwise.
            !before.is_some_and(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '}'))
        });
        found.then_some(path)
    })
}

fn is_ignored_without_reason(line: &str) -> bool {
    let compact: String = line.chars().filter(|c| !c.is_whitespace()).collect();
    compact.contains(concat!("#[", "ignore]"))
        || (compact.contains("#[cfg_attr(") && compact.contains(concat!(",", "ignore)]")))
}

fn is_unsafe(line: &str) -> bool {
    let code = without_comment_and_strings(line);
    words(&code, "unsafe").any(|rest| {
        let rest = rest.trim_start();
        AFTER_UNSAFE.iter().any(|next| rest.starts_with(next)) || rest.is_empty()
    })
}

/// The text after each place where `word` occurs as a whole word in `line`.
fn words<'a>(line: &'a str, word: &'a str) -> impl Iterator<Item = &'a str> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).filter_map(move |(at, _)| {
        let before = line.get(..at)?;
        let after = line.get(at + word.len()..)?;
        (!before.ends_with(is_part) && !after.starts_with(is_part)).then_some(after)
    })
}

/// A line of Rust up to its line comment, with the contents of its strings left out.
fn without_comment_and_strings(line: &str) -> String {
    let mut code = String::with_capacity(line.len());
    let mut in_string = false;
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '\\' if in_string => {
                characters.next();
            }
            '"' => {
                in_string = !in_string;
                code.push(c);
            }
            '/' if !in_string && characters.peek() == Some(&'/') => break,
            _ if !in_string => code.push(c),
            _ => {}
        }
    }
    code
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
    fn markers_count_as_whole_words_only() {
        let marker = MARKERS[0];
        assert_eq!(leftovers(&format!("// {marker}: later")), [marker]);
        assert_eq!(
            leftovers(&format!("let {marker}S = 1;")),
            Vec::<String>::new()
        );
        assert_eq!(leftovers("nothing todo here"), Vec::<String>::new());
    }

    #[test]
    fn macros_count_with_their_exclamation_mark() {
        for name in MACROS {
            assert_eq!(leftovers(&format!("    {name}!(x)")), [format!("{name}!")]);
            assert_eq!(
                leftovers(&format!("{name} = \"warn\"")),
                Vec::<String>::new()
            );
            assert_eq!(leftovers(&format!("my_{name}!(x)")), Vec::<String>::new());
        }
    }

    #[test]
    fn paths_of_a_machine_are_found_and_relative_ones_are_not() {
        for folder in MACHINE_FOLDERS {
            let path = format!("/{folder}/");
            assert_eq!(
                machine_path(&format!("open {path}me/x")),
                Some(path.clone())
            );
            assert_eq!(machine_path(&format!("data{path}x")), None);
            assert_eq!(machine_path(&format!("..{path}x")), None);
        }
    }

    #[test]
    fn an_ignored_test_needs_a_reason() {
        let bare = concat!("    #[", "ignore]");
        let spaced = concat!("#[ ", "ignore ]");
        let conditional = concat!("#[cfg_attr(windows, ", "ignore)]");
        for line in [bare, spaced, conditional] {
            assert!(is_ignored_without_reason(line), "{line}");
        }
        assert!(!is_ignored_without_reason("#[ignore = \"takes an hour\"]"));
    }

    #[test]
    fn unsafe_code_is_told_from_the_word() {
        let keyword = "unsafe";
        for rest in [
            " { f() }",
            " fn f() {}",
            " impl Send for X {}",
            "",
            "(no_mangle)",
        ] {
            assert!(is_unsafe(&format!("{keyword}{rest}")), "{rest}");
        }
        for line in [
            "// that step is unsafe {see the paper}",
            "#![forbid(unsafe_code)]",
            "let text = \"unsafe { \\\" unsafe fn\";",
        ] {
            assert!(!is_unsafe(line), "{line}");
        }
    }

    #[test]
    fn each_check_looks_at_its_own_files() {
        let text = "unsafe { f() }\n";
        assert_eq!(check(&[file("crates/a/src/x.rs", text)]).len(), 1);
        assert_eq!(check(&[file("crates/a/tests/x.rs", text)]).len(), 0);
        let border = format!("crates/{UNSAFE}/src/x.rs");
        assert_eq!(check(&[file(&border, text)]).len(), 0);
        let neighbour = format!("crates/{UNSAFE}-more/src/x.rs");
        assert_eq!(check(&[file(&neighbour, text)]).len(), 1);
        assert_eq!(check(&[file("docs/x.md", text)]).len(), 0);
        let marker = MARKERS[1];
        let two = check(&[file("docs/x.md", marker), file("data/x.json", marker)]);
        assert_eq!(two.len(), 1);
        assert_eq!((two[0].path.as_str(), two[0].line), ("docs/x.md", 1));
    }
}
