//! Pictures of a pack, drawn without a GPU.
//!
//! Triangles are drawn into a depth buffer. Then each pixel is lit by a lamp with soft shadows and by a sky
//! that is less visible from narrow gaps, and the edges of bodies and faces are drawn. Bodies are coloured by
//! sequence of placement with viridis, which is perceptually uniform.
//!
//! ```
//! use femdem_mesh::{Pose, catalogue::Solid, catalogue::CatalogueShape};
//! use femdem_view::picture::{PictureOptions, draw};
//! use femdem_view::{Body, NamedShape, Snapshot};
//!
//! let polyhedron = CatalogueShape::from(Solid::A10).polyhedron(0.1)?;
//! let body = Body { shape: 0, pose: Pose::identity(), sequence: 0, sleeping: false };
//! let shapes = vec![NamedShape { name: "A10".to_owned(), polyhedron }];
//! let snapshot = Snapshot { shapes, bodies: vec![body], ..Snapshot::default() };
//! let image = draw(&snapshot, &PictureOptions { width: 200, height: 200, ..Default::default() })?;
//! image.write_png(std::io::sink())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod canvas;
mod colour;
mod font;
mod gallery;
mod legend;
mod light;
mod options;
mod pack;
mod paint;
mod raster;
mod scale_bar;
mod scene;
mod shade;
mod skin;
mod view;

pub use canvas::Image;
pub(crate) use canvas::viridis_png;
pub use gallery::{Exhibit, gallery};
pub use options::PictureOptions;
pub use pack::{draw, draw_by};
pub use skin::{Skin, draw_skins};

pub use crate::drawing::{circle, sides};
