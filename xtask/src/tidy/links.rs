//! Links of the guides to files of the project.

use super::Problem;

/// Whether a file is one of the guides whose links are checked: the Markdown files of the top
/// folder and of `docs/`.
pub(crate) fn is_guide(path: &str) -> bool {
    path.ends_with(".md") && (!path.contains('/') || path.starts_with("docs/"))
}

/// Checks that every relative link in the guide `text` at `path` leads to a file or folder
/// for which `exists` holds, given its path from the workspace root.
pub(crate) fn check(path: &str, text: &str, exists: impl Fn(&str) -> bool) -> Vec<Problem> {
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut problems = Vec::new();
    for (target, line) in relative_links(text) {
        let message = match resolve(folder, &target) {
            Some(file) if exists(&file) => continue,
            Some(file) => format!("the link to `{target}` leads to {file}, which does not exist"),
            None => format!("the link to `{target}` leads out of the project"),
        };
        let message = format!("{message}: mend or remove it");
        problems.push(Problem::new(path, line, message));
    }
    problems
}

/// Targets of the relative links with their lines, without their `#section` parts. Code is
/// skipped.
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

/// The file that a target names; `None` for a web address or a section of the same file.
fn relative_target(target: &str) -> Option<String> {
    let address = target.split_whitespace().next()?;
    let is_web = address.contains("://") || address.starts_with("mailto:");
    let file = address.split('#').next().unwrap_or_default();
    (!is_web && !file.is_empty()).then(|| file.trim_matches(['<', '>']).to_owned())
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
            ("d.md", 2),
            ("e.md", 3),
        ];
        assert_eq!(links, expected.map(|(t, n)| (t.to_owned(), n)));
    }

    #[test]
    fn addresses_sections_and_code_are_left_alone() {
        let text = "[w](https://example.org/a) [s](#units) `x[i](j)` [m](mailto:a@b.c)\n\
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
        let text = "[good](../README.md)\n[bad](gone.md)\n[out](../../x)\n";
        let problems = check("docs/a.md", text, |path| path == "README.md");
        let places: Vec<_> = problems.iter().map(|p| p.line).collect();
        assert_eq!(places, [2, 3]);
        assert!(problems[0].message.contains("docs/gone.md"));
    }

    #[test]
    fn guides_are_the_top_and_docs_markdown_files() {
        assert!(is_guide("README.md") && is_guide("docs/a.md"));
        assert!(!is_guide("crates/a/notes.md") && !is_guide("docs/a.txt"));
    }
}
