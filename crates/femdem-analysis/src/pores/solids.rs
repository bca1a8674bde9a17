//! The bodies of a pack as solids with exact signed distances.

use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};

use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::Region;
use crate::segment::on_segment;

/// What the upright sides of a region are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Walls, as those of a container: distances and pores end there.
    Wall,
    /// Nothing: the pack goes on beyond.
    Open,
}

/// The bodies of a pack, some of which may be exact balls.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, pores::Solids};
/// use femdem_mesh::{Point3, Pose, shapes::{Shape, Sphere}};
///
/// let facets = [Shape::from(Sphere::default()).polyhedron(2.0)?];
/// let body = [PosedBody { shape: 0, pose: Pose::identity() }];
/// let pack = Pack::new(&facets, &body)?;
/// let ball = Solids::new(&pack).with_balls(&[Some(1.0)])?;
/// assert_eq!(ball.signed_distance(&Point3::new(0.0, 3.0, 4.0)), 4.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Solids<'a> {
    pack: &'a Pack<'a>,
    /// Radius of each body that is a ball (m).
    balls: Vec<Option<f64>>,
    bounds: Vec<Bounds>,
    centroids: Vec<Point3>,
    /// Corners of the faces of each shape that is handled by its planes, body frame.
    faces: Vec<Vec<Vec<Point3>>>,
    tree: Bvh,
}

impl<'a> Solids<'a> {
    /// The bodies as the polyhedra they are given as.
    pub fn new(pack: &'a Pack<'a>) -> Self {
        let bounds: Vec<Bounds> = (0..pack.len()).map(|i| *pack.bounds(i)).collect();
        let corners = |shape: usize| {
            let polyhedron = &pack.shapes()[shape];
            let place = |v: &u32| polyhedron.vertices()[*v as usize];
            if pack.shape_by_planes(shape) {
                let face = |f: &[u32]| f.iter().map(place).collect();
                polyhedron.faces().map(face).collect()
            } else {
                Vec::new()
            }
        };
        Self {
            balls: vec![None; pack.len()],
            tree: tree_of(&bounds),
            bounds,
            centroids: pack.centroids(),
            faces: (0..pack.shapes().len()).map(corners).collect(),
            pack,
        }
    }

    /// Takes bodies of some shapes as exact balls: a radius (m) about the origin of the shape's frame, or `None`,
    /// for each shape of the pack.
    ///
    /// # Errors
    /// [`AnalysisError::BallCount`] unless there is one entry per shape, [`AnalysisError::Option`] for a radius
    /// that is not above zero and finite.
    pub fn with_balls(mut self, radii: &[Option<f64>]) -> Result<Self, AnalysisError> {
        let shapes = self.pack.shapes().len();
        if radii.len() != shapes {
            let given = radii.len();
            return Err(AnalysisError::BallCount { given, shapes });
        }
        for radius in radii.iter().flatten() {
            if !(*radius > 0.0 && radius.is_finite()) {
                return Err(AnalysisError::Option {
                    name: "radius",
                    value: *radius,
                    allowed: "above zero and finite (m)",
                });
            }
        }
        for (i, body) in self.pack.bodies().iter().enumerate() {
            if let Some(radius) = radii[body.shape as usize] {
                let centre = Point3::from(self.pack.pose(i).translation.vector);
                self.balls[i] = Some(radius);
                self.centroids[i] = centre;
                self.bounds[i] = Bounds {
                    min: centre.map(|x| x - radius),
                    max: centre.map(|x| x + radius),
                };
            }
        }
        self.tree = tree_of(&self.bounds);
        Ok(self)
    }

    /// The pack that the solids are of.
    pub fn pack(&self) -> &'a Pack<'a> {
        self.pack
    }

    /// Signed distance (m) of a point from the solids: to the nearest surface outside, minus the depth in the
    /// body in which the point lies deepest inside. Exact to round-off, except that the depth is less than that in
    /// the union where bodies overlap. Infinite without bodies.
    pub fn signed_distance(&self, point: &Point3) -> f64 {
        let mut near = Vec::new();
        self.near(point, 0.0, &mut near);
        self.least(point, &near)
    }

    /// The bodies that can be the nearest to a point within `reach` of `point`, the nearest to `point` first.
    pub(super) fn near(&self, point: &Point3, reach: f64, found: &mut Vec<(f64, usize)>) {
        found.clear();
        let square = |i: u32| {
            let d = self.signed(i as usize, point, f64::INFINITY).max(0.0);
            d * d
        };
        let Some((_, square)) = self.tree.nearest(point, square) else {
            return;
        };
        // More than the round-off of the square's root.
        let limit = (square.sqrt() + 2.0 * reach) * (1.0 + 1e-12) + f64::MIN_POSITIVE;
        let mut least = f64::INFINITY;
        let enter = |aabb: &Aabb| aabb.distance_squared(point) <= limit * limit;
        self.tree.visit(enter, |i| {
            let body = i as usize;
            let d = self.signed(body, point, f64::INFINITY);
            least = least.min(d);
            found.push((d, body));
        });
        let limit = least + 2.0 * reach;
        found.retain(|(d, _)| *d <= limit);
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }

    /// The least signed distance from some bodies.
    pub(super) fn least(&self, point: &Point3, bodies: &[(f64, usize)]) -> f64 {
        let mut least = f64::INFINITY;
        for (_, body) in bodies {
            least = least.min(self.signed(*body, point, least));
        }
        least
    }

    pub(super) fn ball(&self, body: usize) -> Option<f64> {
        self.balls[body]
    }

    pub(super) fn bounds(&self, body: usize) -> &Bounds {
        &self.bounds[body]
    }

    /// Centroid of a body (m).
    pub(super) fn centroid(&self, body: usize) -> &Point3 {
        &self.centroids[body]
    }

    /// Signed distance of a point from one body, or any number of at least `limit` if it is not below that.
    fn signed(&self, body: usize, point: &Point3, limit: f64) -> f64 {
        let from_centre = (point - self.centroids[body]).norm();
        if let Some(radius) = self.balls[body] {
            return from_centre - radius;
        }
        let bound = from_centre - self.pack.shape(body).bounding_radius();
        if bound >= limit {
            return bound;
        }
        if self.pack.by_planes(body) {
            let local = self.pack.pose(body).inverse_transform_point(point);
            let faces = &self.faces[self.pack.bodies()[body].shape as usize];
            return signed_convex(self.pack.planes(body), faces, &local, limit);
        }
        let distance = (self.pack.nearest_on_surface(body, point) - point).norm();
        if self.pack.holds(body, point) {
            -distance
        } else {
            distance
        }
    }
}

fn tree_of(bounds: &[Bounds]) -> Bvh {
    let boxed = |b: &Bounds| Aabb {
        low: b.min,
        high: b.max,
    };
    Bvh::new(&bounds.iter().map(boxed).collect::<Vec<_>>())
}

/// Signed distance from a convex body by its faces, or any number of at least `limit`.
///
/// Inside it is the largest distance from a plane. Outside, the nearest point lies on a face that the point is in
/// front of, and on the one it is farthest in front of if its foot there lies in the face.
fn signed_convex(
    planes: &[(Vector3, f64)],
    faces: &[Vec<Point3>],
    point: &Point3,
    limit: f64,
) -> f64 {
    let height = |(normal, offset): &(Vector3, f64)| normal.dot(&point.coords) - offset;
    let (mut top, mut at) = (f64::NEG_INFINITY, 0);
    for (k, plane) in planes.iter().enumerate() {
        let h = height(plane);
        if h > top {
            (top, at) = (h, k);
        }
    }
    if top <= 0.0 || top >= limit || is_over(&planes[at].0, &faces[at], point) {
        return top;
    }
    let mut least = limit;
    for (plane, face) in planes.iter().zip(faces) {
        let h = height(plane);
        if h <= 0.0 || h >= least {
            continue;
        }
        if is_over(&plane.0, face, point) {
            least = h;
            continue;
        }
        let next = face.iter().cycle().skip(1);
        for (a, b) in face.iter().zip(next) {
            least = least.min((on_segment(a, &(b - a), point) - point).norm());
        }
    }
    least
}

/// Whether a point's foot on the plane of a convex face lies in the face.
fn is_over(normal: &Vector3, face: &[Point3], point: &Point3) -> bool {
    let next = face.iter().cycle().skip(1);
    face.iter()
        .zip(next)
        .all(|(a, b)| normal.dot(&(b - a).cross(&(point - a))) >= 0.0)
}

/// Distance (m) of a point from the upright sides of a region but those along axes on which it repeats itself, negative
/// outside; infinite without any.
pub(super) fn side_distance(region: &Region, repeats: [bool; 3], point: &Point3) -> f64 {
    match *region {
        Region::Box { min, max } => (0..2)
            .filter(|&k| !repeats[k])
            .map(|k| (point[k] - min[k]).min(max[k] - point[k]))
            .fold(f64::INFINITY, f64::min),
        Region::Cylinder { centre, radius, .. } => {
            radius - (point.x - centre[0]).hypot(point.y - centre[1])
        }
        Region::Sphere { .. } => f64::INFINITY,
    }
}
