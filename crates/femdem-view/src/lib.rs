//! What people see of a pack of bodies: tables, files for other programs, pictures, plots and a page.
//!
//! Everything starts from a [`Snapshot`], which is plain data: shapes, poses, and contacts if they are known. It
//! may come from femdem, from tables on disk ([`input`]) or from another code.
//!
//! **Use it** to write, measure, draw and show packs of rigid bodies of any shape, without a simulation, a GPU or a
//! display. **Do not use it** for interactive graphics in a program of your own, for fields inside deformable bodies
//! (their surfaces can be drawn, [`picture::draw_skins`]), or if you want numbers only (femdem-analysis has them, and
//! fewer dependencies).
//!
//! ```
//! use femdem_mesh::{Pose, catalogue::{CatalogueShape, Solid}};
//! use femdem_view::picture::{PictureOptions, draw};
//! use femdem_view::{Body, NamedShape, Snapshot, output};
//!
//! // Two cubes, one on the other.
//! let polyhedron = CatalogueShape::from(Solid::P5).polyhedron(3_f64.sqrt())?;
//! let body = |sequence: u32| {
//!     let pose = Pose::translation(0.0, 0.0, f64::from(sequence) + 0.5);
//!     Body { shape: 0, pose, sequence, sleeping: false }
//! };
//! let snapshot = Snapshot {
//!     shapes: vec![NamedShape { name: "cube".to_owned(), polyhedron }],
//!     bodies: vec![body(0), body(1)],
//!     ..Snapshot::default()
//! };
//!
//! let mut table = Vec::new();
//! output::csv::write_bodies(&snapshot, &mut table)?;
//! assert!(table.starts_with(b"id,shape,x,y,z,"));
//! let image = draw(&snapshot, &PictureOptions { width: 200, height: 200, ..Default::default() })?;
//! image.write_png(std::io::sink())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is where
//! - [`Snapshot`] with [`Body`], [`NamedShape`], [`ContactRow`]; what its source did not contain is in [`Gaps`].
//! - [`CrackFacet`], [`CrackEvent`], [`FragmentRow`]: cracks and fragments; [`Fracture`]: what a page shows of them.
//! - [`input`]: a snapshot from tables and surface files.
//! - [`tables`]: everything that femdem-analysis can measure of a snapshot, with what is missing and why.
//! - [`output`]: CSV, STL, OBJ, and VTU, VTP, VTI and PVD for ParaView.
//! - [`picture`]: pictures as PNG, by a rasteriser of its own; [`Colouring`]: what bodies can be coloured by.
//! - [`plot`]: plots of the tables as SVG. [`report`]: one page for the browser, with a view in three dimensions.
//! - [`analysis`] and [`mesh`]: femdem-analysis and femdem-mesh, whose types appear in the interfaces.
//!
//! # Units
//! SI: m, kg, s, N, J, Pa. d is the circumscribed diameter of a body; gravity acts along −z.
//!
//! # Features
//! - `parallel` (default): measure on the caller's rayon pool. Results are the same bits with any number of threads
//!   and without the feature. Pictures always use the pool, and are the same, too.
//!
//! # Accuracy
//! CSV files have all digits, VTU, VTP and VTI double precision, STL single. In the page positions are fractions of
//! the pack in 16 bits, far finer than a pixel. The same snapshot gives the same bytes on every machine of a kind.

mod colouring;
mod drawing;
mod error;
mod fracture;
pub mod input;
pub mod output;
pub mod picture;
pub mod plot;
pub mod report;
mod snapshot;
pub mod tables;
#[cfg(test)]
mod testing;
mod ticks;

pub use femdem_analysis as analysis;
pub use femdem_mesh as mesh;

pub use colouring::{BodyValues, Colouring, Spacing};
pub use drawing::{Drawing, sharp_edges};
pub use error::ViewError;
pub use fracture::{CrackEvent, CrackFacet, CrackMode, Fracture, FragmentRow};
pub use snapshot::{Body, BodyLoad, ContactRow, Gaps, NamedShape, Partner, Snapshot};
