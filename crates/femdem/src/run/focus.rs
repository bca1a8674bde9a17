//! Meshes of spheres that are finer at one place.

use femdem_mesh::shapes::Shape;
use femdem_mesh::{Point3, TetMesh, Vector3};

use super::FocusEntry;
use crate::Error;
use crate::error::wrong;

impl FocusEntry {
    /// The mesh of a sphere about the origin with this radius \[m\], finer at the focus. `shape` is the
    /// description of the sphere.
    pub(super) fn of_sphere(
        &self,
        mesh: &TetMesh,
        radius: f64,
        shape: &str,
    ) -> Result<TetMesh, Error> {
        if !matches!(shape.parse(), Ok(Shape::Sphere(_))) {
            return Err(wrong("focus", "given", "the shape must be a sphere"));
        }
        if !(1.0..=10.0).contains(&self.ratio) {
            return Err(wrong("focus.ratio", &self.ratio.to_string(), "1 to 10"));
        }
        let length = Vector3::from(self.direction).norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(wrong(
                "focus.direction",
                &format!("{:?}", self.direction),
                "a direction of finite length above zero",
            ));
        }
        let towards = Vector3::from(self.direction) / length;
        let from = towards * (-(self.ratio - 1.0) / (self.ratio + 1.0));
        let place = |(i, p): (usize, &Point3)| {
            let unit = if mesh.is_skin_point(i) {
                p.coords.normalize()
            } else {
                p.coords / radius
            };
            Point3::from(automorphism(&from, &unit) * radius)
        };
        let points = mesh.points().iter().enumerate().map(place).collect();
        Ok(TetMesh::new(points, mesh.tets().to_vec())?)
    }
}

/// The conformal map of the unit ball onto itself that maps `a` to the origin and 0 to -a (L. V. Ahlfors,
/// Moebius Transformations in Several Dimensions, 1981, section 2.6). Lengths at x change by
/// (1 - a^2)/(1 - 2 a.x + a^2 x^2).
fn automorphism(a: &Vector3, x: &Vector3) -> Vector3 {
    let a2 = a.norm_squared();
    let from = x - a;
    let denominator = 1.0 - 2.0 * a.dot(x) + a2 * x.norm_squared();
    (from * (1.0 - a2) - a * from.norm_squared()) / denominator
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::tet::{MeshOptions, mesh};

    /// Longest edge of the skin within 0.3 radii of a point.
    fn longest_near(mesh: &TetMesh, place: &Point3) -> f64 {
        let points = mesh.points();
        let edges = mesh
            .skin()
            .iter()
            .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        let ends = edges.map(|e| e.map(|i| points[i as usize]));
        let near = ends.filter(|[a, b]| (a - place).norm() < 0.3 && (b - place).norm() < 0.3);
        near.map(|[a, b]| (a - b).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn edges_at_the_focus_are_shorter_by_the_ratio_and_the_skin_is_round() {
        let sphere = "sphere:level=3".parse::<Shape>().unwrap();
        let options = MeshOptions {
            edge_length: Some(0.1),
            ..MeshOptions::default()
        };
        let (even, _) = mesh(&sphere.polyhedron(2.0).unwrap(), &options).unwrap();
        let focused = |ratio| {
            let focus = FocusEntry {
                direction: [0.0, 0.0, -3.0],
                ratio,
            };
            focus.of_sphere(&even, 1.0, "sphere:level=3").unwrap()
        };
        let pole = Point3::new(0.0, 0.0, -1.0);
        let (one, four) = (focused(1.0), focused(4.0));
        for mesh in [&one, &four] {
            let skin = (0..mesh.points().len()).filter(|&i| mesh.is_skin_point(i));
            let off = skin.map(|i| (mesh.points()[i].coords.norm() - 1.0).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12);
        }
        let gain = longest_near(&one, &pole) / longest_near(&four, &pole);
        assert!((2.0..4.5).contains(&gain), "{gain}");
        // The sphere is filled: an inscribed mesh of edge 0.1 misses little.
        let volume = 4.0 / 3.0 * std::f64::consts::PI;
        assert!(
            (one.volume() / volume - 1.0).abs() < 5e-3,
            "{}",
            one.volume()
        );
        assert!(
            (four.volume() / volume - 1.0).abs() < 3e-2,
            "{}",
            four.volume()
        );
        let cube = FocusEntry {
            direction: [1.0; 3],
            ratio: 2.0,
        }
        .of_sphere(&even, 1.0, "cube");
        assert!(cube.unwrap_err().to_string().contains("must be a sphere"));
    }
}
