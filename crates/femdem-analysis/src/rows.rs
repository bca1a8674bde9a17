//! Where rows of cell centres along x run inside a body, and inside a region.

use std::ops::Range;

use femdem_mesh::{Point3, Vector3};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::lines::{convex_span, crossing};
use crate::pack::Pack;
use crate::region::Region;

/// Memory of [`spans_of_body`].
#[derive(Default)]
pub(crate) struct RowScratch {
    planes: Vec<(Vector3, f64)>,
    /// Where rows cross a surface of triangles: row and x.
    crossings: Vec<(usize, f64)>,
}

/// Calls `hit(row, low, high)` with the intervals of x in which the rows at height `z` run inside a body.
pub(crate) fn spans_of_body(
    scratch: &mut RowScratch,
    pack: &Pack,
    body: usize,
    y_axis: &Axis,
    z: f64,
    mut hit: impl FnMut(usize, f64, f64),
) {
    if pack.by_planes(body) {
        let bounds = pack.bounds(body);
        scratch.planes.clear();
        scratch.planes.extend(pack.world_planes(body));
        for row in y_axis.within(bounds.min.y, bounds.max.y) {
            let at = Point3::new(0.0, y_axis.centre(row), z);
            if let Some((low, high)) = convex_span(&scratch.planes, 0, &at) {
                hit(row, low, high);
            }
        }
        return;
    }
    let crossings = &mut scratch.crossings;
    crossings.clear();
    let slab = Bounds::slab(2, z, z);
    pack.triangles_in(body, &slab, |triangle| {
        let bounds = Bounds::around(triangle);
        // A missing triangle would leave its row with an odd number of crossings.
        for row in y_axis.near(bounds.min.y, bounds.max.y) {
            let at = Point3::new(0.0, y_axis.centre(row), z);
            let x = crossing(&triangle, 0, &at);
            crossings.extend(x.map(|x| (row, x)));
        }
    });
    crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    for row in crossings.chunk_by(|a, b| a.0 == b.0) {
        for pair in row.chunks_exact(2) {
            hit(pair[0].0, pair[0].1, pair[1].1);
        }
    }
}

/// Cells of the row at `y` and `z` whose centres lie in the region, of a grid over it.
pub(crate) fn cells_in_region(region: &Region, x_axis: &Axis, y: f64, z: f64) -> Range<usize> {
    match *region {
        Region::Box { .. } => 0..x_axis.count,
        Region::Cylinder { centre, radius, .. } => {
            let half = (radius * radius - (y - centre[1]).powi(2)).max(0.0).sqrt();
            x_axis.within(centre[0] - half, centre[0] + half)
        }
        Region::Sphere { centre, radius } => {
            let off_axis = (y - centre.y).powi(2) + (z - centre.z).powi(2);
            let square = radius * radius - off_axis;
            if square < 0.0 {
                return 0..0;
            }
            x_axis.within(centre.x - square.sqrt(), centre.x + square.sqrt())
        }
    }
}
