//! From loose facets to a body: welding, orientation, checks that name the facets, and mending of
//! what is nearly fine, on request and with a report.
//!
//! All readers of [`io`](crate::io) end here. [`solid`] takes facets from any other source.
//!
//! Without [`Options::repair`], only what leaves the surface as it is gets done: vertices at the
//! same place are joined, vertices without a facet are dropped, and neighbours are made to look to
//! the same side. Everything else is an error that names the facets, counted from 0 in the order
//! of the file. With it, what follows is mended as well and counted in the [`Report`]: facets
//! without area, facets given twice, vertices that lie on an edge of another facet, gaps up to
//! [`REPAIR_WELD`], polygons that are not planar, and surfaces that are inside out. Holes are never
//! filled, and surfaces that cut through themselves are always refused.

mod clean;
mod facets;
mod orient;
mod report;
mod seams;
mod weld;

pub use facets::FacetList;
pub use report::Report;

use crate::polyhedron::{check_coordinates, check_counts};
use crate::{MeshError, Point3, Polyhedron};
use clean::Surface;

/// Default welding distance of formats that hold loose triangles, as part of the diagonal of the
/// bounding box: that of coordinates of six or seven digits, and below what counts as planar.
pub const LOOSE_WELD: f64 = 1e-6;

/// Default welding distance when repair is asked for, as part of the diagonal of the bounding box.
pub const REPAIR_WELD: f64 = 1e-5;

/// How facets become a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Vertices nearer to each other than this part of the bounding box's diagonal become one: the
    /// first of them. 0, or from 1e-9 to 1e-2; with 0, vertices of equal coordinates are welded.
    ///
    /// If not given: [`REPAIR_WELD`] with repair, else [`LOOSE_WELD`] for STL and 0 for formats
    /// whose facets share vertices by number.
    pub weld: Option<f64>,
    /// What is done about facets that look to different sides.
    pub orient: Orient,
    /// Whether facets that spoil a surface which is nearly fine are mended or dropped.
    pub repair: bool,
}

/// What is done about the side to which facets look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orient {
    /// Nothing: neighbours that disagree are refused, and so are surfaces that are inside out.
    Keep,
    /// Neighbours are made to agree; if they had to be, the surface is then turned outward. A
    /// surface that agrees with itself and is inside out is refused, unless repair is asked for.
    #[default]
    Consistent,
    /// Neighbours are made to agree, and the surface is turned outward.
    Outward,
}

impl Options {
    /// Welds, orients, and mends what is nearly fine.
    pub const REPAIR: Self = Self {
        weld: None,
        orient: Orient::Outward,
        repair: true,
    };

    fn weld_or(&self, default: f64) -> Result<f64, MeshError> {
        let default = if self.repair { REPAIR_WELD } else { default };
        let weld = self.weld.unwrap_or(default);
        if weld == 0.0 || (1e-9..=1e-2).contains(&weld) {
            return Ok(weld);
        }
        Err(MeshError::OutOfRange {
            what: "the welding distance by the diagonal of the bounding box",
            value: weld,
            allowed: "0, or 1e-9 to 1e-2",
        })
    }
}

/// Makes a body of facets: loops of vertex numbers, which need not be oriented.
///
/// Vertices are welded as for formats that share vertices by number.
///
/// # Errors
///
/// Names the facets that do not belong to one closed, manifold surface without folds or cuts
/// through itself; also if a coordinate is not finite, or the options are out of range.
pub fn solid(
    points: Vec<Point3>,
    facets: Vec<Vec<u32>>,
    options: &Options,
) -> Result<(Polyhedron, Report), MeshError> {
    close(points, facets, options, 0.0)
}

/// As [`solid`], with the welding distance of the format.
pub(crate) fn close(
    points: Vec<Point3>,
    facets: Vec<Vec<u32>>,
    options: &Options,
    default_weld: f64,
) -> Result<(Polyhedron, Report), MeshError> {
    let weld = options.weld_or(default_weld)?;
    let mut report = Report::new(points.len(), facets.len());
    let mut surface = Surface::new(points, facets)?;
    report.vertices_unused = surface.compact();
    let distance = weld * check_coordinates(&surface.points)?;

    report.vertices_welded = surface.weld(distance);
    report.facets_without_area = surface.drop_degenerate(options.repair)?;
    report.facets_given_twice = surface.drop_duplicates(options.repair)?;
    if options.repair {
        (report.seams_joined, report.facets_split) = surface.join_seams(distance);
    }
    surface.compact();
    if options.repair {
        report.facets_split += surface.split_bent()?;
    }
    check_counts(surface.points.len(), surface.loops.len())?;
    surface.check_edges()?;
    if options.orient != Orient::Keep || options.repair {
        report.facets_flipped = surface.orient()?;
        let outward = options.repair || options.orient == Orient::Outward;
        if outward || report.facets_flipped > 0 {
            report.turned_outward = surface.turn_outward();
        }
    }
    Ok((surface.into_body()?, report))
}

#[cfg(test)]
mod tests;
