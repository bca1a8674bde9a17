//! Signed distance to posed bodies of any form.

use femdem_mesh::{Point3, Vector3};

use super::convex::ConvexField;
use crate::pack::Pack;

/// The bodies of a pack, prepared for many distance queries.
pub(super) struct Fields<'a> {
    pack: &'a Pack<'a>,
    /// One per shape; `None` for shapes that are handled by their triangles.
    convex: Vec<Option<ConvexField>>,
}

impl<'a> Fields<'a> {
    pub(super) fn new(pack: &'a Pack<'a>) -> Self {
        let shapes = pack.shapes().iter().enumerate();
        Self {
            pack,
            convex: shapes
                .map(|(i, shape)| pack.shape_by_planes(i).then(|| ConvexField::new(shape)))
                .collect(),
        }
    }

    /// Distance (m) of `point` from the surface of a body, below zero inside, and its gradient; `None`
    /// when it is known to be above `limit`.
    pub(super) fn distance(
        &self,
        memory: &mut Vec<f64>,
        body: usize,
        point: &Point3,
        limit: f64,
    ) -> Option<(f64, Vector3)> {
        let shape = self.pack.bodies()[body].shape as usize;
        if let Some(field) = &self.convex[shape] {
            let pose = self.pack.pose(body);
            let local = pose.inverse_transform_point(point);
            let (distance, gradient) = field.distance(memory, &local, limit)?;
            return Some((distance, pose.rotation * gradient));
        }
        let apart = point - self.pack.nearest_on_surface(body, point);
        let sign = if self.pack.holds(body, point) {
            -1.0
        } else {
            1.0
        };
        let distance = sign * apart.norm();
        // On the surface itself the direction is undefined; it is not needed for a single point.
        let gradient = apart.try_normalize(0.0).unwrap_or_default() * sign;
        (distance <= limit).then_some((distance, gradient))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::PosedBody;
    use femdem_mesh::Pose;
    use femdem_mesh::shapes::{Dolos, Shape};

    /// The volume below zero is the body's; steps along the gradient change the distance by their length.
    #[test]
    fn distance_of_a_dolos() {
        let shapes = [Shape::from(Dolos::default()).polyhedron(1.0).unwrap()];
        let bodies = [PosedBody {
            shape: 0,
            pose: Pose::new(Vector3::new(0.3, -0.2, 0.1), Vector3::new(0.4, 1.1, -0.7)),
        }];
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let fields = Fields::new(&pack);
        let bounds = pack.bounds(0);
        let n = 24_i32;
        let size = bounds.max - bounds.min;
        let (mut inside, mut right) = (0, 0);
        for i in 0..n * n * n {
            let at = [i % n, i / n % n, i / (n * n)];
            let step = Vector3::from(at.map(|k| (f64::from(k) + 0.5) / f64::from(n)));
            let point = bounds.min + size.component_mul(&step);
            let ask = |p: &Point3| fields.distance(&mut Vec::new(), 0, p, f64::INFINITY);
            let (distance, gradient) = ask(&point).unwrap();
            inside += i32::from(distance < 0.0);
            let (further, _) = ask(&(point + 1e-6 * gradient)).unwrap();
            right += i32::from((further - distance - 1e-6).abs() < 1e-9);
        }
        let volume = f64::from(inside) / f64::from(n.pow(3)) * size.product();
        let exact = shapes[0].mass_properties().volume;
        assert!((volume / exact - 1.0).abs() < 0.03, "{volume} {exact}");
        // All but points beside the medial surface.
        assert!(right > n.pow(3) - 20, "{right} of {}", n.pow(3));
    }
}
