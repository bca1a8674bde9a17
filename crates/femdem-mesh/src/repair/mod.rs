//! From loose facets to a body: welding, orientation, checks that name the facets, and, on request, repair of
//! small faults with a report.
//!
//! All readers of [`io`](crate::io) use this module. [`solid`] takes facets from any other source.
//!
//! Without [`Options::repair`], only operations that do not change the surface are done: vertices at the same
//! place are joined, vertices without a facet are dropped, and neighbours are given the same orientation.
//! Everything else is an error that names the facets, counted from 0 in the order of the file. With repair, the
//! following faults are mended and counted in the [`Report`]: facets without area, facets given twice, vertices
//! that lie on an edge of another facet, gaps up to [`REPAIR_WELD`], polygons that are not planar, and surfaces
//! that are inside out. Holes are never filled, and surfaces that cut through themselves are always refused, as are
//! several closed shells: hollow bodies, and bodies beside each other, whether they touch or not.

mod clean;
mod facets;
mod orient;
mod report;
mod seams;
mod shells;
mod weld;

pub use facets::FacetList;
pub use report::Report;

use crate::polyhedron::{check_coordinates, check_counts};
use crate::{MeshError, Point3, Polyhedron};
use clean::Surface;

/// Default welding distance of formats with loose triangles, as part of the diagonal of the bounding box: the
/// precision of coordinates with six or seven digits, and below the planarity tolerance.
pub const LOOSE_WELD: f64 = 1e-6;

/// Default welding distance with repair, as part of the diagonal of the bounding box.
pub const REPAIR_WELD: f64 = 1e-5;

/// How facets become a body.
///
/// ```
/// use femdem_mesh::Point3;
/// use femdem_mesh::repair::{Options, Orient, solid};
///
/// // A tetrahedron as loose facets, one of them turned inside out.
/// let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from).to_vec();
/// let facets = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 2, 3]];
/// let as_given = Options { orient: Orient::Keep, ..Options::default() };
/// assert!(solid(corners.clone(), facets.clone(), &as_given).is_err());
/// let (body, _report) = solid(corners, facets, &Options::default())?;
/// assert!((body.mass_properties().volume - 1.0 / 6.0).abs() < 1e-15);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Vertices nearer to each other than this part of the bounding box's diagonal become one: the
    /// first of them. 0, or from 1e-9 to 1e-2; with 0, vertices of equal coordinates are welded.
    ///
    /// Default: [`REPAIR_WELD`] with repair, else [`LOOSE_WELD`] for STL and 0 for formats whose facets share
    /// vertices by number.
    pub weld: Option<f64>,
    /// Treatment of facets with inconsistent orientation.
    pub orient: Orient,
    /// Whether faulty facets of a surface with small faults are mended or dropped.
    pub repair: bool,
}

/// Treatment of the orientation of facets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Orient {
    /// Nothing: neighbours that disagree are refused, and so are surfaces that are inside out.
    Keep,
    /// Neighbours are made consistent; if any facet was reversed for that, the surface is then turned outward.
    /// A consistent surface that is inside out is refused, unless repair is on.
    #[default]
    Consistent,
    /// Neighbours are made consistent, and the surface is turned outward.
    Outward,
}

impl Options {
    /// Welds, orients, and mends small faults.
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

/// Makes a body from facets: loops of vertex numbers, which need not be oriented.
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

    let shells = surface.closed_shells();
    report.vertices_welded = surface.weld(distance);
    report.facets_without_area = surface.drop_degenerate(options.repair)?;
    report.facets_given_twice = match surface.drop_duplicates(options.repair) {
        Ok(count) => count,
        Err(error) => return Err(surface.given_twice(shells, error)),
    };
    if options.repair {
        (report.seams_joined, report.facets_split) = surface.join_seams(distance);
    }
    surface.compact();
    if options.repair {
        report.facets_split += surface.split_bent()?;
    }
    check_counts(surface.points.len(), surface.loops.len())?;
    let touching = |error| shells::touching(shells, error);
    surface.check_edges().map_err(touching)?;
    if options.orient != Orient::Keep || options.repair {
        report.facets_flipped = surface.orient()?;
        let outward = options.repair || options.orient == Orient::Outward;
        if outward || report.facets_flipped > 0 {
            report.turned_outward = surface.turn_outward();
        }
    }
    Ok((surface.into_body().map_err(touching)?, report))
}

#[cfg(test)]
mod tests;
