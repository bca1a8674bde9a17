//! Everything that `femdem analyse` computes, and the crate that does it.
//!
//! [`Tables::compute`] computes every measurement that the data of a [`Snapshot`](crate::Snapshot) allow, from
//! a simulation or from elsewhere, and lists what is missing. The single measurements are those of
//! [`femdem_analysis`], re-exported here, which take plain data.
//!
//! ```
//! use femdem::analysis::{TableOptions, Tables};
//! use femdem::mesh::{Pose, catalogue::CatalogueShape};
//! use femdem::{Body, NamedShape, Snapshot};
//!
//! let polyhedron = "P5".parse::<CatalogueShape>()?.polyhedron(0.1)?;
//! let body = |z| Body { shape: 0, pose: Pose::translation(0.0, 0.0, z), sequence: 0, sleeping: false };
//! let snapshot = Snapshot {
//!     shapes: vec![NamedShape { name: "cube".to_owned(), polyhedron }],
//!     bodies: vec![body(0.03), body(0.1)],
//!     ..Snapshot::default()
//! };
//! let tables = Tables::compute(&snapshot, &TableOptions::default())?;
//! // Without masses no force can be compared with a weight, and the tables say so.
//! assert!(tables.force_maxima.is_none());
//! assert!(tables.missing.iter().any(|m| m.table == "force_maxima" && m.reason.contains("mass")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bodies;
mod contacts;
mod display;
mod files;
mod geometry;
mod network;
mod options;
mod orientation;
mod radial;
mod tables;

pub use femdem_analysis::*;

pub use bodies::BodyTable;
pub use files::{FOLDER, JSON};
pub use options::TableOptions;
pub use orientation::{Orientation, telling_axes};
pub use tables::{Missing, SCHEMA, Tables};
