//! The command that is equivalent to a scene.

use super::Scene;

impl Scene {
    /// The call of `femdem pack` that is equivalent to this scene: every option that differs from its default.
    ///
    /// ```
    /// let scene = femdem::Scene { count: 50, seed: 7, ..femdem::Scene::default() };
    /// assert_eq!(scene.command(), "femdem pack --count 50 --seed 7");
    /// ```
    #[must_use]
    pub fn command(&self) -> String {
        let table = |scene: &Self| toml::Table::try_from(scene).unwrap_or_default();
        let usual = table(&Self::default());
        let mut words = vec!["femdem pack".to_owned()];
        for (key, value) in table(self) {
            if usual.get(&key) == Some(&value) {
                continue;
            }
            match (key.as_str(), &value) {
                ("implicit", toml::Value::Boolean(false)) => words.push("--explicit".to_owned()),
                ("sleeping", _) => words.push("--awake".to_owned()),
                ("implicit", multiple) => words.push(format!("--implicit={multiple}")),
                _ => words.extend(option(&key, &value)),
            }
        }
        words.join(" ")
    }
}

/// An option with its value; a list becomes an option for each of its values, a switch has no value.
fn option(key: &str, value: &toml::Value) -> Vec<String> {
    match value {
        toml::Value::Array(list) => list.iter().flat_map(|value| option(key, value)).collect(),
        toml::Value::Boolean(true) => vec![format!("--{key}")],
        toml::Value::Boolean(false) => Vec::new(),
        toml::Value::String(text) => vec![format!("--{key} {}", quoted(text))],
        other => vec![format!("--{key} {other}")],
    }
}

/// A word for the shell, quoted where needed.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=+,@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::StepKind;
    use std::path::PathBuf;

    #[test]
    fn lists_switches_and_odd_names_have_their_forms() {
        let scene = Scene {
            shape: vec!["A10".to_owned(), "my stone's.stl".to_owned()],
            share: vec![1.0, 2.5],
            repair: true,
            sleeping: false,
            r#box: Some(crate::scene::Footprint::diameters(4.0, 5.5)),
            out: PathBuf::from("out/x"),
            ..Scene::default()
        };
        let command = scene.command();
        for part in [
            "--shape A10 --shape 'my stone'\\''s.stl'",
            "--share 1.0 --share 2.5",
            "--repair",
            " --awake",
            "--box 4x5.5",
            "--out out/x",
        ] {
            assert!(command.contains(part), "{part}: {command}");
        }
        assert!(!command.contains("--friction"), "{command}");
        for (kind, part) in [
            (StepKind::Explicit, " --explicit"),
            (StepKind::Implicit(6.0), " --implicit=6.0"),
        ] {
            let implicit = Some(kind);
            let command = Scene {
                implicit,
                ..scene.clone()
            }
            .command();
            assert!(command.contains(part), "{part}: {command}");
        }
    }
}
