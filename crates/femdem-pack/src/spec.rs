//! The specification of a packing job.

use crate::container::Container;
use crate::error::{PackError, check, check_positive};
use crate::pair_law::PairLaw;
use crate::penalty::{CALIBRATED_DEPTH, EXPECTED_DENSITY, PackLoad, Penalty, automatic_penalty};
use crate::protocol::Protocol;
use crate::sizes::SizeClass;
use femdem_contact::{ContactParameters, Field, LiquidBridge, MaterialId};
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::tet::{self, MeshOptions, MeshReport};
use femdem_mesh::{Polyhedron, TetMesh, Vector3, shapes};
use femdem_solve::{
    ImplicitStep, Medium, ShapeId, SleepMeasure, SleepParameters, SolveError, TimeStepParameters,
    World, WorldParameters,
};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_6;

/// Circumscribed diameter of the default bodies, m.
const DEFAULT_DIAMETER: f64 = 0.02;

/// Longest time step in units of sqrt(d/g), so that falling bodies are followed well even where soft contacts
/// would allow longer steps.
const LARGEST_STEP: f64 = 0.01;

/// Damping ratio above which contacts damp well: implicit steps are then usual where the protocol suits them,
/// and bodies come to rest without a medium.
pub(crate) const LEAST_DAMPING: f64 = 0.1;

/// Allowed shares: their sums, and those of lengths and volumes weighted with them, stay finite and above 0.
const SHARES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// Least inradius over circumscribed radius of a surface that stands for a ball.
const ROUND: f64 = 0.99;

/// More bodies than this would take years and are taken for a typing error.
const MOST_BODIES: u32 = 100_000_000;

/// A shape to pack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackShape {
    /// Name, as it appears in results.
    pub name: String,
    /// The surface, in m.
    pub polyhedron: Polyhedron,
    /// Tetrahedra of the same body, in the same coordinates; a body that is not convex needs them.
    #[serde(default)]
    pub mesh: Option<TetMesh>,
    /// Whether the body is the exact ball around its surface, which is then a polyhedron to be drawn, about the origin.
    #[serde(default)]
    pub sphere: bool,
    /// Relative number of bodies of this shape in a mixture (see [`Mixing`]), from 1e-100 to 1e100.
    #[serde(default = "equal_share")]
    pub share: f64,
    /// Density of its bodies, kg/m^3; `None`: that of the job.
    #[serde(default)]
    pub density: Option<f64>,
    /// Material of its bodies, by which their contacts find the laws of pairs.
    #[serde(default)]
    pub material: MaterialId,
}

fn equal_share() -> f64 {
    1.0
}

impl PackShape {
    /// A convex shape with share 1.
    pub fn new(name: impl Into<String>, polyhedron: Polyhedron) -> Self {
        Self {
            name: name.into(),
            polyhedron,
            mesh: None,
            sphere: false,
            share: equal_share(),
            density: None,
            material: MaterialId::default(),
        }
    }

    /// An exact ball of a diameter in m, with share 1.
    ///
    /// # Errors
    /// [`PackError::Mesh`] for a diameter that is not positive and finite.
    pub fn ball(name: impl Into<String>, diameter: f64) -> Result<Self, PackError> {
        let facets = shapes::Shape::from(shapes::Sphere { level: 3 });
        Ok(Self {
            sphere: true,
            ..Self::new(name, facets.polyhedron(diameter)?)
        })
    }

    /// A shape of any closed surface, with share 1. A surface that is not convex is meshed, and the report
    /// describes the mesh.
    ///
    /// # Errors
    /// [`PackError::Mesh`] if the surface cannot be meshed as the options ask.
    pub fn of_surface(
        name: impl Into<String>,
        polyhedron: Polyhedron,
        options: &MeshOptions,
    ) -> Result<(Self, Option<MeshReport>), PackError> {
        let shape = Self::new(name, polyhedron);
        if shape.polyhedron.is_convex() {
            return Ok((shape, None));
        }
        let (mesh, report) = tet::mesh(&shape.polyhedron, options)?;
        let mesh = Some(mesh);
        Ok((Self { mesh, ..shape }, Some(report)))
    }

    /// The shape in several sizes, with the number of bodies of each as its share: for [`Mixing::Dealt`] or
    /// [`Mixing::Shuffled`], and a job of as many bodies as all its shapes have together. The size is in the names.
    ///
    /// # Errors
    /// [`PackError::Mesh`] for a size that makes the body too small or too large to be computed with.
    pub fn in_sizes(&self, sizes: &[SizeClass]) -> Result<Vec<Self>, PackError> {
        let own = self.diameter();
        let sized = |class: &SizeClass| {
            let factor = class.diameter / own;
            let mesh = self.mesh.as_ref().map(|mesh| {
                let points = mesh.points().iter().map(|p| p * factor).collect();
                TetMesh::new(points, mesh.tets().to_vec())
            });
            Ok(Self {
                name: format!("{} {}", self.name, millimetres(class.diameter)),
                polyhedron: self.polyhedron.scaled(factor)?,
                mesh: mesh.transpose()?,
                share: f64::from(class.count),
                ..self.clone()
            })
        };
        sizes.iter().map(sized).collect()
    }

    /// Volume of the body, m^3.
    pub fn volume(&self) -> f64 {
        if self.sphere {
            FRAC_PI_6 * self.diameter().powi(3)
        } else {
            self.polyhedron.mass_properties().volume
        }
    }

    /// Adds the shape to a world: with its mesh if it has one, with the body field.
    pub(crate) fn add_to(&self, world: &mut World) -> Result<ShapeId, SolveError> {
        if self.sphere {
            return world.add_sphere(&self.name, 0.5 * self.diameter());
        }
        match &self.mesh {
            Some(mesh) => world.add_mesh_shape(&self.name, &self.polyhedron, mesh, Field::Body),
            None => world.add_shape(&self.name, &self.polyhedron),
        }
    }

    /// Depth over which the field of the body rises from 0 to 1, over that of the bodies on which the automatic
    /// penalty is calibrated: contacts are stiffer in inverse proportion. 1 for convex bodies, whose shapes
    /// differ little.
    fn field_depth(&self) -> f64 {
        match self.mesh {
            Some(_) => self.rise() / (CALIBRATED_DEPTH * self.diameter()),
            None => 1.0,
        }
    }

    /// Depth over which the field of the body rises from 0 to 1, m.
    pub(crate) fn rise(&self) -> f64 {
        match &self.mesh {
            _ if self.sphere => 0.5 * self.diameter(),
            Some(mesh) => mesh.distance_to_skin().into_iter().fold(0.0, f64::max),
            None => self.polyhedron.inradius(),
        }
    }

    /// Refuses a surface that is not that of a ball about the origin.
    fn check_ball(&self) -> Result<(), PackError> {
        let radius = self.polyhedron.bounding_radius();
        let roundness = self.polyhedron.inradius() / radius;
        let off = self.polyhedron.mass_properties().centroid.coords.norm() / radius;
        check(
            "inradius over circumscribed radius of a ball's surface",
            roundness,
            roundness >= ROUND,
            "at least 0.99: a polyhedron near the ball, as PackShape::ball has it",
        )?;
        check(
            "distance of a ball's centroid from the origin over its radius",
            off,
            off <= 1e-6,
            "at most 1e-6",
        )
    }

    /// Circumscribed diameter, m: that of the smallest sphere about the centroid that contains the body.
    pub fn diameter(&self) -> f64 {
        2.0 * self.polyhedron.bounding_radius()
    }
}

/// A length as it is in names: in millimetres, to four digits.
fn millimetres(length: f64) -> String {
    let shown = 1e3 * length;
    let digits = (3.0 - shown.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{shown:.digits$}");
    let text = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    format!("{text}mm")
}

/// How the bodies of a mixture get their shapes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mixing {
    /// Each body draws its shape, with the shares as weights.
    #[default]
    Drawn,
    /// Each shape has its share of the bodies, to within one body, spread evenly over their order.
    Dealt,
    /// Each shape has its share of the bodies, to within one body, in an order that depends on the seed.
    Shuffled,
}

/// When a pack counts as settled: every body's residual (net force over the larger of its weight and its mean contact
/// force) and kinetic energy have been within the limits, with all bodies awake and no medium, at ten checks in a row over
/// sqrt(d/g), and no body has moved by more than 1e-3 d meanwhile. The last three of them at least follow explicit steps, all
/// of them if the job has no implicit steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settling {
    /// Largest allowed residual of a body.
    pub residual: f64,
    /// Largest allowed kinetic energy of a body over m g d.
    pub kinetic_energy: f64,
    /// Longest time in units of sqrt(d/g) for coming to rest once the last body has had time to fall, again for each awake
    /// relaxation, and again for the verification, all attempts together.
    pub longest: f64,
}

impl Settling {
    /// The usual limits: 0.02 of the load, 1e-6 m g d, 200 sqrt(d/g).
    pub const USUAL: Self = Self {
        residual: 0.02,
        kinetic_energy: 1e-6,
        longest: 200.0,
    };
}

impl Default for Settling {
    fn default() -> Self {
        Self::USUAL
    }
}

/// A packing job. Every field has a default: 500 truncated dodecahedra (A10) of 20 mm in a box 8
/// diameters wide, deposited in sequence with friction 0.6.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PackSpec {
    /// The shapes; at least one.
    pub shapes: Vec<PackShape>,
    /// How the bodies of a mixture get their shapes.
    pub mixing: Mixing,
    /// Number of bodies.
    pub count: u32,
    /// Density of the bodies of shapes without one of their own, kg/m^3.
    pub density: f64,
    /// Coulomb friction coefficient between bodies, and between bodies and walls where
    /// `wall_friction` is `None`.
    pub friction: f64,
    /// Coulomb friction coefficient between bodies and walls; `None`: `friction`.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction; see [`ContactParameters::rolling_friction`].
    pub rolling_friction: f64,
    /// Cohesion, Pa; see [`ContactParameters::cohesion`].
    pub cohesion: f64,
    /// Work of adhesion of balls with balls and planes, J/m^2; see [`ContactParameters::adhesion_energy`].
    pub adhesion_energy: f64,
    /// Liquid bridges of balls with balls and planes.
    pub liquid_bridge: Option<LiquidBridge>,
    /// Names of the materials, from number 1 on.
    pub materials: Vec<String>,
    /// Material of the walls.
    pub wall_material: MaterialId,
    /// Laws of pairs of materials.
    pub pairs: Vec<PairLaw>,
    /// Fraction of critical damping of normal contact.
    pub damping_ratio: f64,
    /// Tangential over normal foundation modulus.
    pub tangential_ratio: f64,
    /// Fraction of critical damping of the tangential springs while they stick.
    pub tangential_damping: f64,
    /// The penalty of the contact law.
    pub penalty: Penalty,
    /// Acceleration of gravity, towards -z, m/s^2.
    pub gravity: f64,
    /// The container.
    pub container: Container,
    /// Height of the container's rim, m, for drawings and for the count of bodies above it; the walls
    /// themselves have no upper end.
    pub rim: Option<f64>,
    /// How bodies are added.
    pub protocol: Protocol,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Damping by the medium; switched off when the pack is verified.
    pub medium: Medium,
    /// Step size control; for implicit steps see [`usual_step`](Self::usual_step). The end of the verification
    /// is always explicit, see [`Settling`].
    pub time_step: TimeStepParameters,
    /// When bodies fall asleep while the pack is made.
    pub sleeping: SleepParameters,
    /// When the pack counts as settled.
    pub settling: Settling,
}

impl Default for PackSpec {
    fn default() -> Self {
        let contact = ContactParameters::default();
        let solid = CatalogueShape::from(Solid::A10);
        Self {
            shapes: solid
                .polyhedron(DEFAULT_DIAMETER)
                .map(|p| PackShape::new(solid.id(), p))
                .into_iter()
                .collect(),
            mixing: Mixing::default(),
            count: 500,
            density: 2560.0,
            friction: 0.6,
            wall_friction: None,
            rolling_friction: contact.rolling_friction,
            cohesion: contact.cohesion,
            adhesion_energy: contact.adhesion_energy,
            liquid_bridge: contact.liquid_bridge,
            materials: Vec::new(),
            wall_material: MaterialId::default(),
            pairs: Vec::new(),
            damping_ratio: 0.6,
            tangential_ratio: contact.tangential_ratio,
            tangential_damping: contact.tangential_damping,
            penalty: Penalty::default(),
            gravity: 9.81,
            container: Container::Box {
                width: 8.0 * DEFAULT_DIAMETER,
                depth: 8.0 * DEFAULT_DIAMETER,
            },
            rim: None,
            protocol: Protocol::default(),
            seed: 1,
            medium: Medium::default(),
            time_step: TimeStepParameters::default(),
            // The results are taken with all bodies awake.
            sleeping: SleepParameters {
                measure: SleepMeasure::Load,
                ..SleepParameters::default()
            },
            settling: Settling::default(),
        }
    }
}

impl PackSpec {
    /// Checks everything that can be checked before the first step, except what the world itself checks when it
    /// is built (contact law, safety of the time step and implicit steps, sleeping, medium).
    ///
    /// # Errors
    /// [`PackError::NoShapes`], [`PackError::NotConvex`] for a shape without the mesh it needs, [`PackError::Parameter`], [`PackError::ContainerTooNarrow`].
    pub fn validate(&self) -> Result<(), PackError> {
        if self.shapes.is_empty() {
            return Err(PackError::NoShapes);
        }
        for shape in &self.shapes {
            check(
                "share of a shape",
                shape.share,
                SHARES.contains(&shape.share),
                "between 1e-100 and 1e100",
            )?;
            if let Some(density) = shape.density {
                check_positive("density of a shape", density)?;
            }
            if shape.sphere {
                shape.check_ball()?;
            }
            if shape.mesh.is_none() && !shape.polyhedron.is_convex() {
                return Err(PackError::NotConvex {
                    name: shape.name.clone(),
                });
            }
        }
        check(
            "count",
            f64::from(self.count),
            (1..=MOST_BODIES).contains(&self.count),
            "at least 1 and at most 100,000,000 bodies",
        )?;
        check_positive("density", self.density)?;
        check_positive("gravity", self.gravity)?;
        match self.penalty {
            Penalty::Automatic { penetration } => check(
                "penetration",
                penetration,
                (1e-6..=0.02).contains(&penetration),
                "between 1e-6 and 0.02, in d; 0.0035 is usual",
            )?,
            Penalty::Given { pressure } => check_positive("penalty", pressure)?,
        }
        self.container.validate(self.largest_diameter())?;
        if let Some(rim) = self.rim {
            check_positive("rim", rim)?;
        }
        self.protocol.validate()?;
        // Checked as given: in the world's parameters it is also bounded for falling bodies.
        if let Some(largest) = self.time_step.largest {
            check_positive("time_step.largest", largest)?;
        }
        self.settling.validate()
    }

    /// The contact law of all pairs without one of their own, for a penalty in Pa.
    pub(crate) fn contact(&self, penalty: f64) -> ContactParameters {
        ContactParameters {
            penalty,
            friction: self.friction,
            wall_friction: self.wall_friction,
            rolling_friction: self.rolling_friction,
            damping_ratio: self.damping_ratio,
            tangential_ratio: self.tangential_ratio,
            tangential_damping: self.tangential_damping,
            cohesion: self.cohesion,
            adhesion_energy: self.adhesion_energy,
            liquid_bridge: self.liquid_bridge,
            ..ContactParameters::default()
        }
    }

    /// Whether implicit steps have all that the contacts ask for.
    pub(crate) fn suits_implicit_steps(&self) -> bool {
        let usual = self.contact(1.0);
        let own = self.pairs.iter().map(|pair| pair.over(&usual));
        let mut laws = std::iter::once(usual).chain(own);
        laws.all(|law| law.rolling_friction == 0.0 && !law.attracts())
    }

    /// Mean of a quantity over the shapes, by share.
    fn mean(&self, of: impl Fn(&PackShape) -> f64) -> f64 {
        let total: f64 = self.shapes.iter().map(|s| s.share).sum();
        self.shapes.iter().map(|s| s.share * of(s)).sum::<f64>() / total
    }

    /// Circumscribed diameter d, m; the mean by share for a mixture.
    pub fn diameter(&self) -> f64 {
        self.mean(PackShape::diameter)
    }

    /// Largest circumscribed diameter, m.
    pub fn largest_diameter(&self) -> f64 {
        let diameters = self.shapes.iter().map(PackShape::diameter);
        diameters.fold(0.0, f64::max)
    }

    /// Volume of a body, m^3; the mean by share for a mixture.
    pub fn mean_volume(&self) -> f64 {
        self.mean(PackShape::volume)
    }

    /// Density of a shape's bodies, kg/m^3.
    pub(crate) fn density_of(&self, shape: &PackShape) -> f64 {
        shape.density.unwrap_or(self.density)
    }

    /// Mass of all bodies over their volume, kg/m^3.
    pub fn mean_density(&self) -> f64 {
        if self.shapes.iter().all(|shape| shape.density.is_none()) {
            return self.density;
        }
        self.mean(|shape| shape.volume() * self.density_of(shape)) / self.mean_volume()
    }

    /// Expected height of the pack, m, at a packing density of 0.57.
    pub fn expected_height(&self) -> f64 {
        self.container
            .level(f64::from(self.count) * self.mean_volume() / EXPECTED_DENSITY)
    }

    /// The penalty, Pa: as given, or the automatic choice.
    ///
    /// # Errors
    /// As [`PackSpec::validate`].
    pub fn resolved_penalty(&self) -> Result<f64, PackError> {
        self.validate()?;
        Ok(match self.penalty {
            Penalty::Given { pressure } => pressure,
            Penalty::Automatic { penetration } => {
                let depth = self.mean(PackShape::field_depth);
                let loaded = automatic_penalty(&self.load(), penetration) * depth;
                loaded + self.penalty_of_attraction(penetration * self.diameter())
            }
        })
    }

    fn load(&self) -> PackLoad {
        PackLoad {
            unit_weight: EXPECTED_DENSITY * self.mean_density() * self.gravity,
            height: self.expected_height(),
            floor_area: self.container.floor_area(),
            perimeter: self.container.perimeter(),
            wall_friction: self.wall_friction.unwrap_or(self.friction),
            diameter: self.diameter(),
        }
    }

    /// The unit of time of falling bodies, sqrt(d/g), s.
    pub(crate) fn time_unit(&self) -> f64 {
        (self.diameter() / self.gravity).sqrt()
    }

    /// The default steps of `femdem pack`: implicit (`Some`) if all bodies are released at once, because their
    /// stiff contacts make explicit steps short; otherwise explicit. Packs of 500 bodies reach rest in a sixth
    /// to a quarter of the processor time of explicit steps, come out looser by 0.005 ± 0.003, and the energy
    /// ledger misses up to 5 % of the energy turned over (`records/peers.md`). Without friction, or
    /// with a damping ratio below 0.1, it may miss most of it, and implicit steps have no local damping,
    /// no rolling friction and no attraction: in these cases steps are explicit, too.
    pub fn usual_step(&self) -> Option<ImplicitStep> {
        let suits = self.friction > 0.0
            && self.damping_ratio >= LEAST_DAMPING
            && self.medium.local_damping == 0.0
            && self.suits_implicit_steps();
        match self.protocol {
            Protocol::Release(_) if suits => Some(ImplicitStep::default()),
            _ => None,
        }
    }

    /// Step size control where bodies fall; implicit steps may be given a longer limit.
    pub(crate) fn falling_time_step(&self) -> TimeStepParameters {
        let asked = self.time_step.implicit.map_or(LARGEST_STEP, |i| i.fall);
        let falling = LARGEST_STEP.max(asked) * self.time_unit();
        TimeStepParameters {
            largest: Some(self.time_step.largest.unwrap_or(f64::INFINITY).min(falling)),
            ..self.time_step
        }
    }

    /// Parameters of the world with a penalty (Pa).
    pub(crate) fn world_parameters(&self, penalty: f64) -> WorldParameters {
        WorldParameters {
            gravity: Vector3::new(0.0, 0.0, -self.gravity),
            contact: self.contact(penalty),
            time_step: self.falling_time_step(),
            sleeping: self.sleeping,
            medium: self.medium,
        }
    }
}

impl Settling {
    fn validate(&self) -> Result<(), PackError> {
        check_positive("settling residual", self.residual)?;
        check_positive("settling kinetic_energy", self.kinetic_energy)?;
        check_positive("settling longest", self.longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_spec_is_valid_and_says_what_it_packs() {
        let spec = PackSpec::default();
        spec.validate().unwrap();
        assert_eq!(spec.shapes[0].name, "A10");
        assert!((spec.diameter() - 0.02).abs() < 1e-15);
        // 500 bodies of 0.4253 d^3 (truncated dodecahedron) on 64 d^2 at 0.57.
        let height = 500.0 * 0.4253 / 0.57 / 64.0;
        assert!((spec.expected_height() / 0.02 / height - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let says = |change: fn(&mut PackSpec)| {
            let mut spec = PackSpec::default();
            change(&mut spec);
            spec.validate().unwrap_err().to_string()
        };
        assert!(says(|s| s.shapes.clear()).contains("no shape"));
        assert!(says(|s| s.count = 0).contains("count = 0"));
        assert!(says(|s| s.density = f64::NAN).contains("density = NaN"));
        assert!(says(|s| s.gravity = -9.81).contains("gravity = -9.81"));
        assert!(says(|s| s.shapes[0].share = 0.0).contains("share of a shape = 0"));
        assert!(says(|s| s.penalty = Penalty::Given { pressure: 0.0 }).contains("penalty = 0"));
        assert!(
            says(|s| s.penalty = Penalty::Automatic { penetration: 0.5 }).contains("penetration")
        );
        assert!(says(|s| s.container = Container::Cylinder { diameter: 0.01 }).contains("0.02"));
        assert!(says(|s| s.settling.residual = 0.0).contains("settling residual = 0"));
        assert!(says(|s| s.shapes[0].sphere = true).contains("of a ball's surface"));
    }

    /// Without friction the walls carry nothing, and the floor's stress is the weight above it.
    #[test]
    fn the_automatic_penalty_goes_by_the_friction_of_the_walls() {
        let penalty = |friction, wall_friction| {
            let spec = PackSpec {
                friction,
                wall_friction,
                ..PackSpec::default()
            };
            spec.resolved_penalty().unwrap()
        };
        assert_eq!(penalty(0.6, Some(0.2)), penalty(0.2, None));
        assert!(penalty(0.6, Some(0.0)) > 1.05 * penalty(0.6, None));
    }

    #[test]
    fn falling_bodies_bound_the_step() {
        let longest = |fall: Option<f64>| {
            let mut spec = PackSpec::default();
            spec.time_step.implicit = fall.map(|fall| ImplicitStep {
                fall,
                ..ImplicitStep::default()
            });
            spec.falling_time_step().largest.unwrap() / spec.time_unit()
        };
        for (fall, expected) in [(None, 0.01), (Some(0.005), 0.01), (Some(0.015), 0.015)] {
            let got = longest(fall);
            assert!((got - expected).abs() < 1e-12, "{fall:?}: {got}");
        }
    }

    #[test]
    fn densities_of_shapes_count_by_volume() {
        let mut spec = PackSpec::default();
        assert_eq!(spec.mean_density(), spec.density);
        let mut heavy = spec.shapes[0].clone();
        heavy.polyhedron = heavy.polyhedron.scaled(2.0).unwrap();
        heavy.density = Some(7800.0);
        spec.shapes.push(heavy);
        // Eight parts of the volume are heavy, one is not.
        let wanted = (8.0 * 7800.0 + spec.density) / 9.0;
        assert!((spec.mean_density() / wanted - 1.0).abs() < 1e-12);
        spec.shapes[1].density = Some(0.0);
        let error = spec.validate().unwrap_err().to_string();
        assert!(error.contains("density of a shape = 0"), "{error}");
    }

    /// Sizes scale the surface and the tetrahedra together, and are in the names.
    #[test]
    fn a_shape_has_the_sizes_asked_for() {
        let dolos: shapes::Shape = "dolos".parse().unwrap();
        let surface = dolos.polyhedron(0.1).unwrap();
        let (shape, _) = PackShape::of_surface("dolos", surface, &MeshOptions::default()).unwrap();
        let sizes = [(0.02, 30), (0.1234567, 4)];
        let sizes = sizes.map(|(diameter, count)| SizeClass { diameter, count });
        let made = shape.in_sizes(&sizes).unwrap();
        assert_eq!(made[0].name, "dolos 20mm");
        assert_eq!(made[1].name, "dolos 123.5mm");
        for (shape, size) in made.iter().zip(sizes) {
            assert!((shape.diameter() / size.diameter - 1.0).abs() < 1e-12);
            assert_eq!(shape.share, f64::from(size.count));
            let mesh = shape.mesh.as_ref().unwrap();
            let farthest = mesh
                .points()
                .iter()
                .map(|p| (p - shape.polyhedron.mass_properties().centroid).norm());
            let reach = farthest.fold(0.0, f64::max);
            assert!(
                reach > 0.9 * size.diameter / 2.0 && reach < 1.1 * size.diameter / 2.0,
                "{reach}"
            );
        }
    }

    #[test]
    fn mixtures_average_by_share() {
        let mut spec = PackSpec::default();
        let mut large = spec.shapes[0].clone();
        large.polyhedron = large.polyhedron.scaled(2.0).unwrap();
        large.share = 3.0;
        spec.shapes.push(large);
        assert!((spec.diameter() - 0.035).abs() < 1e-12);
        assert!((spec.largest_diameter() - 0.04).abs() < 1e-12);
    }
}
