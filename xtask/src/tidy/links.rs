//! Links of the guides to files of the project and to their headings.

use std::collections::BTreeMap;

use super::Problem;

/// Whether a file is one of the guides whose links are checked: the Markdown files of the top
/// folder, of `docs/` and of `records/`.
pub(crate) fn is_guide(path: &str) -> bool {
    let folders = ["docs/", "records/"];
    let is_in = folders.iter().any(|folder| path.starts_with(folder));
    path.ends_with(".md") && (!path.contains('/') || is_in)
}

/// Checks that every relative link in the guide `text` at `path` leads to a file or folder for which `exists`
/// holds, given its path from the workspace root, and to a heading of it where it names one; `texts` are those of
/// the Markdown files by their paths.
pub(crate) fn check(
    path: &str,
    text: &str,
    texts: &BTreeMap<&str, &str>,
    exists: impl Fn(&str) -> bool,
) -> Vec<Problem> {
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut problems = Vec::new();
    for (target, line) in relative_links(text) {
        let (file, section) = target.split_once('#').unwrap_or((&target, ""));
        let place = match file {
            "" => Some(path.to_owned()),
            file => resolve(folder, file),
        };
        let message = match place {
            None => format!("the link to `{target}` leads out of the project"),
            Some(place) if !exists(&place) => {
                format!("the link to `{target}` leads to {place}, which does not exist")
            }
            Some(place) => match texts.get(place.as_str()) {
                Some(text) if !section.is_empty() && !has_heading(text, section) => {
                    format!("the link to `{target}` names a heading that {place} does not have")
                }
                _ => continue,
            },
        };
        let message = format!("{message}: mend or remove it");
        problems.push(Problem::new(path, line, message));
    }
    problems
}

/// Whether a text has the heading that a section of a link names.
fn has_heading(text: &str, section: &str) -> bool {
    let mut in_code = false;
    text.lines().any(|line| {
        in_code ^= line.trim_start().starts_with("```");
        !in_code && line.starts_with('#') && anchor(line.trim_start_matches('#').trim()) == section
    })
}

/// The section of a heading, as code hosts and mdBook name it: small letters, hyphens for spaces, and neither
/// punctuation nor the addresses of links.
fn anchor(heading: &str) -> String {
    let mut text = String::new();
    let mut rest = heading;
    while let Some((before, after)) = rest.split_once("](") {
        text += before;
        rest = after.split_once(')').map_or("", |(_, rest)| rest);
    }
    text += rest;
    let kept = text.chars().filter_map(|c| match c {
        ' ' => Some('-'),
        '-' | '_' => Some(c),
        c if c.is_alphanumeric() => c.to_lowercase().next(),
        _ => None,
    });
    kept.collect()
}

/// Targets of the relative links with their lines. Code is skipped.
fn relative_links(text: &str) -> Vec<(String, usize)> {
    let mut links = Vec::new();
    let mut in_code = false;
    for (line, number) in text.lines().zip(1..) {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        } else if !in_code {
            let prose = without_code_spans(line);
            let targets = targets(&prose).into_iter().filter_map(relative_target);
            links.extend(targets.map(|target| (target, number)));
        }
    }
    links
}

/// The line without text between backticks.
fn without_code_spans(line: &str) -> String {
    line.split('`').step_by(2).collect()
}

/// Everything at a place where Markdown or HTML expects an address.
fn targets(prose: &str) -> Vec<&str> {
    let mut targets = Vec::new();
    for (opening, closing) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
        for (at, _) in prose.match_indices(opening) {
            let rest = prose.get(at + opening.len()..).unwrap_or_default();
            targets.extend(rest.split_once(closing).map(|(target, _)| target));
        }
    }
    // A definition for links by name: `[name]: target`.
    if prose.starts_with('[')
        && let Some((_, target)) = prose.split_once("]: ")
    {
        targets.push(target);
    }
    targets
}

/// The file and section that a target names; `None` for a web address.
fn relative_target(target: &str) -> Option<String> {
    let address = target.split_whitespace().next()?;
    let is_web = address.contains("://") || address.starts_with("mailto:");
    (!is_web).then(|| address.trim_matches(['<', '>']).to_owned())
}

/// The path from the workspace root of `target` as seen from `folder`; `None` if it leads out of the workspace.
fn resolve(folder: &str, target: &str) -> Option<String> {
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(target.split('/')) {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_in_all_notations_are_seen_with_their_lines() {
        let text = "See [a](a.md) and ![b](img/b.png \"title\").\n\
                    <img src=\"c.svg\"> and <a href=\"d.md#part\">d</a>\n\
                    [e]: e.md\n";
        let links = relative_links(text);
        let expected = [
            ("a.md", 1),
            ("img/b.png", 1),
            ("c.svg", 2),
            ("d.md#part", 2),
            ("e.md", 3),
        ];
        assert_eq!(links, expected.map(|(t, n)| (t.to_owned(), n)));
    }

    #[test]
    fn addresses_and_code_are_left_alone() {
        let text = "[w](https://example.org/a) `x[i](j)` [m](mailto:a@b.c)\n\
                    ```rust\nlet y = f[0](z);\n```\n";
        assert_eq!(relative_links(text), []);
    }

    #[test]
    fn targets_are_found_from_the_folder_of_the_guide() {
        assert_eq!(resolve("docs", "x.md").as_deref(), Some("docs/x.md"));
        assert_eq!(resolve("docs", "../LICENSE").as_deref(), Some("LICENSE"));
        assert_eq!(resolve("", "./docs/").as_deref(), Some("docs"));
        assert_eq!(resolve("docs", "../../secret"), None);
    }

    #[test]
    fn broken_links_are_reported() {
        let text = "[good](../README.md#first-steps)\n[bad](gone.md)\n[out](../../x)\n[no](../README.md#last)\n[none](#b)\n\
                    [here](#a)\n# A\n";
        let texts = BTreeMap::from([
            ("README.md", "## First `steps`\n```\n# last\n```\n"),
            ("docs/a.md", text),
        ]);
        let problems = check("docs/a.md", text, &texts, |path| texts.contains_key(path));
        let places: Vec<_> = problems.iter().map(|p| p.line).collect();
        assert_eq!(places, [2, 3, 4, 5]);
        assert!(problems[0].message.contains("docs/gone.md"));
    }

    #[test]
    fn sections_are_named_as_hosts_name_them() {
        for (heading, name) in [
            ("`[[body.boundary]]`", "bodyboundary"),
            ("summary.json", "summaryjson"),
            (
                "Chains, forces and [orientation](a.md)",
                "chains-forces-and-orientation",
            ),
        ] {
            assert_eq!(anchor(heading), name);
        }
    }

    #[test]
    fn guides_are_the_markdown_files_of_the_top_docs_and_records() {
        assert!(is_guide("README.md") && is_guide("docs/a/b.md") && is_guide("records/a.md"));
        assert!(!is_guide("crates/a/notes.md") && !is_guide("docs/a.txt"));
    }
}
