//! The combined finite-discrete element method: bodies of any shape, from their geometry to the measured pack.
//! This crate re-exports the other libraries and contains the `femdem` program.
//!
//! **Use it** to pack rigid bodies under gravity with friction, to measure and draw packs, to let rigid and
//! deformable bodies collide, slide, squeeze each other and break, or to use its parts in a simulation of your own.
//! **Do not use it** where a fluid matters, or for spheres alone, for which lighter codes exist.
//!
//! ```
//! use femdem::mesh::catalogue::{CatalogueShape, Solid};
//! use femdem::pack::{Container, PackShape, PackSpec, Packing};
//! use femdem::{Summary, Usage, results};
//!
//! // Four cubes of 20 mm, one batch after another, into a box.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02)?;
//! let mut packing = Packing::new(PackSpec {
//!     shapes: vec![PackShape::new("cube", cube)],
//!     count: 4,
//!     container: Container::Box { width: 0.05, depth: 0.05 },
//!     ..PackSpec::default()
//! })?;
//! packing.run()?;
//!
//! // What the program writes to a folder, here in memory.
//! let snapshot = results::snapshot(&packing);
//! let summary = Summary::of(&packing, &snapshot, &Usage::default())?;
//! assert!(summary.settled && summary.coordination.mean > 0.0);
//! let mut table = Vec::new();
//! femdem::output::csv::write_bodies(&snapshot, &mut table)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guide
//!
//! Use the lowest layer that suffices.
//!
//! | you have | you want | use |
//! |---|---|---|
//! | nothing | a pack, measured and drawn | the program: `femdem pack --help` |
//! | nothing | bodies that deform, collide or are driven | the program: `femdem run --help` |
//! | a scene file of `run` | the same, from a program | [`run::Scenario`], [`run::Run`] |
//! | a scene file of `pack` | the same, from a program | [`Scene`], [`pack::Packing`], [`results::write`] |
//! | shapes and a container | a pack at rest | [`pack::Packing`] |
//! | bodies and walls of your own | their motion | [`solve::World`] |
//! | your own integrator | contact forces | [`contact::ContactBatch`], [`contact::PairKernel`] |
//! | poses and contacts, from anywhere | density, forces, chains, stress | [`analysis`], [`input`] |
//! | poses, from anywhere | files and pictures | [`Snapshot`] with [`output`] and [`picture`] |
//! | poses, from anywhere | one page for the browser, plots | [`report::Report`], [`plot::plots`] |
//! | vertices, or a surface file | a checked body with its mass properties, a mesh of it | [`mesh`] |
//!
//! A pack passes through these as data: [`pack::Packing`] → [`results::snapshot`] → [`Snapshot`] → [`output`],
//! [`picture`], [`Summary`]. What takes a [`Snapshot`] is the crate femdem-view, which needs none of the crates of
//! contacts and motion. Nothing here holds global state, prints, or starts threads; only [`program`] does.
//!
//! # Units
//! SI: m, kg, s, N, J, Pa. d is the circumscribed diameter of a body; `_over_d` is relative to it.
//! Gravity acts along −z.
//!
//! # Features
//! - `parallel` (default): contacts and analysis use the caller's rayon pool. Results are the same bits at any
//!   number of threads and without the feature. (Pictures and [`stresses`] always use the pool, and are the same, too.)
//!
//! # Accuracy
//! Contact is by penalty: bodies overlap by a stated amount ([`Summary::penetration`]), and equilibrium holds
//! to a stated residual ([`Summary::residual`]); the energy ledger states the error of the time integration
//! ([`Summary::energy`]). CSV files have all digits, VTU and VTP double precision, STL single. The class of a
//! contact is a rule with limits ([`ContactClass::of_patch`]).

pub mod analysis;
mod error;
mod gather;
mod grid;
mod means;
mod meshing;
pub mod program;
pub mod resolve;
pub mod results;
pub mod run;
mod saved;
pub mod scene;
pub mod stresses;
mod toml_file;

// Each as a line of the docs: listed here, their items would be there twice, and all those of nalgebra with them.
#[doc(no_inline)]
pub use femdem_contact as contact;
#[doc(no_inline)]
pub use femdem_fem as fem;
#[doc(no_inline)]
pub use femdem_mesh as mesh;
#[doc(no_inline)]
pub use femdem_pack as pack;
#[doc(no_inline)]
pub use femdem_solve as solve;

pub use femdem_view::{input, output, picture, plot, report};

pub use error::Error;
pub use femdem_analysis::{ContactClass, Patch};
pub use femdem_view::{
    Body, BodyLoad, BodyValues, Colouring, ContactRow, CrackEvent, CrackFacet, CrackMode, Drawing,
    Fracture, FragmentRow, Gaps, NamedShape, Partner, Snapshot, Spacing, ViewError,
};
pub use results::{Summary, Usage};
pub use scene::Scene;

// The program names the libraries as any other code does.
extern crate self as femdem;

#[cfg(doctest)]
#[doc = include_str!("../../../docs/extending.md")]
mod extending {}
