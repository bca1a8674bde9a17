//! The container of a scene.

use std::f64::consts::FRAC_PI_4;
use std::fmt;
use std::path::Path;

use femdem_pack::{Container, MeshContainer, PackSpec};

use super::bodies::file_stem;
use super::{
    ContainerKind, DEFAULT_CONE, DEFAULT_OUTLET, Footprint, Length, Scene, ShapeNote, surface,
};
use crate::Error;

/// Packing density assumed for the automatic size of a container.
const EXPECTED_DENSITY: f64 = 0.6;

/// Least automatic width, in d.
const LEAST_WIDTH: f64 = 3.0;

/// The container for the bodies of `spec`; walls from a file add how they were read.
///
/// # Errors
/// [`Error::Option`] without a file for the walls, [`Error::Mesh`] or [`Error::Pack`] for one that
/// cannot be used.
pub(super) fn container(
    scene: &Scene,
    spec: &PackSpec,
    notes: &mut Vec<ShapeNote>,
) -> Result<Container, Error> {
    let diameter = spec.diameter();
    let pack = f64::from(spec.count) * spec.mean_volume() / diameter.powi(3) / EXPECTED_DENSITY;
    // Three of the largest bodies fit beside each other.
    let least = if scene.is_graded() {
        LEAST_WIDTH * spec.largest_diameter() / diameter
    } else {
        LEAST_WIDTH
    };
    let level_width = |volume| level_width(volume).max(least);
    let round = || {
        let width = level_width(pack / FRAC_PI_4);
        let width = scene.cylinder.unwrap_or(Length::Diameters(width));
        width.metres(diameter)
    };
    let footprint = || {
        let side = level_width(pack);
        scene.r#box.unwrap_or(Footprint::diameters(side, side))
    };
    refuse_less_than_a_body(scene)?;
    Ok(match scene.container_kind()? {
        ContainerKind::Walls => {
            let path = scene.walls.as_ref().ok_or(Error::Option {
                name: "container",
                value: "walls".to_owned(),
                allowed: "give the surface file of the walls with --walls",
            })?;
            let (surface, report) = surface::read(path, scene.unit, scene.repair)?;
            let name = wall_name(path);
            let file = Some((path.clone(), scene.unit, report));
            notes.push(ShapeNote::new(name.clone(), file, &surface, None));
            Container::Mesh(Box::new(MeshContainer::new(name, &surface)?))
        }
        ContainerKind::Box => {
            let size = footprint();
            Container::Box {
                width: size.width.metres(diameter),
                depth: size.depth.metres(diameter),
            }
        }
        ContainerKind::Periodic => {
            let size = footprint();
            Container::Periodic {
                width: size.width.metres(diameter),
                depth: size.depth.metres(diameter),
            }
        }
        ContainerKind::Cylinder => Container::Cylinder { diameter: round() },
        ContainerKind::Silo => {
            let width = round();
            let outlet = scene.outlet.unwrap_or(DEFAULT_OUTLET).metres(diameter);
            if scene.outlet.is_none() && width > 0.0 && width <= outlet {
                return Err(Error::Option {
                    name: "cylinder",
                    value: format!("{:.4} d", width / diameter),
                    allowed: "wider than the outlet of a silo, which is 3 d unless outlet is given",
                });
            }
            Container::Silo {
                diameter: width,
                outlet,
                half_angle: scene.cone.unwrap_or(DEFAULT_CONE),
            }
        }
    })
}

/// A size of less than a body diameter is most likely meant in metres.
fn refuse_less_than_a_body(scene: &Scene) -> Result<(), Error> {
    let small = |length: Length| matches!(length, Length::Diameters(x) if x > 0.0 && x < 1.0);
    let refuse = |name, value: String| {
        Err(Error::Option {
            name,
            value,
            allowed: "at least 1, in body diameters; if metres are meant, give the unit, such as 0.3m or 0.3x0.3m",
        })
    };
    match (scene.r#box, scene.cylinder) {
        (Some(size), _) if small(size.width) || small(size.depth) => {
            refuse("box", size.to_string())
        }
        (_, Some(size)) if small(size) => refuse("cylinder", size.to_string()),
        _ => Ok(()),
    }
}

/// Height of the container's rim \[m\], if it has one.
pub(super) fn rim(scene: &Scene, diameter: f64) -> Option<f64> {
    Some(scene.r#box?.height?.metres(diameter))
}

/// The file's name without its extension, prefixed if it is the floor's name or, in contacts, would look like
/// the number of a body.
fn wall_name(path: &Path) -> String {
    let stem = file_stem(path);
    let name = stem.trim();
    if name.is_empty() || name == Container::FLOOR || name.parse::<i64>().is_ok() {
        format!("walls-{name}")
    } else {
        name.to_owned()
    }
}

/// Kinds of container in the order of preference.
const KINDS: [ContainerKind; 5] = [
    ContainerKind::Box,
    ContainerKind::Periodic,
    ContainerKind::Cylinder,
    ContainerKind::Silo,
    ContainerKind::Walls,
];

/// A given size: its key, its value, and the kinds of container that have it.
type Size = (&'static str, String, &'static [ContainerKind]);

impl Scene {
    /// The kind of container: the named one, or else the one that has the given sizes; a box without any.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] for a size that the named kind, or the kind of another size, does not have.
    pub fn container_kind(&self) -> Result<ContainerKind, Error> {
        let sizes = self.container_sizes();
        let fits = |kind: &ContainerKind| sizes.iter().all(|size| size.2.contains(kind));
        if let Some(kind) = self.container {
            return match sizes.iter().find(|size| !size.2.contains(&kind)) {
                Some(size) => Err(stray(size, "container", &kind.to_string())),
                None => Ok(kind),
            };
        }
        if let Some(kind) = KINDS.into_iter().find(fits) {
            return Ok(kind);
        }
        let apart = |a: &Size, b: &Size| !a.2.iter().any(|kind| b.2.contains(kind));
        for (n, a) in sizes.iter().enumerate() {
            if let Some(b) = sizes[n + 1..].iter().find(|b| apart(a, b)) {
                return Err(stray(b, a.0, &a.1));
            }
        }
        // Not reached: sizes that are compatible in pairs have a kind in common.
        Ok(ContainerKind::default())
    }

    /// Takes the container of `from` as far as it names one: sizes given there replace those here, and if they
    /// do not belong to the kind here, those of the old kind are dropped.
    pub fn take_container(&mut self, from: &Self) {
        let given = from.container_sizes();
        if from.container.is_none() && given.is_empty() {
            return;
        }
        let keeps = |kind: ContainerKind| {
            from.container.is_none_or(|named| named == kind)
                && given.iter().all(|size| size.2.contains(&kind))
        };
        if !self.container_kind().is_ok_and(keeps) {
            use ContainerKind::{Cylinder, Silo};
            let round = matches!(from.container_kind(), Ok(Cylinder | Silo));
            self.cylinder = self.cylinder.filter(|_| round);
            (self.container, self.r#box, self.walls) = (None, None, None);
            (self.outlet, self.cone) = (None, None);
        }
        self.container = from.container.or(self.container);
        self.r#box = from.r#box.or(self.r#box);
        self.cylinder = from.cylinder.or(self.cylinder);
        self.outlet = from.outlet.or(self.outlet);
        self.cone = from.cone.or(self.cone);
        self.walls = from.walls.clone().or_else(|| self.walls.take());
    }

    fn container_sizes(&self) -> Vec<Size> {
        use ContainerKind::{Box, Cylinder, Periodic, Silo, Walls};
        let walls = self.walls.as_ref().map(|path| path.display().to_string());
        // Before these sizes became optional, their defaults were written into scenes of all kinds.
        let counts = matches!(self.container, None | Some(Silo));
        let outlet = self.outlet.filter(|x| counts || *x != DEFAULT_OUTLET);
        let cone = self.cone.filter(|x| counts || *x != DEFAULT_CONE);
        let sizes: [(_, Option<String>, &'static [_]); 5] = [
            (
                "box",
                self.r#box.map(|size| size.to_string()),
                &[Box, Periodic],
            ),
            (
                "cylinder",
                self.cylinder.map(|size| size.to_string()),
                &[Cylinder, Silo],
            ),
            ("outlet", outlet.map(|size| size.to_string()), &[Silo]),
            ("cone", cone.map(|angle| angle.to_string()), &[Silo]),
            ("walls", walls, &[Walls]),
        ];
        let given = |(key, value, kinds)| Some((key, value?, kinds));
        sizes.into_iter().filter_map(given).collect()
    }
}

impl fmt::Display for ContainerKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Box => "box",
            Self::Periodic => "periodic",
            Self::Cylinder => "cylinder",
            Self::Silo => "silo",
            Self::Walls => "walls",
        })
    }
}

/// The error for a size that does not go with another key.
fn stray(size: &Size, key: &str, value: &str) -> Error {
    Error::Option {
        name: size.0,
        value: format!("{} beside {key} = {value}", size.1),
        allowed: "box and periodic have box; cylinder has cylinder; silo has cylinder, outlet and cone; walls has \
                  walls: leave one of the two out",
    }
}

/// Side of the cube of a volume, to the nearest half, and 3 at least.
fn level_width(volume: f64) -> f64 {
    ((2.0 * volume.cbrt()).round() / 2.0).max(LEAST_WIDTH)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> Result<ContainerKind, String> {
        let scene = Scene::from_toml(text).unwrap();
        scene.container_kind().map_err(|error| error.to_string())
    }

    #[test]
    fn sizes_tell_the_kind() {
        use ContainerKind::{Box, Cylinder, Silo, Walls};
        for (text, expected) in [
            ("", Box),
            ("box = \"4x5\"", Box),
            ("cylinder = 5", Cylinder),
            ("container = \"silo\"\ncylinder = 5", Silo),
            ("cylinder = 5\noutlet = 2", Silo),
            ("cone = 45", Silo),
            ("walls = \"none.stl\"", Walls),
            ("container = \"box\"\noutlet = 3\ncone = 30", Box),
        ] {
            assert_eq!(kind(text), Ok(expected), "{text}");
        }
        let spec = Scene::from_toml("cylinder = 5").unwrap().spec().unwrap();
        assert!(matches!(spec.container, Container::Cylinder { .. }));
        let missing = Scene::from_toml("walls = \"none.stl\"").unwrap();
        assert!(missing.spec().unwrap_err().to_string().contains("none.stl"));
    }

    #[test]
    fn sizes_that_do_not_go_together_are_named() {
        for (text, message) in [
            (
                "container = \"box\"\ncylinder = 5",
                "cylinder = 5 beside container = box",
            ),
            (
                "container = \"cylinder\"\nbox = \"4x4\"",
                "box = 4x4 beside container = cylinder",
            ),
            ("box = \"4x4\"\ncone = 45", "cone = 45 beside box = 4x4"),
            (
                "walls = \"a.stl\"\ncylinder = 5",
                "walls = a.stl beside cylinder = 5",
            ),
        ] {
            assert!(kind(text).unwrap_err().contains(message), "{text}");
        }
    }

    /// In the list of contacts a wall has a name of its own, which is no number.
    #[test]
    fn walls_from_a_file_are_told_from_the_floor_and_from_bodies() {
        for (path, name) in [
            ("a/hopper.stl", "hopper"),
            ("floor.obj", "walls-floor"),
            ("12.obj", "walls-12"),
            ("a/ -3 .obj", "walls--3"),
            ("12a.obj", "12a"),
        ] {
            assert_eq!(wall_name(Path::new(path)), name);
        }
    }

    /// What is given on top of a scene keeps what still belongs to the container, and drops the rest.
    #[test]
    fn another_container_takes_the_place_of_the_old_one() {
        for (text, over, expected) in [
            ("box = \"4x4\"", "cylinder = 5", "cylinder = 5"),
            ("cylinder = 5", "outlet = 2", "cylinder = 5\noutlet = 2"),
            (
                "cylinder = 5\noutlet = 2",
                "outlet = 1",
                "cylinder = 5\noutlet = 1",
            ),
            ("cylinder = 5\noutlet = 2", "box = \"4x4\"", "box = \"4x4\""),
            (
                "cylinder = 5\noutlet = 2",
                "container = \"cylinder\"",
                "container = \"cylinder\"\ncylinder = 5",
            ),
            ("box = \"4x4\"", "count = 3", "box = \"4x4\""),
        ] {
            let mut scene = Scene::from_toml(text).unwrap();
            scene.take_container(&Scene::from_toml(over).unwrap());
            assert_eq!(scene, Scene::from_toml(expected).unwrap(), "{text} {over}");
        }
        let mut wrong = Scene::from_toml("box = \"4x4\"\ncone = 45").unwrap();
        wrong.take_container(&Scene::default());
        assert!(wrong.container_kind().is_err());
    }
}
