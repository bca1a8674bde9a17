//! Scenes of several stages: each is a run of its own that starts from the end of the one before it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::Scenario;
use crate::Error;

/// A stage of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// Its name, which is that of its folder, too.
    pub name: String,
    /// The scene with the stage laid over it.
    pub scenario: Scenario,
}

/// The key of the stages.
const KEY: &str = "stage";

impl Stage {
    /// The stages of a scene file, in their order; none if it has no `[[stage]]`. Their folders are in `out`, or in that
    /// of the scene.
    ///
    /// # Errors
    ///
    /// [`Error::Read`]; [`Error::Scene`] if the text is no scene, if a stage lacks a name or has one twice, or one that
    /// is no name of a folder, or if the scene with a stage laid over it is none.
    pub fn read(path: impl AsRef<Path>, out: Option<&Path>) -> Result<Vec<Self>, Error> {
        let path = path.as_ref();
        Self::parse(&crate::toml_file::text(path)?, path, out)
    }

    /// The same from text.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] as above.
    pub fn from_toml(text: &str, out: Option<&Path>) -> Result<Vec<Self>, Error> {
        Self::parse(text, Path::new("scenario"), out)
    }

    fn parse(text: &str, path: &Path, out: Option<&Path>) -> Result<Vec<Self>, Error> {
        let refuse = |message: String| Error::Scene {
            path: path.to_path_buf(),
            message,
        };
        // What is no TOML is refused, with its place, by who reads the scene.
        let Ok(mut base) = text.parse::<Table>() else {
            return Ok(Vec::new());
        };
        let Some(stages) = base.remove(KEY) else {
            return Ok(Vec::new());
        };
        let Value::Array(stages) = stages else {
            return Err(refuse(format!("`{KEY}` must be a list: write [[{KEY}]]")));
        };
        let own = base.get("out").and_then(Value::as_str).map(PathBuf::from);
        let out = out.map(Path::to_path_buf).or(own);
        let out = out.unwrap_or_else(|| Scenario::default().out);
        let mut names = BTreeSet::new();
        let mut all: Vec<Self> = Vec::new();
        for (k, stage) in stages.into_iter().enumerate() {
            let Value::Table(mut over) = stage else {
                return Err(refuse(format!(
                    "stage {k} must be a table: write [[{KEY}]]"
                )));
            };
            let name = match over.remove("name") {
                Some(Value::String(name)) if is_plain(&name) => name,
                other => {
                    let found =
                        other.map_or("it has none".to_owned(), |name| format!("not {name}"));
                    return Err(refuse(format!(
                        "stage {k} needs a `name` of letters, digits, - and _, of which its folder is made; {found}"
                    )));
                }
            };
            if !names.insert(name.clone()) {
                return Err(refuse(format!("two stages have the name {name:?}")));
            }
            for key in ["out", "from"] {
                if over.contains_key(key) {
                    return Err(refuse(format!(
                        "stage {name:?} has `{key}`: a stage starts from the one before it, and its folder is in that of \
                         the scene; give `{key}` at the top, for all"
                    )));
                }
            }
            let mut scene = base.clone();
            lay_over(&mut scene, over);
            let mut scenario =
                Scenario::from_toml(&toml::to_string(&scene).map_err(|e| refuse(e.to_string()))?)
                    .map_err(|error| refuse(format!("with stage {name:?} laid over: {error}")))?;
            if let Some(before) = all.last() {
                scenario.from = Some(before.scenario.out.clone());
            }
            scenario.out = out.join(&name);
            all.push(Self { name, scenario });
        }
        Ok(all)
    }
}

fn is_plain(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    !name.is_empty() && name.chars().all(plain)
}

/// Lays a table over another: tables key by key, lists of things with names (walls, bodies, sources and others) thing by
/// thing, all else as a whole.
fn lay_over(base: &mut Table, over: Table) {
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            (Some(Value::Array(below)), Value::Array(above))
                if !above.is_empty() && above.iter().all(has_name) =>
            {
                for thing in above {
                    let known = below.iter_mut().find(|old| name(old) == name(&thing));
                    match (known, thing) {
                        (Some(Value::Table(old)), Value::Table(new)) => lay_over(old, new),
                        (_, thing) => below.push(thing),
                    }
                }
            }
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

fn name(thing: &Value) -> Option<&str> {
    thing.get("name").and_then(Value::as_str)
}

fn has_name(thing: &Value) -> bool {
    name(thing).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_stage_says_is_laid_over_the_scene() {
        let text = |text: &str| text.parse::<Table>().unwrap();
        let mut scene = text(
            "duration = 1\ncontact = { friction = 0.5, damping = 0.3 }\nremove = [\"a\"]\n\
             wall = [{ name = \"lid\", opens = 1 }, { name = \"floor\" }]\nsource = [{ name = \"feed\" }]",
        );
        lay_over(
            &mut scene,
            text(
                "duration = 2\ncontact = { friction = 0.1 }\nremove = [\"b\", \"c\"]\n\
                 wall = [{ name = \"lid\", material = \"steel\" }, { name = \"ram\" }]\nsource = []",
            ),
        );
        let want = text(
            "duration = 2\ncontact = { friction = 0.1, damping = 0.3 }\nremove = [\"b\", \"c\"]\n\
             wall = [{ name = \"lid\", opens = 1, material = \"steel\" }, { name = \"floor\" }, { name = \"ram\" }]\n\
             source = []",
        );
        assert_eq!(scene, want);
    }
}
