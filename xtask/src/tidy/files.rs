//! Reading the text files of the tree.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// Extensions of the files that are read.
const EXTENSIONS: [&str; 5] = ["rs", "toml", "md", "json", "sh"];

/// Files without an extension that are also read.
const SCRIPTS: [&str; 1] = [".ci/run"];

/// A text file of the workspace.
#[derive(Debug, Clone)]
pub(crate) struct SourceFile {
    /// Path from the workspace root, with `/` between folders.
    pub(crate) path: String,
    pub(crate) text: String,
}

impl SourceFile {
    /// The part of the file name after the last dot, or nothing.
    pub(crate) fn extension(&self) -> &str {
        let name = self.path.rsplit('/').next().unwrap_or_default();
        name.rsplit_once('.').map_or("", |(_, extension)| extension)
    }
}

/// All text files below `root`, sorted by path, without build outputs and the history.
pub(crate) fn read_tree(root: &Path) -> Result<Vec<SourceFile>> {
    let mut files = Vec::new();
    read_folder(root, "", &mut files)?;
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}

fn read_folder(folder: &Path, prefix: &str, files: &mut Vec<SourceFile>) -> Result<()> {
    let shown = folder.display();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot list {shown}"))? {
        let entry = entry.with_context(|| format!("cannot list {shown}"))?;
        let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
        let kind = entry
            .file_type()
            .with_context(|| format!("cannot inspect {path}"))?;
        if kind.is_dir() && !is_output(&path) {
            read_folder(&entry.path(), &format!("{path}/"), files)?;
        } else if kind.is_file() && is_wanted(&path) {
            let text = fs::read_to_string(entry.path())
                .with_context(|| format!("cannot read {path} as UTF-8 text"))?;
            files.push(SourceFile { path, text });
        }
    }
    Ok(())
}

/// Folders with the output of builds or runs, named as in `.gitignore`.
fn is_output(path: &str) -> bool {
    path == "out" || path == ".git" || path == "target" || path.ends_with("/target")
}

fn is_wanted(path: &str) -> bool {
    let extension = path.rsplit_once('.').map_or("", |(_, extension)| extension);
    EXTENSIONS.contains(&extension) || SCRIPTS.contains(&path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_wanted_and_binaries_are_not() {
        for path in ["a/b.rs", "Cargo.toml", "docs/x.md", ".ci/run"] {
            assert!(is_wanted(path), "{path}");
        }
        for path in ["Cargo.lock", "docs/pack.png", "x/.ci/run", "run"] {
            assert!(!is_wanted(path), "{path}");
        }
    }

    #[test]
    fn outputs_are_skipped_and_modules_are_not() {
        for path in ["target", "out", ".git", "crates/a/target"] {
            assert!(is_output(path), "{path}");
        }
        for path in ["crates/a/src/out", "crates", ".ci", "src/targets"] {
            assert!(!is_output(path), "{path}");
        }
    }
}
