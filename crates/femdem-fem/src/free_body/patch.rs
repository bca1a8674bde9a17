//! The force of a contact, spread over the patch on which it acts.

use super::FreeBody;
use super::place::Place;
use crate::error::{FemError, check};
use femdem_mesh::tet::MID_EDGES;
use femdem_mesh::{Matrix3, Point3, Pose, Vector3};

/// Force and moment of a contact on a body, and the disc over which they are spread. In the coordinates of the body's mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatchLoad {
    /// Middle of the disc, where the force acts, m.
    pub point: Point3,
    /// Normal of the disc, of any length but 0.
    pub normal: Vector3,
    /// Area of the disc, m^2; 0 is a point.
    pub area: f64,
    /// Force on the body, N.
    pub force: Vector3,
    /// Moment on the body about the point, N m.
    pub moment: Vector3,
}

impl PatchLoad {
    /// Radius of the disc, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        (self.area / std::f64::consts::PI).sqrt()
    }

    /// The same in the coordinates that `pose` takes to those in which it is given.
    #[must_use]
    pub fn seen_from(&self, pose: &Pose) -> Self {
        let back = pose.inverse();
        Self {
            point: back * self.point,
            normal: back * self.normal,
            area: self.area,
            force: back * self.force,
            moment: back * self.moment,
        }
    }

    pub(super) fn check(&self) -> Result<(), FemError> {
        let fields = [
            ("a coordinate of the point of a load", self.point.coords),
            ("a component of a load's force", self.force),
            ("a component of a load's moment", self.moment),
        ];
        for (name, vector) in fields {
            for &value in vector.iter() {
                check(name, value, true, "finite")?;
            }
        }
        let length = self.normal.norm();
        check("length of a load's normal", length, length > 0.0, "above 0")?;
        check(
            "area of a load",
            self.area,
            self.area >= 0.0,
            "0 or more, in m^2",
        )
    }
}

/// Least radius of a disc over the length of an edge: the moment of a point needs levers.
const LEAST_RADIUS: f64 = 1e-3;
/// Points on a line, by the smallest over the largest principal moment of their places.
const SAME_LINE: f64 = 1e-9;
/// Points in one place, by the root mean square of their levers over the length of an edge: beyond a corner all act at it, and
/// their levers are rounding.
const SAME_PLACE: f64 = 1e-6;
/// Most rings of points in a disc.
const MOST_RINGS: usize = 12;

impl FreeBody {
    /// Adds the nodal forces (N) of a load, by node of the model. They have its force and moment.
    ///
    /// The disc carries equal forces, and forces in proportion to the distance from its middle that make up the moment: on
    /// points q of equal area, t = F/n + b x (q - c) with their mean c. Points of the disc beside the body are left out, each with
    /// the one opposite, so that the middle stays; those above the skin act at the nearest point of the body. Each force goes to the
    /// nodes of its tetrahedron by their shape functions. Where all points lie on a line, as beside an edge, the moment about that
    /// line is left out, and where they lie in one place, as beyond a corner, all of it; the force is kept.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for numbers that mean nothing, for a disc none of whose points finds a place on the body, and for
    /// another length of `forces` than the model's nodes.
    pub fn add_patch(&self, load: &PatchLoad, forces: &mut [Vector3]) -> Result<(), FemError> {
        load.check()?;
        self.check_length(forces.len())?;
        let places = self.places_of(load);
        let count = places.len() as f64;
        check(
            "number of points of a disc on the body",
            count,
            count > 0.0,
            "above 0",
        )?;
        let share = 1.0 / count;
        let middle: Vector3 = places.iter().map(|p| p.point.coords * share).sum();
        let mut arms: Vec<Vector3> = places
            .iter()
            .map(|place| place.point.coords - middle)
            .collect();
        // The mean again: what rounding of the coordinates leaves in the sum would turn into a force.
        let left: Vector3 = arms.iter().map(|r| r * share).sum();
        for arm in &mut arms {
            *arm -= left;
        }
        // sum of r x (b x r) = J b.
        let levers: Matrix3 = arms
            .iter()
            .map(|r| Matrix3::identity() * r.norm_squared() - r * r.transpose())
            .sum();
        let rest = load.moment - (middle - load.point.coords).cross(&load.force);
        // About the line of points on a line, and about points in one place, nothing turns.
        let least = f64::max(
            SAME_LINE * levers.norm(),
            (SAME_PLACE * self.edge).powi(2) * count,
        );
        let principal = levers.symmetric_eigen();
        let axes = principal
            .eigenvalues
            .iter()
            .zip(principal.eigenvectors.column_iter());
        let turn: Vector3 = axes
            .filter(|(moment, _)| **moment > least)
            .map(|(moment, axis)| axis * (axis.dot(&rest) / moment))
            .sum();
        let (mut sum, mut sizes) = (Vector3::zeros(), 0.0);
        for (place, arm) in places.iter().zip(&arms) {
            let force = load.force * share + turn.cross(arm);
            for (node, weight) in self.weights(place) {
                let own = force * weight;
                forces[node as usize] += own;
                sum += own;
                sizes += own.norm();
            }
        }
        debug_assert!(
            (sum - load.force).norm() <= 1e-9 * load.force.norm() + 1e-12 * sizes,
            "the nodal forces of {load:?} sum to {sum:?}"
        );
        Ok(())
    }

    /// Places of points of equal area in the disc of a load.
    fn places_of(&self, load: &PatchLoad) -> Vec<Place> {
        let normal = load.normal.normalize();
        let radius = load.radius().max(LEAST_RADIUS * self.edge);
        let rings = ((2.0 * radius / self.edge).ceil() as usize + 1).clamp(2, MOST_RINGS);
        let width = radius / rings as f64;
        // Two directions in the disc: across the axis farthest from the normal.
        let across = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        let along = normal.cross(&across);
        let (mut all, mut over) = (Vec::new(), Vec::new());
        for ring in 0..rings {
            // Ring k has 2 k + 1 times the area of the first; its points are at its root mean square radius.
            let [inner, outer] = [ring, ring + 1].map(|k| (k as f64 * width).powi(2));
            let r = (0.5 * (inner + outer)).sqrt();
            let half = 3 * (2 * ring + 1);
            let at = |k: usize| {
                let (sin, cos) = (std::f64::consts::PI * (k as f64 + 0.5) / half as f64).sin_cos();
                let x = load.point + (across * cos + along * sin) * r;
                let place = self.places.nearest(&x)?;
                let way = place.point - x;
                let aside = (way - normal * way.dot(&normal)).norm();
                Some((place, aside <= 0.5 * width))
            };
            for k in 0..half {
                let (Some(one), Some(opposite)) = (at(k), at(k + half)) else {
                    continue;
                };
                all.extend([one.0, opposite.0]);
                if one.1 && opposite.1 {
                    over.extend([one.0, opposite.0]);
                }
            }
        }
        if over.is_empty() { all } else { over }
    }

    /// Shape functions at a place: nodes with their weights.
    fn weights(&self, place: &Place) -> impl Iterator<Item = (u32, f64)> {
        let l = place.coordinates;
        let quadratic = self.model.element().is_quadratic();
        let corner = move |i: usize| {
            if quadratic {
                l[i] * (2.0 * l[i] - 1.0)
            } else {
                l[i]
            }
        };
        let middles = MID_EDGES.iter().map(move |&[i, j]| 4.0 * l[i] * l[j]);
        let weights = (0..4).map(corner).chain(middles);
        // Linear elements have the corners alone.
        self.nodes_of(place.tet).iter().copied().zip(weights)
    }
}
