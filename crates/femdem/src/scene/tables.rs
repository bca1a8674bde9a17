//! Keys of scenes of `femdem run` in scenes of `femdem pack`: the tables `contact` and `medium`, and words of earlier versions.

use std::path::Path;

use serde::Deserialize;
use toml::{Table, Value};

use super::Scene;
use crate::{Error, toml_file};

/// Tables whose keys a pack has without them, and these keys.
const TABLES: [(&str, &[&str]); 2] = [
    (
        "contact",
        &[
            "penalty",
            "penetration",
            "friction",
            "wall-friction",
            "rolling-friction",
            "cohesion",
            "adhesion-energy",
            "liquid-bridge",
            "damping",
            "tangential-ratio",
            "tangential-damping",
        ],
    ),
    ("medium", &["drag", "local-damping"]),
];

/// Keys of earlier versions, and the present ones.
const RENAMED: [(&str, &str); 1] = [("tangential-stiffness", "tangential-ratio")];

/// Reads a scene; `path` is what the error names. Returns what to say about words of earlier versions.
pub(super) fn parse(text: &str, path: &Path) -> Result<(Scene, Vec<String>), Error> {
    let fault = |message: String| Error::Scene {
        path: path.to_path_buf(),
        message,
    };
    let Ok(mut table) = text.parse::<Table>() else {
        // The fault, with its line.
        return Ok((toml_file::parse(text, path)?, Vec::new()));
    };
    let mut said = Vec::new();
    let mut changed = false;
    for (name, keys) in TABLES {
        let Some(value) = table.remove(name) else {
            continue;
        };
        let Value::Table(inner) = value else {
            return Err(fault(format!(
                "{name} must be a table, as in {name}.friction = 0.4"
            )));
        };
        changed = true;
        for (key, value) in inner {
            if !keys.contains(&key.as_str()) {
                return Err(fault(format!(
                    "unknown field `{key}` in {name}, expected one of `{}`",
                    keys.join("`, `")
                )));
            }
            if table.insert(key.clone(), value).is_some() {
                return Err(fault(format!(
                    "{key} and {name}.{key} are the same: give one of the two"
                )));
            }
        }
    }
    for (old, new) in RENAMED {
        let Some(value) = table.remove(old) else {
            continue;
        };
        changed = true;
        if table.insert(new.to_owned(), value).is_some() {
            return Err(fault(format!("{old} and {new} are the same: give {new}")));
        }
        said.push(format!("{}: {old} is now called {new}", path.display()));
    }
    if !changed {
        // By the text, so that faults have their line.
        return Ok((toml_file::parse(text, path)?, said));
    }
    let scene = Scene::deserialize(table).map_err(|error| fault(error.to_string()))?;
    Ok((scene, said))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(Scene, Vec<String>), String> {
        parse(text, Path::new("a.toml")).map_err(|error| error.to_string())
    }

    /// The tables of a scene of a run, and numbers and vectors for gravity.
    #[test]
    fn keys_of_runs_are_keys_of_packs() {
        let flat = read("friction = 0.4\ntangential-ratio = 1.2\ntangential-damping = 0.3\ndrag = \"8/s\"\ngravity = 1.62").unwrap();
        let tables = "gravity = [0, 0, -1.62]\ncontact.friction = 0.4\n[medium]\ndrag = \"8/s\"\n";
        let tables =
            format!("contact.tangential-ratio = 1.2\ncontact.tangential-damping = 0.3\n{tables}");
        assert_eq!(read(&tables).unwrap(), flat);
        assert!(
            read("friction = 0.4\ncontact.friction = 0.4")
                .unwrap_err()
                .contains("are the same")
        );
        assert!(read("contact = 3").unwrap_err().contains("must be a table"));
        for (text, key) in [
            (
                "contact.wall-response = \"rigid\"",
                "`wall-response` in contact",
            ),
            ("contact.count = 3", "`count` in contact"),
            ("contact.drag = \"8/s\"", "`drag` in contact"),
            ("medium.friction = 0.4", "`friction` in medium"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(key), "{message}");
        }
        assert!(
            read("gravity = [0, 1, -9]")
                .unwrap_err()
                .contains("not along -z")
        );
        assert!(
            read("drag = 0.6")
                .unwrap_err()
                .contains("0.6/fall in sqrt(g/d)")
        );
    }

    #[test]
    fn old_words_are_read_and_said() {
        let (scene, said) = read("tangential-stiffness = 1.6").unwrap();
        assert_eq!(scene.tangential_ratio, 1.6);
        assert_eq!(
            said,
            ["a.toml: tangential-stiffness is now called tangential-ratio"]
        );
        assert!(read("tangential-stiffness = 1.6\ntangential-ratio = 1.6").is_err());
        assert!(read("").unwrap().1.is_empty());
    }
}
