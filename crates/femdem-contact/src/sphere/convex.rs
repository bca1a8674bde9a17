//! A ball and a convex polyhedron.
//!
//! The ball's field acts on the facets within the ball. The polyhedron's field phi_i = 1 + g_i . y, y from its centroid
//! and g_i = -n_i/h_i in the pyramid over facet i, acts on the part S of the sphere within the polyhedron. With D_i the
//! part of the ball in the pyramid, V_i its volume and M_i its first moment about the ball's centre, the divergence
//! theorem gives (x from the ball's centre, n = x/R on S; phi vanishes on the facets and is continuous between pyramids)
//!
//! int_S phi n dS = sum g_i V_i,   int_S phi x dS = R int_S phi n dS,   R int_S phi dS = 3 int phi dV + sum g_i . M_i,
//!
//! and for the moments of the stiffness per area n . grad phi, with A_f the faces of D_i other than S and their normals
//! n_f out of D_i,
//!
//! int_S n_k x_j dS = V_i delta_jk - sum_f n_k int x_j dA, and likewise for 1 and for x_i x_j.
//!
//! V_i and M_i are those of the ball, if its centre is in the pyramid, less what lies behind the faces ([`SolidSums`]).
//!
//! The stiffness of polyhedra counts nothing where n . grad phi is negative. Here it counts nothing for a pyramid over
//! whose part of the sphere the sum is negative, which differs only where the sphere is in touch on both sides of the
//! circle on which n . grad phi = 0: at edges sharper than 90 degrees, or pressed in deep beside an edge.

use super::disc::Disc;
use super::patch::{Face, Patch};
use super::sums::{FieldSums, SolidSums};
use crate::foundation::FoundationSums;
use crate::kernel::Point;
use crate::shape::ConvexShape;
use femdem_mesh::Vector3;
use smallvec::SmallVec;
use std::f64::consts::PI;

/// A ball centred inside the polyhedron is moved by this, over its radius, off the faces between the pyramids.
const ASIDE: [f64; 3] = [1.9e-11, 1.3e-11, 0.7e-11];

/// The part of the ball in the pyramid over a plane's facets.
#[derive(Debug, Clone, Copy)]
struct Cell {
    plane: u16,
    /// Gradient of phi, 1/m.
    slope: Vector3,
    /// V_i and M_i.
    volume: f64,
    moment: Vector3,
    /// Of the faces: sum g_i . n_f int dA, and with x and x x^T.
    faces: FoundationSums,
}

/// The polyhedron's field over the sphere.
#[derive(Debug, Default)]
struct OwnField {
    cells: SmallVec<[Cell; 4]>,
}

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
            own.cell(shape, facet.plane).add(&face, 1.0, &sums.1);
        }
    }
    for (edge, planes) in shape.edges.iter().zip(&shape.edge_planes) {
        own.add_between(shape, *edge, *planes, &near);
    }
    if inside {
        patch.add_centre(radius);
        let gauge = |k: u16| shape.planes[usize::from(k)].gauge.dot(&centre);
        let all = 0..shape.planes.len() as u16;
        if let Some(k) = all.max_by(|a, b| gauge(*a).total_cmp(&gauge(*b))) {
            own.cell(shape, k).volume += 4.0 / 3.0 * PI * radius.powi(3);
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

impl OwnField {
    fn cell(&mut self, shape: &ConvexShape, plane: u16) -> &mut Cell {
        let known = self.cells.iter().rposition(|cell| cell.plane == plane);
        let k = known.unwrap_or_else(|| {
            self.cells.push(Cell {
                plane,
                slope: -shape.planes[usize::from(plane)].gauge,
                volume: 0.0,
                moment: Vector3::zeros(),
                faces: FoundationSums::default(),
            });
            self.cells.len() - 1
        });
        &mut self.cells[k]
    }

    /// Adds the face between the pyramids on both sides of an edge, a triangle from the centroid.
    fn add_between(&mut self, shape: &ConvexShape, edge: [u16; 2], planes: [u16; 2], near: &Near) {
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
            self.cell(shape, planes[0]).add(&face, 1.0, &sums);
            self.cell(shape, planes[1]).add(&face, -1.0, &sums);
        }
    }

    /// Adds the field over the sphere to a patch that has the volume of the overlap.
    fn add_to(&self, patch: &mut Patch, centre: &Vector3, radius: f64) {
        let (mut force, mut along) = (Vector3::zeros(), 0.0);
        for cell in &self.cells {
            force += cell.slope * cell.volume;
            along += cell.slope.dot(&cell.moment);
            // Less than none where the sphere turns away from the field.
            if cell.faces.total < 0.0 {
                let across = cell.slope * cell.moment.transpose();
                patch.stiffness += FoundationSums {
                    total: -cell.faces.total,
                    first: cell.slope * cell.volume - cell.faces.first,
                    second: across + across.transpose() - cell.faces.second,
                };
            }
        }
        let energy = patch.volume + along + centre.dot(&force);
        let pressure = (3.0 * energy + along) / radius;
        patch.force -= force;
        patch.pressure += pressure;
        patch.moment += force * radius;
        patch.second += pressure * radius * radius;
        patch.energy += energy;
    }
}

impl Cell {
    /// Adds a face; `sign` is -1 if its normal points into the cell.
    fn add(&mut self, face: &Face, sign: f64, sums: &SolidSums) {
        let (n, side) = (&face.normal, face.side());
        self.volume -= sign * side * sums.volume;
        self.moment -= (n * sums.moment_normal + face.vector(&sums.moment) * side) * sign;
        let steep = sign * self.slope.dot(n);
        let first = face.foot() * sums.area + face.vector(&sums.first);
        self.faces += FoundationSums {
            total: steep * sums.area,
            first: first * steep,
            second: face.second(sums.area, &sums.first, &sums.second) * steep,
        };
    }
}
