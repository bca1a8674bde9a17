//! Packs of polyhedra: containers, protocols, and a job that ends with a verified pack.
//!
//! **Use it** to make packs of rigid bodies under gravity from random orientations: deposited in sequence as in
//! the founding paper (Xiang, Latham and Farsi 2016), poured in layers, or released all at once, in a box, a
//! cylinder, a silo or a container of any form, and brought to rest, which is verified. **Do not use it** to
//! measure packs (femdem-analysis does), for deformable bodies, for packs made by algorithms without mechanics,
//! or where the bodies need not come to rest (build a [`femdem_solve::World`] and step it yourself).
//!
//! ```
//! use femdem_mesh::catalogue::{CatalogueShape, Solid};
//! use femdem_pack::{Container, PackShape, PackSpec, Packing};
//!
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02)?;
//! let mut packing = Packing::new(PackSpec {
//!     shapes: vec![PackShape::new("cube", cube)],
//!     count: 4,
//!     container: Container::Box { width: 0.05, depth: 0.05 },
//!     ..PackSpec::default()
//! })?;
//! while !packing.is_done() {
//!     let progress = packing.advance(500)?;
//!     assert!(progress.placed <= 4);
//! }
//! let report = packing.report()?;
//! assert!(report.settled && report.residual_max_over_load <= 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is where
//! - [`PackSpec`]: the whole job as data, with a default for everything; [`PackShape`],
//!   [`Container`], [`Protocol`], [`Settling`] are its parts.
//! - [`Sizes`]: sizes of the bodies of a shape, by mass: shares, a sieve curve, a distribution;
//!   [`PackShape::in_sizes`] makes the shapes of a job of them.
//! - [`Packing`]: the job. It advances by steps, reports its [`Progress`], can be saved and read back at any
//!   step, and ends with a [`PackReport`].
//! - [`Penalty`], [`automatic_penalty`], [`penalty_under_stress`]: the stiffness of the contacts, from the allowed penetration.
//! - [`body_stream`], [`uniform`], [`random_rotation`]: the random numbers.
//! - [`solve`], [`contact`] and [`mesh`]: the crates whose types appear in this interface, such as the
//!   [`solve::World`] of a job ([`Packing::world`]).
//!
//! # Units
//! SI. Gravity acts along -z; the floor is z = 0 and the container stands about the z axis. d is the
//! circumscribed diameter of a body; fields named `_over_d` are in d. Times of rules are in
//! sqrt(d/g), the time in which a body falls half its diameter.
//!
//! # Features
//! - `parallel` (default): contacts are evaluated on the caller's rayon pool. Results are the same
//!   bits with any number of threads and without the feature.
//!
//! # Accuracy
//! The pack is an equilibrium of the penalty contact law: bodies overlap by about the penetration given to
//! [`Penalty::Automatic`], and the report states the mean and the largest penetration. Settled is defined by
//! [`Settling`], with every body awake and no medium. A pack that does not settle in the time allowed is
//! reported as not settled, never forced. The report also states how far bodies moved during the verification,
//! and during the last awake relaxation before it ([`Relaxation`]); the latter is mostly compression under
//! loads that sleeping bodies had not passed on. Packs of 500 that slept are 1.5 ± 0.3 % higher than packs that
//! never did ([`PackSpec::sleeping`]), which cost seven times as much (`records/cost.md`).

mod attraction;
mod container;
mod error;
mod packing;
mod pair_law;
mod penalty;
mod placement;
mod protocol;
mod random;
mod report;
mod sizes;
mod spec;

pub use femdem_contact as contact;
pub use femdem_mesh as mesh;
pub use femdem_solve as solve;

pub use container::{Container, MeshContainer};
pub use error::PackError;
pub use packing::{Packing, Progress, Stage};
pub use pair_law::PairLaw;
pub use penalty::{
    PackLoad, Penalty, automatic_penalty, penalty_under_adhesion, penalty_under_cohesion,
    penalty_under_stress,
};
pub use protocol::{Landing, Pour, Protocol, Release, Sequential};
pub use random::{body_stream, random_rotation, uniform};
pub use report::{PackReport, Relaxation, Verification};
pub use sizes::{Grading, Measure, SizeClass, Sizes};
pub use spec::{Mixing, PackShape, PackSpec, Settling};
