//! Bodies of a scenario.

use std::path::PathBuf;

use femdem_fem::element::Element;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::shapes::Shape;
use femdem_mesh::{Pose, Rotation, Vector3};
use femdem_pack::{body_stream, random_rotation};
use serde::{Deserialize, Serialize};

use super::{BoundaryEntry, MotionEntry, RegionEntry, RotationEntry};
use crate::Error;
use crate::error::wrong;
use crate::scene::{Unit as LengthUnit, in_metres};

/// How a body responds to forces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Behaviour {
    /// Moves as a whole.
    #[default]
    Rigid,
    /// Strains by its material.
    Deformable,
    /// Strains, and cracks by the fracture of its material.
    Breakable,
    /// Rigid far from its strength, breakable near it.
    Adaptive,
}

impl Behaviour {
    /// Whether it always strains.
    #[must_use]
    pub fn deforms(self) -> bool {
        matches!(self, Self::Deformable | Self::Breakable)
    }

    /// Whether it has tetrahedra whatever its shape: it strains, at least at times.
    #[must_use]
    pub fn is_meshed(self) -> bool {
        self != Self::Rigid
    }

    /// Whether it may crack.
    #[must_use]
    pub fn breaks(self) -> bool {
        matches!(self, Self::Breakable | Self::Adaptive)
    }
}

/// Kinds of elements, as in files.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Element", rename_all = "kebab-case")]
enum ElementName {
    T4,
    T4NodalPressure,
    T10,
    T10Fbar,
}

/// Where the tetrahedra of a deformable sphere are finer.
///
/// The nodes of the skin are put on the sphere, and all are moved by the conformal map of the ball onto itself
/// that moves them towards a point of the sphere: edges there become shorter by the factor `ratio`, those
/// opposite longer by the same factor, and shapes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FocusEntry {
    /// Direction of the point from the centre, of any length, in the coordinates of the shape.
    pub direction: [f64; 3],
    /// Length of edges without focus over that at the point, 1 to 10.
    pub ratio: f64,
}

/// Copies of a body on a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Copies {
    /// Number along x, y and z.
    pub count: [u32; 3],
    /// Distance between neighbours along x, y and z \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub spacing: [f64; 3],
    /// Seed of random orientations; `None`: all are turned as the first.
    #[serde(default)]
    pub seed: Option<u64>,
    /// Turn of the lattice about the first body; `None`: it stands along the axes of the world.
    #[serde(default)]
    pub rotation: Option<RotationEntry>,
    /// Whether every other row is shifted by half a spacing along x, and every other layer by half a spacing along x and y.
    #[serde(default)]
    pub stagger: bool,
}

impl Copies {
    /// Places from the first body, x varying fastest, m.
    fn places(&self) -> Result<impl Iterator<Item = Vector3>, Error> {
        let turn = self.rotation.as_ref().map(RotationEntry::rotation);
        let turn = turn.unwrap_or(Ok(Rotation::identity()))?;
        let spacing = Vector3::from(self.spacing);
        let stagger = if self.stagger { 0.5 } else { 0.0 };
        let [nx, ny, nz] = self.count;
        let cells =
            (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
        Ok(cells.map(move |cell| {
            let [i, j, k] = cell.map(f64::from);
            let odd = |n: u32| stagger * f64::from(n % 2);
            let steps = Vector3::new(i + odd(cell[1]) + odd(cell[2]), j + odd(cell[2]), k);
            turn * steps.component_mul(&spacing)
        }))
    }

    /// Refuses copies with invalid spacing, or all at one place.
    fn check_spacing(&self) -> Result<(), Error> {
        for (count, spacing) in self.count.iter().zip(&self.spacing) {
            if !spacing.is_finite() || (*count > 1 && *spacing == 0.0) {
                return Err(wrong(
                    "copies.spacing",
                    &format!("{:?}", self.spacing),
                    "finite lengths in m, and other than 0 along an axis with several copies",
                ));
            }
        }
        Ok(())
    }
}

/// Largest number of copies of a body.
const MOST_COPIES: u128 = 1_000_000;

/// A body, or a lattice of copies of it, described by exactly one of `shape`, `mesh` and `block`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct BodyEntry {
    /// Name, as it appears in results; empty: that of the shape.
    pub name: String,
    /// Parametric shape, such as "cube" or "sphere:level=3", or path of a surface file.
    pub shape: Option<String>,
    /// Path of a Gmsh file with tetrahedra.
    pub mesh: Option<PathBuf>,
    /// Numbers of cells along x, y and z of a block of tetrahedra, six per cell, about the origin; `sides` is
    /// its size.
    pub block: Option<[u32; 3]>,
    /// Sides of the block \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub sides: Option<[f64; 3]>,
    /// Circumscribed diameter of `shape` \[m\]; without it the body of a file has the file's size.
    #[serde(deserialize_with = "in_metres")]
    pub diameter: Option<f64>,
    /// Size of a parametric shape by its own measure \[m\], instead of `diameter`.
    #[serde(deserialize_with = "in_metres")]
    pub size: Option<f64>,
    /// Unit of the coordinates in files.
    pub unit: LengthUnit,
    /// Whether small faults of a surface file are mended.
    pub repair: bool,
    /// Material, by name.
    pub material: String,
    /// Parts of a deformable body made of other materials; where several overlap, the last one counts.
    pub region: Vec<RegionEntry>,
    /// How it responds.
    pub behaviour: Behaviour,
    /// Elements of a deformable body.
    #[serde(with = "ElementName")]
    pub element: Element,
    /// Target length of the edges of the tetrahedra, in circumscribed diameters. `None`: a fifth for deformable
    /// bodies, by the shape for rigid ones that are not convex.
    pub mesh_size: Option<f64>,
    /// Where the tetrahedra of a deformable sphere are finer.
    pub focus: Option<FocusEntry>,
    /// Contact stiffness of a deformable body, κ h/E: the modulus of its contact foundation times the
    /// edge length of its skin over Young's modulus. `None`: 10 where anything in the scene moves as prescribed, 1 elsewhere.
    pub contact_ratio: Option<f64>,
    /// Whether a deformable body may touch itself; `None`: yes.
    pub self_contact: Option<bool>,
    /// Mass is added to the elements of a deformable body whose critical step is shorter than this \[s\], just
    /// enough to raise it to this value; inertia and weight grow with it. `None`: no mass is added.
    pub mass_scaling: Option<f64>,
    /// Where the shape's origin lies \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub position: [f64; 3],
    /// Rotation of the body about the shape's origin.
    pub rotation: Option<RotationEntry>,
    /// Velocity of the centroid \[m/s\].
    pub velocity: [f64; 3],
    /// Angular velocity about the centroid \[rad/s\].
    pub spin: [f64; 3],
    /// Copies on a lattice from `position` on.
    pub copies: Option<Copies>,
    /// Path of a table of poses, with a row for each copy, instead of `position`, `rotation` and `copies`.
    pub poses: Option<PathBuf>,
    /// Prescribed motion of a rigid body, whatever touches it.
    pub motion: Option<MotionEntry>,
    /// Boundary conditions of a deformable body.
    pub boundary: Vec<BoundaryEntry>,
}

impl BodyEntry {
    /// Refuses keys that have no effect on such a body.
    pub(super) fn refuse_strangers(&self) -> Result<(), Error> {
        self.refuse_by_behaviour()?;
        self.refuse_unbreakable()?;
        self.refuse_unadaptive()?;
        self.refuse_by_source()?;
        self.refuse_beside_poses()?;
        let seeded = self.copies.as_ref().is_some_and(|c| c.seed.is_some());
        if seeded && self.rotation.is_some() {
            return Err(wrong(
                "rotation",
                "given",
                "copies with a seed are turned by that alone: take one of the two out",
            ));
        }
        let moves = [
            ("velocity", self.velocity != [0.0; 3]),
            ("spin", self.spin != [0.0; 3]),
        ];
        for (name, given) in moves {
            if given && self.motion.is_some() {
                return Err(wrong(
                    name,
                    "given",
                    "a body with a motion moves by that alone: take one of the two out",
                ));
            }
        }
        Ok(())
    }

    fn refuse_by_behaviour(&self) -> Result<(), Error> {
        let deforms = self.behaviour.deforms();
        let is_meshed = self.behaviour.is_meshed();
        let of_deformable = [
            ("boundary", !self.boundary.is_empty()),
            ("region", !self.region.is_empty()),
            ("contact-ratio", self.contact_ratio.is_some()),
            ("self-contact", self.self_contact.is_some()),
            ("mass-scaling", self.mass_scaling.is_some()),
            ("focus", self.focus.is_some()),
            ("element", self.element != Element::default()),
        ];
        for (name, given) in of_deformable {
            if given && !is_meshed {
                return Err(wrong(
                    name,
                    "given",
                    "a rigid body has none: add behaviour = \"deformable\", or take it out",
                ));
            }
        }
        if deforms && self.motion.is_some() {
            return Err(wrong(
                "motion",
                "given",
                "a deformable body has none: move nodes by a [[body.boundary]]",
            ));
        }
        Ok(())
    }

    fn refuse_beside_poses(&self) -> Result<(), Error> {
        let others = [
            ("position", self.position != [0.0; 3]),
            ("rotation", self.rotation.is_some()),
            ("copies", self.copies.is_some()),
        ];
        match others
            .iter()
            .find(|(_, given)| *given && self.poses.is_some())
        {
            Some((name, _)) => Err(wrong(
                name,
                "given",
                "the table of `poses` says where the bodies are: take one of the two out",
            )),
            None => Ok(()),
        }
    }

    /// Refuses keys that belong to another way of describing the body.
    fn refuse_by_source(&self) -> Result<(), Error> {
        let of_shape = [
            ("diameter", self.diameter),
            ("size", self.size),
            ("mesh-size", self.mesh_size),
        ];
        for (name, value) in of_shape {
            if let Some(value) = value.filter(|_| self.shape.is_none()) {
                return Err(wrong(name, &value.to_string(), "give it with shape only"));
            }
        }
        let reads_surface = self.shape.is_some() && !self.is_parametric();
        if self.repair && !reads_surface {
            return Err(wrong(
                "repair",
                "true",
                "give it with a shape from a surface file only: nothing else is mended",
            ));
        }
        if self.unit != LengthUnit::default() && !reads_surface && self.mesh.is_none() {
            return Err(wrong(
                "unit",
                "given",
                "give it with a file only: other lengths are in m",
            ));
        }
        if self.sides.is_some() && self.block.is_none() {
            return Err(wrong("sides", "given", "give sides with block only"));
        }
        Ok(())
    }

    /// Whether the shape is one by name.
    pub(super) fn is_parametric(&self) -> bool {
        let shape = self.shape.as_ref();
        shape.is_some_and(|text| text.parse::<Shape>().is_ok())
    }

    /// Poses of the body and its copies on a lattice.
    pub(super) fn lattice(&self) -> Result<Vec<Pose>, Error> {
        let turn = self.rotation.as_ref().map(RotationEntry::rotation);
        let rotation = turn.unwrap_or(Ok(Rotation::identity()))?;
        if !self.position.iter().all(|x| x.is_finite()) {
            return Err(wrong(
                "position",
                &format!("{:?}", self.position),
                "three finite numbers, in m",
            ));
        }
        let origin = Vector3::from(self.position);
        let Some(copies) = &self.copies else {
            return Ok(vec![Pose::from_parts(origin.into(), rotation)]);
        };
        let [nx, ny, nz] = copies.count;
        // The product of three 32-bit numbers has up to 96 bits.
        let count = copies.count.map(u128::from).iter().product::<u128>();
        if !(1..=MOST_COPIES).contains(&count) {
            return Err(wrong(
                "copies.count",
                &format!("{nx} x {ny} x {nz}"),
                "1 to 1,000,000 copies",
            ));
        }
        copies.check_spacing()?;
        let pose = |(number, place): (u32, Vector3)| {
            let at = origin + place;
            let own = |seed| random_rotation(&mut body_stream(seed, number));
            Pose::from_parts(Translation3::from(at), copies.seed.map_or(rotation, own))
        };
        Ok((0..).zip(copies.places()?).map(pose).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two layers of an armour on a slope: shifted by half a spacing, and turned with it.
    #[test]
    fn copies_stand_along_a_slope_in_staggered_layers() {
        let text = "position = [1, 0, 0]\ncopies = { count = [2, 2, 2], spacing = [2, 1, 1], stagger = true, \
                    rotation = { axis = [0, 1, 0], angle = -90 } }";
        let entry: BodyEntry = toml::from_str(text).unwrap();
        let poses = entry.lattice().unwrap();
        // The lattice's x points up, and its z backwards.
        let wanted = [
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 2.0],
            [1.0, 1.0, 1.0],
            [1.0, 1.0, 3.0],
            [0.0, 0.5, 1.0],
            [0.0, 0.5, 3.0],
            [0.0, 1.5, 2.0],
            [0.0, 1.5, 4.0],
        ];
        assert_eq!(poses.len(), wanted.len());
        for (pose, place) in poses.iter().zip(wanted) {
            let apart = pose.translation.vector - Vector3::from(place);
            assert!(apart.norm() < 1e-12, "{pose:?} {place:?}");
        }
    }

    #[test]
    fn copies_stand_on_their_lattice_and_turn_by_their_seed() {
        let text =
            "position = [1, 2, 3]\ncopies = { count = [2, 1, 3], spacing = [0.5, 0, 2], seed = 4 }";
        let entry: BodyEntry = toml::from_str(text).unwrap();
        let poses = entry.lattice().unwrap();
        let places: Vec<[f64; 3]> = poses.iter().map(|p| p.translation.vector.into()).collect();
        let wanted = [3.0, 5.0, 7.0].map(|z| [[1.0, 2.0, z], [1.5, 2.0, z]]);
        assert_eq!(places, wanted.concat());
        let turned = |a: usize, b: usize| poses[a].rotation.angle_to(&poses[b].rotation);
        assert!((1..6).all(|k| turned(0, k) > 1e-3));
        assert_eq!(entry.lattice().unwrap(), poses);
    }

    /// The product of the first is 982427 modulo 2^64.
    #[test]
    fn too_many_copies_are_refused_by_their_number() {
        for count in [
            "1614897093, 1331334203, 2246389421",
            "4294967295, 4294967295, 4294967295",
            "1000, 1000, 2",
            "3, 0, 2",
        ] {
            let text = format!("copies = {{ count = [{count}], spacing = [1, 1, 1] }}");
            let entry: BodyEntry = toml::from_str(&text).unwrap();
            let message = entry.lattice().unwrap_err().to_string();
            assert!(
                message.contains(&count.replace(", ", " x "))
                    && message.contains("1 to 1,000,000 copies"),
                "{message}"
            );
        }
    }

    #[test]
    fn elements_are_called_as_the_other_keys_are() {
        let entry: BodyEntry = toml::from_str("element = \"t4-nodal-pressure\"").unwrap();
        assert_eq!(entry.element, Element::T4NodalPressure);
        let message = toml::from_str::<BodyEntry>("element = \"T4\"")
            .unwrap_err()
            .to_string();
        assert!(message.contains("t10-fbar"), "{message}");
    }
}
