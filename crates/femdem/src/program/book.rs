//! The book in `docs` against the program: its commands are understood, and its page of options is that of the
//! command line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Arg, CommandFactory, Parser};

use super::cli::{Cli, Command};

/// The folder of the workspace.
fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The Markdown files of a folder and of those in it.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(pages(&path));
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// The lines of all blocks of commands and of text, those that end in a backslash joined with the next,
/// here-documents left out.
fn code(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let (mut inside, mut until) = (false, None::<String>);
    let mut goes_on = false;
    for line in text.lines() {
        if let Some(kind) = line.trim_start().strip_prefix("```") {
            (inside, goes_on) = (["sh", "text"].contains(&kind), false);
            continue;
        }
        if let Some(end) = &until {
            if line.trim() == end {
                until = None;
            }
            continue;
        }
        if !inside {
            continue;
        }
        if let Some((_, end)) = line.split_once("<< ") {
            until = Some(end.trim_matches(['\'', ' ']).to_owned());
        }
        let (part, more) = match line.strip_suffix('\\') {
            Some(part) => (part, true),
            None => (line, false),
        };
        match lines.last_mut() {
            Some(last) if goes_on => last.push_str(part),
            _ => lines.push(part.to_owned()),
        }
        goes_on = more;
    }
    lines
}

/// The words of the commands of a line, as a shell sees them: quotes hold words together, `;`, `|`, `&` and
/// parentheses part commands, and what follows `>` or ` #` is left out.
fn commands(line: &str) -> Vec<Vec<String>> {
    let mut all = vec![Vec::new()];
    let (mut word, mut quote, mut skips) = (String::new(), None, false);
    let finish = |word: &mut String, all: &mut Vec<Vec<String>>, skips: &mut bool| {
        if !word.is_empty() {
            let done = std::mem::take(word);
            if !std::mem::take(skips) {
                all.last_mut().unwrap().push(done);
            }
        }
    };
    for letter in line.chars() {
        match (quote, letter) {
            (Some(q), l) if l == q => quote = None,
            (Some(_), l) => word.push(l),
            (None, '\'' | '"') => quote = Some(letter),
            (None, '#') if word.is_empty() => break,
            (None, ' ') => finish(&mut word, &mut all, &mut skips),
            (None, '>') => {
                finish(&mut word, &mut all, &mut skips);
                skips = true;
            }
            (None, ';' | '|' | '&' | '(' | ')') => {
                finish(&mut word, &mut all, &mut skips);
                all.push(Vec::new());
            }
            (None, l) => word.push(l),
        }
    }
    finish(&mut word, &mut all, &mut skips);
    all.retain(|words| words.first().is_some_and(|first| first == "femdem"));
    all
}

/// Why a command is not understood.
fn refusal(words: &[String]) -> Option<String> {
    let is_pattern = |word: &String| word.chars().all(|c| c.is_ascii_uppercase()) && word.len() > 3;
    let words: Vec<&String> = words
        .iter()
        .filter(|w| *w != "..." && !is_pattern(w))
        .collect();
    if words.len() < 2 {
        return None;
    }
    match Cli::try_parse_from(&words) {
        Ok(Cli {
            command: Command::Pack(args),
        }) => args.scene().err().map(|error| format!("{error:#}")),
        Ok(_) => None,
        Err(error) if error.use_stderr() => Some(error.to_string()),
        Err(_) => None,
    }
}

#[test]
fn the_commands_of_the_book_are_understood() {
    let mut files = pages(&root().join("docs"));
    files.extend(pages(&root().join("records")));
    files.push(root().join("README.md"));
    let mut count = 0;
    let mut faults = String::new();
    for file in files {
        for line in code(&fs::read_to_string(&file).unwrap()) {
            for words in commands(&line) {
                count += 1;
                // A scene that an earlier line of the page writes is not there yet.
                let is_missing = |why: &String| why.contains("cannot read");
                if let Some(why) = refusal(&words).filter(|why| !is_missing(why)) {
                    writeln!(faults, "{}: {line}\n  {why}", file.display()).unwrap();
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults}");
    assert!(count > 40, "only {count} commands found");
}

#[test]
fn lines_are_taken_apart_as_shells_do() {
    let text = "femdem x\n```sh\nfemdem pack --count 3 \\\n  --box 2x2  # two\ncat > a << 'END'\nfemdem no\nEND\n\
                femdem run a && (echo 'femdem b'; femdem run \"c d\") > e f | head\n```\n";
    let found: Vec<_> = code(text).iter().flat_map(|line| commands(line)).collect();
    let wanted = [
        vec!["femdem", "pack", "--count", "3", "--box", "2x2"],
        vec!["femdem", "run", "a"],
        vec!["femdem", "run", "c d"],
    ];
    assert_eq!(found, wanted);
    assert!(refusal(&["femdem", "pack", "--cuont", "3"].map(str::to_owned)).is_some());
}

/// How an option is written, and what it does.
fn entry(argument: &Arg) -> (String, String) {
    let values = argument.get_value_names().unwrap_or_default();
    let takes_values = argument.get_action().takes_values();
    let value = match values {
        [name, ..] if takes_values => name.to_string(),
        _ => String::new(),
    };
    let name = match (argument.get_long(), argument.get_short()) {
        (Some(long), Some(short)) => format!("--{long} {value}, -{short}"),
        (Some(long), None) => format!("--{long} {value}"),
        _ => format!("[{value}]"),
    };
    let help = argument.get_long_help().or_else(|| argument.get_help());
    let mut help = help.map(ToString::to_string).unwrap_or_default();
    let choices: Vec<_> = argument.get_possible_values();
    if takes_values && !choices.is_empty() {
        let told = choices.iter().map(|choice| match choice.get_help() {
            Some(help) => format!("`{}` ({help})", choice.get_name()),
            None => format!("`{}`", choice.get_name()),
        });
        help = format!("{help}: {}", told.collect::<Vec<_>>().join(", "));
    }
    let defaults: Vec<_> = argument.get_default_values().iter().collect();
    if takes_values && !defaults.is_empty() && !help.contains("[default") {
        let told: Vec<_> = defaults.iter().map(|d| d.to_string_lossy()).collect();
        help = format!("{help} [default: {}]", told.join(" "));
    }
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    (name.replace(" ,", ",").trim_end().to_owned(), help)
}

/// The page `docs/options.md`: options that three commands or more have in common once, then those of each.
fn page() -> String {
    let program = Cli::command();
    let mut users: BTreeMap<(String, String), BTreeSet<&str>> = BTreeMap::new();
    let hidden = ["help", "version"];
    let shown = |argument: &&Arg| !hidden.contains(&argument.get_id().as_str());
    for command in program.get_subcommands() {
        for argument in command.get_arguments().filter(shown) {
            users
                .entry(entry(argument))
                .or_default()
                .insert(command.get_name());
        }
    }
    let is_common = |key: &(String, String)| users.get(key).is_some_and(|names| names.len() > 2);
    let mut text = "# Options of the program\n\n`femdem COMMAND --help` prints the same, with the files that each \
                    command writes. This page is compared with the program by a test; `WRITE_DOCS=1 cargo test -p \
                    femdem --lib options` writes it anew.\n\n## Options of several commands\n\n"
        .to_owned();
    for (key, names) in users.iter().filter(|(key, _)| is_common(key)) {
        let names: Vec<_> = names.iter().copied().collect();
        writeln!(text, "- `{}` ({}): {}", key.0, names.join(", "), key.1).unwrap();
    }
    for command in program.get_subcommands().filter(|c| c.get_name() != "help") {
        let about = command
            .get_about()
            .map(ToString::to_string)
            .unwrap_or_default();
        writeln!(text, "\n## femdem {}\n\n{about}.\n", command.get_name()).unwrap();
        for key in command.get_arguments().filter(shown).map(entry) {
            if !is_common(&key) {
                writeln!(text, "- `{}`: {}", key.0, key.1).unwrap();
            }
        }
    }
    text
}

#[test]
fn the_page_of_options_is_that_of_the_program() {
    let path = root().join("docs/options.md");
    let wanted = page();
    if std::env::var_os("WRITE_DOCS").is_some() {
        fs::write(&path, &wanted).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap();
    assert!(
        found == wanted,
        "docs/options.md is not what the program says: WRITE_DOCS=1 cargo test -p femdem --lib options"
    );
}
