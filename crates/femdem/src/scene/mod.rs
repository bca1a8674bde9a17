//! Scenes: what to pack, in a file or on the command line, with defaults for everything.
//!
//! A scene file is TOML; its keys are the long options of `femdem pack`, and all of them are optional. `femdem
//! pack ... --print-scene` writes one.
//!
//! ```
//! use femdem::Scene;
//!
//! let scene = Scene::from_toml("shape = \"cube\"\ncount = 50\nbox = \"4x5\"\n")?;
//! let spec = scene.spec()?;
//! assert_eq!(spec.shapes[0].name, "P5");
//! assert!((spec.container.floor_area() - 0.2 * 0.25).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
mod bridge;
mod command;
mod container;
mod drag;
mod footprint;
mod gravity;
mod length;
mod list;
mod materials;
mod note;
mod pair;
mod sizes;
mod step_kind;
pub(crate) mod surface;
mod tables;
mod unit;
mod words;

use std::path::{Path, PathBuf};

use femdem_pack::{Mixing, PackSpec, Packing, Penalty, Pour, Protocol, Release, Sequential};
use femdem_solve::Medium;
use serde::{Deserialize, Serialize};

pub use bodies::is_ball;
pub use bridge::BridgeEntry;
pub use drag::Drag;
pub(crate) use drag::per_second;
pub use footprint::Footprint;
pub(crate) use gravity::vector as gravity_vector;
pub(crate) use length::in_metres;
pub use length::{Length, metres};
pub use note::ShapeNote;
pub use pair::PairEntry;
pub(crate) use sizes::grading;
pub use step_kind::StepKind;
pub use unit::Unit;

use crate::{Error, toml_file};

/// Circumscribed diameter of a parametric shape where no size is given \[m\].
pub const DEFAULT_DIAMETER: f64 = 0.05;

/// Diameter of the closed outlet of a silo where none is given.
pub const DEFAULT_OUTLET: Length = Length::Diameters(3.0);

/// Angle between the cone of a silo and the vertical where none is given \[degrees\].
pub const DEFAULT_CONE: f64 = 30.0;

/// How bodies come into the container.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ProtocolKind {
    /// Small batches, one after another, each from rest just above the pack (the founding paper's)
    #[default]
    Sequential,
    /// Layers at a fixed rate from above the pack to come
    Pour,
    /// All bodies at once, from a lattice
    Release,
}

/// What holds the pack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ContainerKind {
    /// Four upright walls
    #[default]
    Box,
    /// A floor that repeats itself along x and y, without walls
    Periodic,
    /// An upright cylinder
    Cylinder,
    /// An upright cylinder above a cone with a closed outlet
    Silo,
    /// A solid of any form with a hollow, from a surface file
    Walls,
}

/// A packing job with the options of the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Scene {
    /// Shapes: parametric ones such as "A10", "cube" or "dolos:waist=0.36" (see
    /// [`femdem_mesh::shapes`]), or paths of surface files. Several make a mixture.
    #[serde(with = "list")]
    pub shape: Vec<String>,
    /// Relative number of bodies of each shape; empty: equal.
    #[serde(with = "list", skip_serializing_if = "Vec::is_empty")]
    pub share: Vec<f64>,
    /// Number of variants of each shape that has a seed: its seed and the ones after it.
    pub variety: u32,
    /// Circumscribed diameter d of each shape \[m\]. If neither `diameter` nor `size` nor `mass` is
    /// given: [`DEFAULT_DIAMETER`] for a parametric shape, the size in the file for a file.
    #[serde(deserialize_with = "in_metres")]
    pub diameter: Option<f64>,
    /// Size of parametric shapes by their own measure \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub size: Option<f64>,
    /// Mass of a body of each shape \[kg\].
    pub mass: Option<f64>,
    /// Sizes of the bodies: one text for all shapes, or one for each, instead of `diameter`, `size` and `mass`. Such as
    /// "20mm:0.3,30mm:0.7" with shares of the mass, see docs/shapes.md.
    #[serde(with = "list", skip_serializing_if = "Vec::is_empty")]
    pub sizes: Vec<String>,
    /// Sieve curve of the bodies by mass, such as "10mm:0,20mm:0.4,30mm:1", in the same way.
    #[serde(with = "list", skip_serializing_if = "Vec::is_empty")]
    pub sieve: Vec<String>,
    /// Unit of the coordinates in surface files.
    pub unit: Unit,
    /// Whether small faults of surface files are mended.
    pub repair: bool,
    /// Target edge length of the tetrahedra of bodies that are not convex, in d of the body. `None`: by
    /// the shape, see [`MeshOptions`](femdem_mesh::tet::MeshOptions).
    pub mesh_size: Option<f64>,
    /// Number of bodies.
    pub count: u32,
    /// Density of the bodies \[kg/m³\]: one number for all shapes, or one for each.
    #[serde(with = "list")]
    pub density: Vec<f64>,
    /// Friction coefficient.
    pub friction: f64,
    /// Friction coefficient between bodies and walls. `None`: `friction`.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction.
    pub rolling_friction: f64,
    /// Cohesion \[Pa\].
    pub cohesion: f64,
    /// Work of adhesion of spheres with spheres and planes \[J/m²\].
    pub adhesion_energy: f64,
    /// Liquid bridges of spheres with spheres and planes. `None`: none.
    pub liquid_bridge: Option<BridgeEntry>,
    /// Name of the material of each shape: one for all, or one for each. Empty: none, and the law of all contacts.
    #[serde(with = "list", skip_serializing_if = "Vec::is_empty")]
    pub material: Vec<String>,
    /// Name of the material of the walls. `None`: none.
    pub wall_material: Option<String>,
    /// Contact laws of pairs of these materials.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pair: Vec<PairEntry>,
    /// Stiffness of the friction springs over that of normal contact, above 0 and at most 2.
    pub tangential_ratio: f64,
    /// Fraction of critical damping of the friction springs.
    pub tangential_damping: f64,
    /// Fraction of critical damping of normal contact, 0 to 0.707.
    pub damping: f64,
    /// Penalty \[Pa\]. `None`: chosen for a mean penetration of `penetration`.
    pub penalty: Option<f64>,
    /// Target of the mean penetration over d for the automatic penalty. `None`: the usual value of the protocol
    /// ([`Protocol::usual_penetration`]).
    pub penetration: Option<f64>,
    /// Drag of the medium while the pack is made.
    pub drag: Drag,
    /// Cundall's local damping while the pack is made: the part of each component of a body's net force
    /// and moment that is taken off against the motion, 0 to below 1.
    pub local_damping: f64,
    /// Explicit or implicit time steps. `None`: the default of the job ([`PackSpec::usual_step`]).
    pub implicit: Option<StepKind>,
    /// Whether bodies at rest sleep while the pack is made. Without sleep a job takes several times as long,
    /// and packs in sequence come out lower by 1.5 ± 0.3 %.
    pub sleeping: bool,
    /// Gravity, along -z \[m/s²\].
    #[serde(deserialize_with = "gravity::down")]
    pub gravity: f64,
    /// Kind of container. `None`: by the sizes that are given, see
    /// [`container_kind`](Self::container_kind).
    pub container: Option<ContainerKind>,
    /// Inner width and depth of the box, and height of its rim. `None`: as wide as the pack will be
    /// high.
    pub r#box: Option<Footprint>,
    /// Inner diameter of the cylinder or silo. `None`: as wide as the pack will be high.
    pub cylinder: Option<Length>,
    /// Diameter of the closed outlet of a silo. `None`: [`DEFAULT_OUTLET`].
    pub outlet: Option<Length>,
    /// Angle between the cone of a silo and the vertical \[degrees\]. `None`: [`DEFAULT_CONE`].
    pub cone: Option<f64>,
    /// Surface file of the solid that forms the walls.
    pub walls: Option<PathBuf>,
    /// How bodies come into the container.
    pub protocol: ProtocolKind,
    /// Bodies in a batch (sequential) or layer (pour). `None`: by the floor's area.
    pub batch: Option<u32>,
    /// Bodies per second (pour).
    pub rate: f64,
    /// Height of the release above the floor (pour). `None`: 1 d above the pack to come.
    pub height: Option<Length>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Folder for the results.
    pub out: PathBuf,
    /// Threads. `None`: one for each core.
    pub threads: Option<usize>,
    /// Time between checkpoints \[s of wall clock\].
    pub checkpoint_every: f64,
}

impl Default for Scene {
    fn default() -> Self {
        let spec = PackSpec::default();
        Self {
            shape: vec!["A10".to_owned()],
            share: Vec::new(),
            variety: 1,
            count: 200,
            diameter: None,
            size: None,
            mass: None,
            sizes: Vec::new(),
            sieve: Vec::new(),
            unit: Unit::M,
            repair: false,
            mesh_size: None,
            density: vec![spec.density],
            friction: spec.friction,
            wall_friction: None,
            rolling_friction: spec.rolling_friction,
            cohesion: spec.cohesion,
            adhesion_energy: spec.adhesion_energy,
            liquid_bridge: None,
            material: Vec::new(),
            wall_material: None,
            pair: Vec::new(),
            tangential_ratio: spec.tangential_ratio,
            tangential_damping: spec.tangential_damping,
            damping: spec.damping_ratio,
            penalty: None,
            penetration: None,
            drag: Drag::NONE,
            local_damping: 0.0,
            implicit: None,
            sleeping: spec.sleeping.enabled,
            gravity: spec.gravity,
            container: None,
            r#box: None,
            cylinder: None,
            outlet: None,
            cone: None,
            walls: None,
            protocol: ProtocolKind::Sequential,
            batch: None,
            rate: Pour::default().rate,
            height: None,
            seed: 1,
            out: PathBuf::from("out/pack"),
            threads: None,
            checkpoint_every: 60.0,
        }
    }
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    ///
    /// [`Error::Read`], or [`Error::Scene`] with the place where the text is not a scene.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_saying(path).map(|(scene, _)| scene)
    }

    /// As [`read`](Self::read), with a line for each word of an earlier version that was understood.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn read_saying(path: impl AsRef<Path>) -> Result<(Self, Vec<String>), Error> {
        let path = path.as_ref();
        tables::parse(&toml_file::text(path)?, path)
    }

    /// Reads a scene from text. The keys of the tables `contact` and `medium` of a scene of `femdem run` are
    /// understood with and without them.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`], with the line and what is allowed there.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        tables::parse(text, Path::new("scene")).map(|(scene, _)| scene)
    }

    /// The scene as the text of a scene file.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] if the path of the output folder is not UTF-8.
    pub fn to_toml(&self) -> Result<String, Error> {
        let body = toml_file::write(self, Path::new("scene"))?;
        Ok(format!(
            "# A scene for `femdem pack`: keys are its options, each may be left out. Switches are keys \
             too:\n# repair = true, implicit = true, implicit = false (--explicit), sleeping = false \
             (--awake).\n{body}"
        ))
    }

    /// The packing job.
    ///
    /// # Errors
    ///
    /// [`Error::Mesh`] for a shape that is unknown, cannot be read, or is not a closed surface;
    /// [`Error::Option`] and [`Error::Pack`] for values out of range.
    pub fn spec(&self) -> Result<PackSpec, Error> {
        self.prepare().map(|(spec, _)| spec)
    }

    /// The packing job, and how its shapes were read and meshed.
    ///
    /// # Errors
    ///
    /// As [`spec`](Self::spec).
    pub fn prepare(&self) -> Result<(PackSpec, Vec<ShapeNote>), Error> {
        let (shapes, mut notes) = bodies::bodies(self)?;
        let mut spec = PackSpec {
            shapes,
            mixing: match self.is_graded() {
                true => Mixing::Shuffled,
                false => Mixing::Dealt,
            },
            count: self.count,
            density: self.densities()?[0],
            friction: self.friction,
            wall_friction: self.wall_friction,
            rolling_friction: self.rolling_friction,
            cohesion: self.cohesion,
            adhesion_energy: self.adhesion_energy,
            liquid_bridge: self.liquid_bridge.map(Into::into),
            tangential_ratio: self.tangential_ratio,
            tangential_damping: self.tangential_damping,
            damping_ratio: self.damping,
            gravity: self.gravity,
            seed: self.seed,
            ..PackSpec::default()
        };
        self.check()?;
        self.set_materials(&mut spec)?;
        let diameter = spec.diameter();
        spec.container = container::container(self, &spec, &mut notes)?;
        spec.rim = container::rim(self, diameter);
        spec.protocol = self.protocol(diameter);
        spec.penalty = match self.penalty {
            Some(pressure) => Penalty::Given { pressure },
            None => Penalty::Automatic {
                penetration: self
                    .penetration
                    .unwrap_or_else(|| spec.protocol.usual_penetration()),
            },
        };
        spec.medium = Medium {
            drag: self.drag.per_second(diameter, self.gravity),
            local_damping: self.local_damping,
        };
        spec.sleeping.enabled = self.sleeping;
        spec.time_step.implicit = match self.implicit {
            Some(kind) => kind.step(),
            None => spec.usual_step(),
        };
        spec.validate().map_err(words::in_words_of_scenes)?;
        Ok((spec, notes))
    }

    /// The packing job, ready to be run, and how its shapes were read and meshed.
    ///
    /// # Errors
    ///
    /// As [`spec`](Self::spec), and what the job itself refuses.
    pub fn packing(&self) -> Result<(Packing, Vec<ShapeNote>), Error> {
        let (spec, notes) = self.prepare()?;
        let packing = Packing::new(spec).map_err(words::in_words_of_scenes)?;
        Ok((packing, notes))
    }

    /// Whether the bodies have sizes by shares, curves or distributions.
    fn is_graded(&self) -> bool {
        !self.sizes.is_empty() || !self.sieve.is_empty()
    }

    /// The densities of the shapes \[kg/m³\]: one for all, or one for each.
    fn densities(&self) -> Result<&[f64], Error> {
        if self.density.len() == 1 || self.density.len() == self.shape.len().max(1) {
            return Ok(&self.density);
        }
        Err(Error::Option {
            name: "density",
            value: format!("{} numbers", self.density.len()),
            allowed: "one number for all shapes, or one for each shape",
        })
    }

    /// Refuses values that would be converted silently, or would have no effect.
    fn check(&self) -> Result<(), Error> {
        let refuse = |name: &'static str, value: String, allowed: &'static str| {
            Err(Error::Option {
                name,
                value,
                allowed,
            })
        };
        for (name, value) in [
            ("friction", Some(self.friction)),
            ("wall-friction", self.wall_friction),
            ("rolling-friction", Some(self.rolling_friction)),
        ] {
            // The automatic penalty would come to nothing before anyone looks at these.
            if value == Some(f64::INFINITY) {
                return refuse(name, "inf".to_owned(), "0 or more and finite");
            }
        }
        if let (Some(batch), ProtocolKind::Release) = (self.batch, self.protocol) {
            let allowed = "the protocol release has all bodies in one; leave it out";
            return refuse("batch", batch.to_string(), allowed);
        }
        if self.protocol != ProtocolKind::Pour {
            let allowed = "it is for the protocol pour; leave it out";
            if let Some(height) = self.height {
                return refuse("height", height.to_string(), allowed);
            }
            if self.rate != Pour::default().rate {
                return refuse("rate", self.rate.to_string(), allowed);
            }
        }
        Ok(())
    }

    fn protocol(&self, diameter: f64) -> Protocol {
        let batch = self.batch;
        match self.protocol {
            ProtocolKind::Sequential => Protocol::Sequential(Sequential {
                batch,
                ..Sequential::default()
            }),
            ProtocolKind::Pour => Protocol::Pour(Pour {
                rate: self.rate,
                layer: batch,
                height: self.height.map(|height| height.metres(diameter)),
                ..Pour::default()
            }),
            ProtocolKind::Release => Protocol::Release(Release::default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_pack::Container;

    #[test]
    fn a_scene_survives_its_file() {
        let scene = Scene {
            shape: vec!["body.obj".to_owned()],
            diameter: Some(0.02),
            container: Some(ContainerKind::Box),
            batch: Some(3),
            r#box: Some(Footprint::diameters(4.0, 5.5)),
            threads: Some(2),
            ..Scene::default()
        };
        let text = scene.to_toml().unwrap();
        assert_eq!(Scene::from_toml(&text).unwrap(), scene);
        assert!(
            text.contains("checkpoint-every = 60.0") && text.contains("box = \"4x5.5\""),
            "{text}"
        );
    }

    #[test]
    fn an_empty_file_is_the_default_scene() {
        assert_eq!(Scene::from_toml("").unwrap(), Scene::default());
    }

    /// Walls have the friction of the bodies unless they are given their own.
    #[test]
    fn friction_of_walls_and_springs_go_into_the_job() {
        let job = |text: &str| Scene::from_toml(text).unwrap().spec().unwrap();
        let usual = job("friction = 0.4");
        assert_eq!((usual.wall_friction, usual.tangential_ratio), (None, 0.8));
        let text = "friction = 0.4\nwall-friction = 0.1\ntangential-ratio = 1.6\n";
        let own = job(text);
        assert_eq!((own.wall_friction, own.tangential_ratio), (Some(0.1), 1.6));
        let again = Scene::from_toml(text).unwrap().to_toml().unwrap();
        assert!(
            again.contains("wall-friction = 0.1\n") && again.contains("tangential-ratio = 1.6\n")
        );
    }

    #[test]
    fn implicit_steps_go_into_the_job() {
        let job = |text: &str| Scene::from_toml(text).unwrap().spec().unwrap();
        let multiple = |text: &str| job(text).time_step.implicit.map(|step| step.multiple);
        assert_eq!(multiple(""), None);
        assert_eq!(multiple("protocol = \"pour\""), None);
        for (text, expected) in [("3", 3.0), ("3.0", 3.0), ("true", 9.0)] {
            assert_eq!(multiple(&format!("implicit = {text}")), Some(expected));
        }
        let release = "protocol = \"release\"\n";
        assert_eq!(multiple(release), Some(9.0));
        for explicit in [
            "implicit = false",
            "local-damping = 0.1",
            "damping = 0.05",
            "friction = 0",
        ] {
            assert_eq!(multiple(&format!("{release}{explicit}")), None);
        }
        let refused = Scene::from_toml("implicit = \"yes\"").unwrap_err();
        assert!(
            refused.to_string().contains("expected false, true"),
            "{refused}"
        );
    }

    #[test]
    fn bodies_sleep_unless_told_otherwise() {
        for (text, sleeping) in [("", true), ("sleeping = false", false)] {
            let spec = Scene::from_toml(text).unwrap().spec().unwrap();
            assert_eq!(spec.sleeping.enabled, sleeping);
        }
    }

    #[test]
    fn unknown_keys_and_values_are_named_with_their_line() {
        let says = |text: &str| Scene::from_toml(text).unwrap_err().to_string();
        let message = says("count = 10\ncuont = 20\n");
        assert!(
            message.contains("line 2") && message.contains("cuont"),
            "{message}"
        );
        let message = says("protocol = \"rain\"");
        assert!(
            message.contains("sequential") && message.contains("release"),
            "{message}"
        );
        assert!(says("box = \"6\"").contains("6x6"));
        assert!(says("count = -1").contains("count"));
        for (text, expected) in [
            ("shape = 5", "integer `5`, expected a string"),
            ("shape = [\"P5\", 5]", "integer `5`, expected a string"),
            ("share = \"x\"", "string \"x\", expected"),
            ("share = true", "one value or a list"),
        ] {
            let message = says(text);
            assert!(
                message.contains(text) && message.contains(expected),
                "{message}"
            );
        }
    }

    #[test]
    fn sizes_are_in_diameters() {
        let scene = Scene {
            container: Some(ContainerKind::Cylinder),
            cylinder: Some(Length::Diameters(5.0)),
            ..Scene::default()
        };
        let spec = scene.spec().unwrap();
        assert_eq!(
            spec.container,
            Container::Cylinder {
                diameter: 5.0 * spec.diameter()
            }
        );
        assert!((spec.diameter() - DEFAULT_DIAMETER).abs() < 1e-15);
    }

    #[test]
    fn containers_without_a_size_are_as_wide_as_the_pack_is_high() {
        for container in [ContainerKind::Box, ContainerKind::Cylinder] {
            for count in [200, 1000, 20_000] {
                let scene = Scene {
                    container: Some(container),
                    count,
                    ..Scene::default()
                };
                let spec = scene.spec().unwrap();
                let width = 2.0 * spec.container.half_extent()[0];
                let volume = f64::from(count) * spec.shapes[0].polyhedron.mass_properties().volume;
                let height = volume / 0.6 / spec.container.floor_area();
                // A width rounded by d/4 changes width over height by three times its share.
                assert!(
                    (width / height - 1.0).abs() < 0.2,
                    "{count}: {width} {height}"
                );
            }
        }
        let few = Scene {
            count: 1,
            ..Scene::default()
        }
        .spec()
        .unwrap();
        assert!((few.container.half_extent()[0] - 1.5 * few.diameter()).abs() < 1e-12);
    }

    #[test]
    fn values_out_of_range_are_refused_by_name() {
        let says = |change: fn(&mut Scene)| {
            let mut scene = Scene::default();
            change(&mut scene);
            scene.spec().unwrap_err().to_string()
        };
        assert!(says(|s| s.shape = vec!["A14".to_owned()]).contains("A14"));
        assert!(says(|s| s.shape = vec!["none.obj".to_owned()]).contains("none.obj"));
        assert!(says(|s| s.count = 0).contains("count = 0"));
        assert!(says(|s| s.diameter = Some(f64::NAN)).contains("NaN"));
        assert!(says(|s| s.r#box = "0.5x4".parse().ok()).contains("if metres are meant"));
        assert!(says(|s| s.density = vec![-1.0]).contains("density = -1"));
        assert!(says(|s| s.shape.clear()).contains("no shape"));
        assert!(says(|s| s.share = vec![1.0, 2.0]).contains("one number for each"));
        assert!(says(|s| s.variety = 3).contains("variety = 3"));
        assert!(says(|s| s.mass = Some(-1.0)).contains("mass = -1"));
        let both = |s: &mut Scene| (s.mass, s.diameter) = (Some(1.0), Some(0.1));
        assert!(says(both).contains("only one"));
    }

    #[test]
    fn a_release_aims_at_a_smaller_penetration_unless_told_otherwise() {
        let penalty = |text: &str| Scene::from_toml(text).unwrap().spec().unwrap().penalty;
        let aims = |penetration| Penalty::Automatic { penetration };
        assert_eq!(penalty("count = 2"), aims(0.0035));
        let release = "count = 2\nprotocol = \"release\"\n";
        assert_eq!(penalty(release), aims(0.0012));
        let told = format!("{release}penetration = 0.004");
        assert_eq!(penalty(&told), aims(0.004));
    }
}
