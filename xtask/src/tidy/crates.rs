//! Requirements on every crate: opening docs with their sections, a licence, the shared lints; which are the default ones.

use std::collections::BTreeSet;

use super::files::SourceFile;
use super::metadata::{Package, TargetRoot};
use super::{Problem, find};

/// The bindings would turn on the features that `--no-default-features` is to leave out.
const BINDINGS: [&str; 2] = ["femdem-capi", "femdem-python"];

/// The crate whose lints are its own: it alone may hold unsafe code.
pub(super) const UNSAFE: &str = "femdem-capi";

/// Checks every package of the workspace; docs sections and shared lints are required of the packages in
/// `crates/` only.
pub(crate) fn check(files: &[SourceFile], packages: &[Package]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for package in packages {
        if !package.has_license {
            let message = "no licence: write `license.workspace = true` under [package]";
            problems.push(Problem::new(&package.manifest, 1, message));
        }
        if package.is_default
            != (is_published(package) && !BINDINGS.contains(&package.name.as_str()))
        {
            let message = "`default-members` of the workspace are the packages in `crates/` without those of other \
                           languages: list the others only";
            problems.push(Problem::new(
                "Cargo.toml",
                1,
                format!("{}: {message}", package.name),
            ));
        }
        if is_published(package)
            && package.name != UNSAFE
            && let Some(manifest) = find(files, &package.manifest)
            && !has_workspace_lints(&manifest.text)
        {
            let message = "the shared lints are off: add `[lints]` with `workspace = true`";
            problems.push(Problem::new(&package.manifest, 1, message));
        }
        if package.name == UNSAFE
            && let Some(manifest) = find(files, &package.manifest)
            && let Some(workspace) = find(files, "Cargo.toml")
        {
            let own = lints(&manifest.text, "[lints.");
            for lint in lints(&workspace.text, "[workspace.lints.") {
                if !lint.1.starts_with("unsafe_code=") && !own.contains(&lint) {
                    let (tool, line) = &lint;
                    let message = format!(
                        "a lint of the workspace is off: add `{line}` under [lints.{tool}]"
                    );
                    problems.push(Problem::new(&package.manifest, 1, message));
                }
            }
        }
        for root in &package.roots {
            if let Some(file) = find(files, &root.path) {
                problems.extend(check_docs(package, root, &file.text));
            }
        }
    }
    problems
}

fn is_published(package: &Package) -> bool {
    package.manifest.starts_with("crates/")
}

/// Whether the manifest has a `[lints]` table that inherits the workspace's.
fn has_workspace_lints(manifest: &str) -> bool {
    let mut table = "";
    manifest.lines().map(str::trim).any(|line| {
        if line.starts_with('[') {
            table = line;
        }
        let compact: String = line.chars().filter(|c| !c.is_whitespace()).collect();
        compact == "lints.workspace=true" || (table == "[lints]" && compact == "workspace=true")
    })
}

/// The lints of a manifest, each with its tool, without spaces.
fn lints(manifest: &str, table: &str) -> BTreeSet<(String, String)> {
    let mut tool = None;
    let mut lints = BTreeSet::new();
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            tool = line
                .strip_prefix(table)
                .and_then(|rest| rest.strip_suffix(']'));
        } else if let Some(tool) = tool
            && line.contains('=')
            && !line.starts_with('#')
        {
            let compact = line.chars().filter(|c| !c.is_whitespace()).collect();
            lints.insert((tool.to_owned(), compact));
        }
    }
    lints
}

fn check_docs(package: &Package, root: &TargetRoot, text: &str) -> Vec<Problem> {
    if !text.starts_with("//!") {
        let message = "the file does not open with `//!` docs: say what the crate is for";
        return vec![Problem::new(&root.path, 1, message)];
    }
    if !is_published(package) || !root.is_library {
        return Vec::new();
    }
    let docs: Vec<&str> = text.lines().filter_map(|l| l.strip_prefix("//!")).collect();
    let has_heading = |word: &str| {
        docs.iter()
            .map(|line| line.trim())
            .any(|line| line.starts_with('#') && line.to_lowercase().contains(word))
    };
    let mut wanted = vec!["units", "accuracy"];
    if package.has_features {
        wanted.push("features");
    }
    let mut missing: Vec<String> = wanted
        .into_iter()
        .filter(|word| !has_heading(word))
        .map(|word| {
            format!("the crate docs have no heading with the word `{word}`: add the section")
        })
        .collect();
    if !docs.iter().any(|line| line.trim().starts_with("```")) {
        missing.push("the crate docs have no example: add a short one that compiles".to_owned());
    }
    missing
        .into_iter()
        .map(|message| Problem::new(&root.path, 1, message))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(folder: &str, has_features: bool) -> Package {
        Package {
            name: "a".to_owned(),
            manifest: format!("{folder}/Cargo.toml"),
            is_default: folder.starts_with("crates/"),
            has_license: true,
            has_features,
            roots: vec![TargetRoot {
                path: format!("{folder}/src/lib.rs"),
                is_library: true,
            }],
            dependencies: Default::default(),
        }
    }

    fn tree(folder: &str, manifest: &str, docs: &str) -> Vec<SourceFile> {
        [("Cargo.toml", manifest), ("src/lib.rs", docs)]
            .map(|(name, text)| SourceFile {
                path: format!("{folder}/{name}"),
                text: text.to_owned(),
            })
            .to_vec()
    }

    const MANIFEST: &str = "[package]\nname = \"a\"\n\n[lints]\nworkspace = true\n";
    const DOCS: &str = "//! For tests.\n//!\n//! ```\n//! let x = 1;\n//! ```\n\
                        //! # Units and accuracy\n//! SI.\n";

    #[test]
    fn a_complete_crate_is_clean() {
        let files = tree("crates/a", MANIFEST, DOCS);
        assert_eq!(check(&files, &[package("crates/a", false)]), []);
    }

    #[test]
    fn features_are_asked_for_where_the_crate_has_some() {
        let files = tree("crates/a", MANIFEST, DOCS);
        let problems = check(&files, &[package("crates/a", true)]);
        assert_eq!(problems.len(), 1);
        assert!(problems[0].message.contains("`features`"));
    }

    #[test]
    fn bare_docs_miss_their_sections_and_no_docs_are_one_problem() {
        let bare = tree("crates/a", MANIFEST, "//! For tests.\nmod x;\n");
        assert_eq!(check(&bare, &[package("crates/a", false)]).len(), 3);
        let none = tree("crates/a", MANIFEST, "mod x;\n");
        assert_eq!(check(&none, &[package("crates/a", false)]).len(), 1);
    }

    #[test]
    fn helpers_outside_crates_need_an_opening_line_only() {
        let files = tree("xtask", "[package]\n", "//! Chores.\n");
        assert_eq!(check(&files, &[package("xtask", true)]), []);
    }

    #[test]
    fn crates_are_default_members_and_bindings_are_not() {
        let files = tree("crates/a", MANIFEST, DOCS);
        let mut left_out = package("crates/a", false);
        left_out.is_default = false;
        let mut bindings = package("crates/a", false);
        bindings.name = BINDINGS[0].to_owned();
        for wrong in [left_out, bindings] {
            assert_eq!(check(&files, &[wrong]).len(), 1);
        }
    }

    #[test]
    fn the_crate_with_unsafe_code_has_all_other_lints() {
        let workspace = "[workspace.lints.rust]\nmissing_docs = \"deny\"\nunsafe_code = \"forbid\"\n\
                         [workspace.lints.clippy]\ntodo = \"warn\"\n[profile.dev]\ndebug = true\n";
        let root = SourceFile {
            path: "Cargo.toml".to_owned(),
            text: workspace.to_owned(),
        };
        let border = Package {
            name: UNSAFE.to_owned(),
            is_default: false,
            ..package("crates/a", false)
        };
        let problems = |manifest: &str| {
            let mut files = tree("crates/a", manifest, DOCS);
            files.push(SourceFile {
                path: root.path.clone(),
                text: root.text.clone(),
            });
            check(&files, std::slice::from_ref(&border))
        };
        let rust = "[lints.rust]\nmissing_docs = \"deny\"\n";
        let clippy = "[lints.clippy]\ntodo = \"warn\"\n";
        assert_eq!(problems(&format!("{rust}\n{clippy}")), []);
        let found = problems(rust);
        assert_eq!(found.len(), 1);
        assert!(
            found[0]
                .message
                .contains("`todo=\"warn\"` under [lints.clippy]")
        );
    }

    #[test]
    fn licence_and_lints_are_asked_for() {
        let mut without = package("crates/a", false);
        without.has_license = false;
        let files = tree("crates/a", "[lints.rust]\nworkspace = true\n", DOCS);
        let problems = check(&files, &[without]);
        assert_eq!(problems.len(), 2);
        assert!(has_workspace_lints("[package]\nlints.workspace = true\n"));
    }
}
