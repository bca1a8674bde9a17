//! A ball and a convex polyhedron.
//!
//! The ball's field acts on the facets within the ball, and the polyhedron's, phi = 1 - n_i . y/h_i in the pyramid over
//! facet i, y from its centroid, [on the sphere within it](super::field).

use super::disc::Disc;
use super::field::{ASIDE, Linear, OwnField};
use super::patch::{Face, Patch};
use super::sums::{FieldSums, SolidSums};
use crate::kernel::Point;
use crate::shape::ConvexShape;
use femdem_mesh::Vector3;
use smallvec::SmallVec;

/// A lower bound of the distance of a ball from a convex polyhedron, m, and the normal of the plane between them.
pub(super) fn gap(shape: &ConvexShape, centre: &Vector3, radius: f64) -> (f64, Vector3) {
    let planes = shape.planes.iter();
    let gaps = planes.map(|p| (p.normal.dot(centre) - p.offset - radius, p.normal));
    gaps.fold((f64::NEG_INFINITY, Vector3::z()), |most, gap| {
        if gap.0 > most.0 { gap } else { most }
    })
}

/// The sums over a convex polyhedron for a ball at `centre` in its axes.
pub(super) fn patch(shape: &ConvexShape, centre: &Vector3, radius: f64) -> Patch {
    // By the heights over the facets, which decide below what lies behind them.
    let holds = |x: &Vector3| gap(shape, x, 0.0).0 < 0.0;
    let centre = if holds(centre) {
        centre + Vector3::from(ASIDE) * radius
    } else {
        *centre
    };
    let inside = holds(&centre);
    let near = Near::new(&centre, radius);
    let mut patch = Patch::default();
    let mut own = OwnField::default();
    for facet in &shape.facets {
        let plane = &shape.planes[usize::from(facet.plane)];
        let height = plane.offset - plane.normal.dot(&centre);
        let Some(disc) = Disc::new(radius, height) else {
            continue;
        };
        let foot = facet.frame.point(&centre);
        let about_foot = |p: &Point| Point {
            x: p.x - foot.x,
            y: p.y - foot.y,
        };
        let corners = shape.polygon(facet).iter();
        let polygon: SmallVec<[Point; 8]> = corners.map(about_foot).collect();
        let mut sums = (FieldSums::default(), SolidSums::default());
        if disc.add_polygon(&polygon, &mut sums) {
            let face = Face::along(plane.normal, height, &facet.frame);
            patch.add_face(&disc, &face, &sums.0, &sums.1);
            own.cell(facet.plane.into(), || field(shape, facet.plane))
                .add(&face, 1.0, &sums.1);
        }
    }
    for (edge, planes) in shape.edges.iter().zip(&shape.edge_planes) {
        add_between(&mut own, shape, *edge, *planes, &near);
    }
    if inside {
        patch.add_centre(radius);
        let gauge = |k: u16| shape.planes[usize::from(k)].gauge.dot(&centre);
        let all = 0..shape.planes.len() as u16;
        if let Some(k) = all.max_by(|a, b| gauge(*a).total_cmp(&gauge(*b))) {
            own.cell(k.into(), || field(shape, k)).add_centre(radius);
        }
    }
    own.add_to(&mut patch, &centre, radius);
    patch
}

/// A ball and the side on which it may reach the polyhedron.
struct Near {
    centre: Vector3,
    radius: f64,
    /// Every point in the ball has at least this product with the centre, m^2.
    least: f64,
}

impl Near {
    fn new(centre: &Vector3, radius: f64) -> Self {
        let distance = centre.norm();
        Self {
            centre: *centre,
            radius,
            least: distance * (distance - radius),
        }
    }
}

/// The field in the pyramid over a plane's facets.
fn field(shape: &ConvexShape, plane: u16) -> Linear {
    Linear {
        level: 1.0,
        slope: -shape.planes[usize::from(plane)].gauge,
    }
}

/// Adds the face between the pyramids on both sides of an edge, a triangle from the centroid.
fn add_between(
    own: &mut OwnField,
    shape: &ConvexShape,
    edge: [u16; 2],
    planes: [u16; 2],
    near: &Near,
) {
    let [p, q] = edge.map(|v| shape.vertices()[usize::from(v)]);
    let reach = near.centre.dot(&p).max(near.centre.dot(&q)).max(0.0);
    if planes[0] == planes[1] || reach < near.least {
        return;
    }
    let Some(normal) = q.cross(&p).try_normalize(0.0) else {
        return;
    };
    let height = -normal.dot(&near.centre);
    let Some(disc) = Disc::new(near.radius, height) else {
        return;
    };
    let face = Face::new(normal, height);
    // Counter-clockwise about this normal: from the centroid to q and p.
    let at = |x: &Vector3| face.frame.point(&(x - near.centre));
    let polygon = [at(&Vector3::zeros()), at(&q), at(&p)];
    let mut sums = SolidSums::default();
    if disc.add_polygon(&polygon, &mut sums) {
        for (k, sign) in planes.into_iter().zip([1.0, -1.0]) {
            own.cell(k.into(), || field(shape, k))
                .add(&face, sign, &sums);
        }
    }
}
