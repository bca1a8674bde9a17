//! Everything that can be measured of a pack, and its files.
//!
//! [`Tables::compute`] makes every measurement that the data of a [`Snapshot`](crate::Snapshot) allow, from a
//! simulation or from elsewhere, and lists what is missing. The single measurements are those of
//! [`femdem_analysis`], which take plain data.
//!
//! ```
//! use femdem_mesh::{Pose, catalogue::CatalogueShape};
//! use femdem_view::tables::{TableOptions, Tables};
//! use femdem_view::{Body, NamedShape, Snapshot};
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

mod all;
mod bodies;
mod contacts;
mod display;
mod fields;
mod files;
mod geometry;
mod mixing;
mod network;
mod options;
mod orientation;
mod radial;

pub use all::{Missing, SCHEMA, Tables};
pub use bodies::BodyTable;
pub use files::{FOLDER, JSON};
pub use mixing::MixingSeries;
pub(crate) use options::SAME_SIZE;
pub use options::TableOptions;
pub use orientation::{Orientation, telling_axes};
