//! `cargo xtask book`: the commands of the book and of the README, run by the program as a reader would.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, ensure};

/// Where the pages are run, from the workspace root: a folder for each, emptied before.
const PLAYGROUND: &str = "target/book-runs";

/// What the commands read, from the workspace root.
const INPUTS: [&str; 2] = ["scenes", "records"];

/// Commands of a page, and what the page says that they print.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Block {
    /// Line of the page on which the commands begin.
    line: usize,
    commands: String,
    /// Lines of a `text` block that follows; each must be printed. Lines of dots are left out.
    printed: Vec<String>,
}

/// Runs the `sh` blocks of all pages, or of those whose path contains `only`, in order, with the program built in
/// release; returns whether all ended well and printed what the page says.
///
/// # Errors
/// When the program cannot be built or a page cannot be read.
pub(crate) fn run(root: &Path, only: Option<&str>) -> Result<bool> {
    let program = build(root)?;
    let mut faults = 0;
    for page in pages(root)? {
        let name = page
            .strip_prefix(root)
            .unwrap_or(&page)
            .display()
            .to_string();
        let text = fs::read_to_string(&page).with_context(|| format!("cannot read {name}"))?;
        let blocks = blocks(&text);
        if blocks.is_empty() || only.is_some_and(|part| !name.contains(part)) {
            continue;
        }
        let start = Instant::now();
        let folder = playground(root, &name)?;
        let mut good = true;
        for block in &blocks {
            let output = shell(&folder, &program, &block.commands)?;
            for problem in problems(block, &output) {
                println!("{name}:{}: {problem}", block.line);
                (good, faults) = (false, faults + 1);
            }
            if !output.ended_well {
                break;
            }
        }
        let verdict = if good { "good" } else { "BAD" };
        println!(
            "{name}: {} blocks, {:.0} s, {verdict}",
            blocks.len(),
            start.elapsed().as_secs_f64()
        );
    }
    println!("book: {faults} problems");
    Ok(faults == 0)
}

/// The folder of the program, built in release.
fn build(root: &Path) -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(["build", "--release", "--locked", "--package", "femdem"])
        .current_dir(root)
        .status()
        .context("cannot start cargo")?;
    ensure!(status.success(), "the program was not built");
    Ok(xtask::target_folder(root).join("release"))
}

/// README.md and the Markdown files of `docs`.
fn pages(root: &Path) -> Result<Vec<PathBuf>> {
    let mut found = vec![root.join("README.md")];
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in
            fs::read_dir(&folder).with_context(|| format!("cannot read {}", folder.display()))?
        {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// The `sh` blocks of a page, each with the `text` block that is the next thing after it.
fn blocks(text: &str) -> Vec<Block> {
    let mut found: Vec<Block> = Vec::new();
    let mut kind = None::<String>;
    let mut follows = false;
    for (line, number) in text.lines().zip(1..) {
        if let Some(mark) = line.trim().strip_prefix("```") {
            kind = match kind {
                Some(_) => None,
                None => Some(mark.to_owned()),
            };
            match kind.as_deref() {
                Some("sh") => {
                    found.push(Block {
                        line: number + 1,
                        commands: String::new(),
                        printed: Vec::new(),
                    });
                    follows = true;
                }
                Some("text") | None => {}
                Some(_) => follows = false,
            }
            continue;
        }
        match (kind.as_deref(), found.last_mut()) {
            (Some("sh"), Some(block)) => block.commands += &format!("{line}\n"),
            (Some("text"), Some(block)) if follows && !["", "..."].contains(&line.trim()) => {
                block.printed.push(line.trim().to_owned());
            }
            (None, _) if !line.trim().is_empty() => follows = false,
            _ => {}
        }
    }
    found.retain(|block| {
        !block
            .commands
            .lines()
            .any(|line| line.starts_with("cargo "))
    });
    found
}

/// An empty folder for a page, with what commands read.
fn playground(root: &Path, name: &str) -> Result<PathBuf> {
    let folder = root.join(PLAYGROUND).join(name.replace(['/', '.'], "-"));
    if folder.is_dir() {
        fs::remove_dir_all(&folder)
            .with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    for input in INPUTS {
        let to = folder.join(input);
        fs::create_dir_all(&to).with_context(|| format!("cannot make {}", to.display()))?;
        for entry in
            fs::read_dir(root.join(input)).with_context(|| format!("cannot read {input}"))?
        {
            let path = entry?.path();
            if let Some(file) = path.file_name().filter(|_| path.is_file()) {
                fs::copy(&path, to.join(file))
                    .with_context(|| format!("cannot copy {}", path.display()))?;
            }
        }
    }
    Ok(folder)
}

/// What commands did.
#[derive(Debug)]
struct Ran {
    ended_well: bool,
    text: String,
}

/// Runs commands in a folder by a shell that stops at the first failure.
fn shell(folder: &Path, program: &Path, commands: &str) -> Result<Ran> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(
        std::iter::once(program.to_owned()).chain(std::env::split_paths(&path)),
    )
    .context("the folder of the program cannot be in PATH")?;
    let output = Command::new("sh")
        .args(["-eu", "-c", commands])
        .env("PATH", path)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .context("cannot start sh")?;
    let text = [output.stdout, output.stderr].concat();
    Ok(Ran {
        ended_well: output.status.success(),
        text: String::from_utf8_lossy(&text).into_owned(),
    })
}

/// What a block should have done and did not.
fn problems(block: &Block, ran: &Ran) -> Vec<String> {
    if !ran.ended_well {
        let last: Vec<&str> = ran.text.lines().rev().take(5).collect();
        let told: Vec<&str> = last.into_iter().rev().collect();
        return vec![format!("the commands failed:\n{}", told.join("\n"))];
    }
    let lines: Vec<&str> = ran.text.lines().map(str::trim).collect();
    let missing = block
        .printed
        .iter()
        .filter(|line| !lines.contains(&line.as_str()));
    missing.map(|line| format!("not printed: {line}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# A\n\n```sh\necho a\n```\n\n```text\n  a\n...\n```\n\nWords.\n\n```text\nno output\n```\n\n\
                        ```sh\ncargo test\n```\n\n```toml\nx = 1\n```\n";

    #[test]
    fn a_text_block_right_after_commands_is_what_they_print() {
        let wanted = Block {
            line: 4,
            commands: "echo a\n".to_owned(),
            printed: vec!["a".to_owned()],
        };
        assert_eq!(blocks(PAGE), [wanted]);
    }

    #[test]
    fn what_fails_and_what_is_not_printed_is_told() {
        let here = Path::new(".");
        let block = |commands: &str| Block {
            line: 1,
            commands: commands.to_owned(),
            printed: vec!["a b".to_owned()],
        };
        for (commands, count) in [
            ("echo ' a b'", 0),
            ("echo a", 1),
            ("echo 'a b'; false; true", 1),
        ] {
            let block = block(commands);
            let ran = shell(here, here, commands).unwrap();
            assert_eq!(problems(&block, &ran).len(), count, "{commands}");
        }
    }
}
