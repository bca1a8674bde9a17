//! Shapes as text.

use super::Shape;
use crate::MeshError;
use crate::catalogue::CatalogueShape;
use std::fmt;
use std::str::FromStr;

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parameters: Vec<String> = self
            .parameters()
            .iter()
            .filter(|p| f.alternate() || p.value != p.default)
            .map(|p| format!("{}={}", p.name, p.value))
            .collect();
        f.write_str(&self.name())?;
        if !parameters.is_empty() {
            write!(f, ":{}", parameters.join(","))?;
        }
        Ok(())
    }
}

impl FromStr for Shape {
    type Err = MeshError;

    fn from_str(text: &str) -> Result<Self, MeshError> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let mut shape = named(name)?;
        let mut given: Vec<&str> = Vec::new();
        for parameter in parameters.split(',').filter(|p| !p.trim().is_empty()) {
            let (key, value) = parameter.split_once('=').unwrap_or((parameter, ""));
            let (key, value) = (key.trim(), value.trim());
            shape.set(key, value)?;
            if given.contains(&key) {
                return Err(MeshError::UnknownParameter {
                    shape: shape.name(),
                    parameter: format!("{key} (a second time)"),
                    allowed: "each once".to_owned(),
                });
            }
            given.push(key);
        }
        shape.family().check()?;
        Ok(shape)
    }
}

/// Other names of shapes, and what they stand for.
const ALIASES: [(&str, &str); 6] = [
    ("brick", "box"),
    ("quadrilobe", "lobed:lobes=4"),
    ("raschig", "hollow_cylinder"),
    ("rock", "boulder"),
    ("stone", "boulder"),
    ("trilobe", "lobed:lobes=3"),
];

impl Shape {
    /// Other names that are understood, each with the name and the settings that it stands for.
    pub fn aliases() -> &'static [(&'static str, &'static str)] {
        &ALIASES
    }
}

/// The shape of a name with default parameters.
fn named(name: &str) -> Result<Shape, MeshError> {
    let plain = |s: &str| s.trim().to_ascii_lowercase().replace([' ', '-'], "_");
    let wanted = plain(name);
    if let Some((_, text)) = ALIASES.iter().find(|(alias, _)| *alias == wanted) {
        return text.parse();
    }
    if let Some(shape) = Shape::all()
        .into_iter()
        .find(|s| plain(&s.name()) == wanted)
    {
        return Ok(shape);
    }
    name.parse::<CatalogueShape>()
        .map(Shape::from)
        .map_err(|_| {
            let families: Vec<String> = Shape::all().iter().map(Shape::name).collect();
            MeshError::UnknownFamily {
                name: name.chars().take(80).collect(),
                families: families.join(", "),
            }
        })
}

impl TryFrom<String> for Shape {
    type Error = MeshError;

    fn try_from(text: String) -> Result<Self, MeshError> {
        text.parse()
    }
}

impl From<Shape> for String {
    fn from(shape: Shape) -> Self {
        format!("{shape:#}")
    }
}
