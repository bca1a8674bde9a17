//! Containers of revolution as solid meshes: hopper, silo with a cone, drum.

use crate::error::ContactError;
use femdem_mesh::{Point3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// A funnel about the z axis: an outlet at z = 0 that widens to the top. With four facets it
/// is a square pyramid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hopper {
    /// Inscribed radius at the top, m.
    pub top_radius: f64,
    /// Inscribed radius of the outlet, m.
    pub outlet_radius: f64,
    /// Height, m.
    pub height: f64,
    /// Thickness of the plates, m: more than the deepest overlap to be expected.
    pub thickness: f64,
    /// Number of flat plates around the axis; each is tangent to the circle.
    pub facets: u32,
}

/// A silo about the z axis: a funnel from the outlet at z = 0, and a cylinder on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Silo {
    /// Inscribed radius of the cylinder, m.
    pub radius: f64,
    /// Height of the cylinder, m.
    pub height: f64,
    /// Inscribed radius of the outlet, m; 0 closes it.
    pub outlet_radius: f64,
    /// Height of the cone, m.
    pub cone_height: f64,
    /// Thickness of the plates, m: more than the deepest overlap to be expected.
    pub thickness: f64,
    /// Number of flat plates around the axis; each is tangent to the circle.
    pub facets: u32,
}

/// A closed drum that lies along the y axis, from y = -length/2 to length/2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drum {
    /// Inscribed radius, m.
    pub radius: f64,
    /// Length inside, m.
    pub length: f64,
    /// Thickness of the plates, m: more than the deepest overlap to be expected.
    pub thickness: f64,
    /// Number of flat plates around the axis; each is tangent to the circle.
    pub facets: u32,
}

impl Hopper {
    /// The plates as one solid.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] names the length that is not positive and finite (the outlet
    /// may be 0), or fewer than 3 or more than 10,000 facets.
    pub fn mesh(&self) -> Result<TetMesh, ContactError> {
        positive("top_radius", self.top_radius)?;
        not_negative("outlet_radius", self.outlet_radius)?;
        positive("height", self.height)?;
        let profile = [[self.outlet_radius, 0.0], [self.top_radius, self.height]];
        revolve(&profile, self.thickness, self.facets)
    }
}

impl Silo {
    /// The plates as one solid.
    ///
    /// # Errors
    /// As [`Hopper::mesh`].
    pub fn mesh(&self) -> Result<TetMesh, ContactError> {
        positive("radius", self.radius)?;
        positive("height", self.height)?;
        not_negative("outlet_radius", self.outlet_radius)?;
        positive("cone_height", self.cone_height)?;
        let profile = [
            [self.outlet_radius, 0.0],
            [self.radius, self.cone_height],
            [self.radius, self.cone_height + self.height],
        ];
        revolve(&profile, self.thickness, self.facets)
    }
}

impl Drum {
    /// The plates as one solid.
    ///
    /// # Errors
    /// As [`Hopper::mesh`].
    pub fn mesh(&self) -> Result<TetMesh, ContactError> {
        positive("radius", self.radius)?;
        positive("length", self.length)?;
        let half = 0.5 * self.length;
        let profile = [
            [0.0, -half],
            [self.radius, -half],
            [self.radius, half],
            [0.0, half],
        ];
        let upright = revolve(&profile, self.thickness, self.facets)?;
        let lying = upright.points().iter().map(|p| Point3::new(p.y, p.z, p.x));
        solid(lying.collect(), upright.tets().to_vec())
    }
}

fn positive(name: &'static str, x: f64) -> Result<(), ContactError> {
    crate::error::check(name, x, x > 0.0, "positive and finite, in m")
}

fn not_negative(name: &'static str, x: f64) -> Result<(), ContactError> {
    crate::error::check(name, x, x >= 0.0, "at least 0 and finite, in m")
}

fn solid(points: Vec<Point3>, tets: Vec<[u32; 4]>) -> Result<TetMesh, ContactError> {
    TetMesh::new(points, tets).map_err(|e| ContactError::Wall {
        name: "container of revolution".to_owned(),
        why: e.to_string(),
    })
}

/// The profile shifted by `thickness` to its right, corners mitred: outwards for a profile that
/// goes upwards about the axis. Ends on the axis stay there.
fn offset(profile: &[[f64; 2]], thickness: f64) -> Vec<[f64; 2]> {
    let normal = |k: usize| {
        let [dr, dz] = [0, 1].map(|c| profile[k + 1][c] - profile[k][c]);
        let length = dr.hypot(dz);
        [dz / length, -dr / length]
    };
    let last = profile.len() - 1;
    profile
        .iter()
        .enumerate()
        .map(|(k, &[r, z])| {
            let (m, n) = (normal(k.max(1) - 1), normal(k.min(last - 1)));
            let scale = thickness / (1.0 + m[0] * n[0] + m[1] * n[1]);
            let (dr, dz) = ((m[0] + n[0]) * scale, (m[1] + n[1]) * scale);
            if r > 0.0 {
                [r + dr, z + dz]
            } else {
                // Along the axis to the shifted line: its r is 0 where n . (x - x0) = t.
                [0.0, z + thickness / n[1]]
            }
        })
        .collect()
}

/// The shell between a profile (r, z) and its offset, turned about the z axis, as six
/// tetrahedra for each cell of the profile and facet.
fn revolve(profile: &[[f64; 2]], thickness: f64, facets: u32) -> Result<TetMesh, ContactError> {
    positive("thickness", thickness)?;
    crate::error::check(
        "facets",
        f64::from(facets),
        (3..=10_000).contains(&facets),
        "3 to 10000",
    )?;
    let rings: Vec<[[f64; 2]; 2]> = profile
        .iter()
        .zip(offset(profile, thickness))
        .map(|(inner, outer)| [*inner, outer])
        .collect();
    let mut points: Vec<Point3> = Vec::new();
    let mut known: BTreeMap<[usize; 3], u32> = BTreeMap::new();
    let sector = TAU / f64::from(facets);
    // Facets are tangent to the circle, so their corners lie outside it.
    let out = 1.0 / (PI / f64::from(facets)).cos();
    let mut point = |i: usize, j: usize, k: u32| {
        let [r, z] = rings[i][j];
        let k = if r > 0.0 { k % facets } else { 0 };
        *known.entry([i, j, k as usize]).or_insert_with(|| {
            let (sin, cos) = (sector * (f64::from(k) - 0.5)).sin_cos();
            points.push(Point3::new(r * out * cos, r * out * sin, z));
            points.len() as u32 - 1
        })
    };
    let mut cells = Vec::new();
    for i in 0..rings.len() - 1 {
        for k in 0..facets {
            for path in PATHS {
                let mut at = [0_usize; 3];
                let mut corner = [point(i, 0, k); 4];
                for (c, axis) in path.into_iter().enumerate() {
                    at[axis] = 1;
                    corner[c + 1] = point(i + at[0], at[1], k + at[2] as u32);
                }
                cells.push(corner);
            }
        }
    }
    let volume = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|i| points[i as usize]);
        Vector3::dot(&(b - a), &(c - a).cross(&(d - a)))
    };
    let tets = cells
        .into_iter()
        .filter(|t| (0..4).all(|m| !t[m + 1..].contains(&t[m])))
        .map(|t| {
            if volume(&t) > 0.0 {
                t
            } else {
                [t[0], t[2], t[1], t[3]]
            }
        })
        .collect();
    solid(points, tets)
}

/// The six paths through a cell along its axes (Kuhn's tetrahedra), which match those of the neighbouring
/// cells.
const PATHS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of a regular polygon over its inscribed circle's radius squared.
    fn polygon(n: u32) -> f64 {
        f64::from(n) * (PI / f64::from(n)).tan()
    }

    #[test]
    fn volumes_of_the_shells() {
        let (n, t) = (24, 0.01);
        let silo = Silo {
            radius: 0.5,
            height: 1.0,
            outlet_radius: 0.1,
            cone_height: 0.4,
            thickness: t,
            facets: n,
        };
        // Cone frusta: h/3 (R^2 + R r + r^2); outer radii from the slant of the cone, cut off square to it at
        // the outlet.
        let frustum = |h: f64, a: f64, b: f64| h / 3.0 * (a * a + a * b + b * b);
        let slant = 0.4_f64.hypot(0.4);
        let (dr, dz) = (t * 0.4 / slant, -t * 0.4 / slant);
        let miter = t * (PI / 8.0).tan();
        let low = 0.4 - miter;
        let outer = frustum(low - dz, 0.1 + dr, 0.5 + t) + 0.51 * 0.51 * (1.4 - low);
        let inner = frustum(0.4, 0.1, 0.5) + 0.25;
        let lip = frustum(-dz, 0.1, 0.1 + dr);
        let expected = polygon(n) * (outer - inner - lip);
        let got = silo.mesh().unwrap().volume();
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} {expected}");

        let drum = Drum {
            radius: 0.3,
            length: 0.8,
            thickness: t,
            facets: n,
        };
        let expected = polygon(n) * (0.31 * 0.31 * 0.82 - 0.3 * 0.3 * 0.8);
        let mesh = drum.mesh().unwrap();
        assert!((mesh.volume() / expected - 1.0).abs() < 1e-12);
        let inside = |p: &&Point3| p.y.abs() < 0.4 + 1e-12 && p.x.hypot(p.z) < 0.305;
        assert_eq!(
            mesh.points().iter().filter(inside).count(),
            2 * n as usize + 2
        );
    }

    #[test]
    fn a_hopper_of_four_facets_is_a_pyramid() {
        let mut hopper = Hopper {
            top_radius: 0.5,
            outlet_radius: 0.0,
            height: 0.5,
            thickness: 0.02,
            facets: 4,
        };
        // The outer pyramid up to the rim, the rim's band, less the free pyramid.
        let pyramid = |r: f64| 4.0 / 3.0 * r.powi(3);
        let dz = 0.02 / 2.0_f64.sqrt();
        let r = 0.5 + dz;
        let band = 4.0 * dz / 3.0 * (r * r + r * 0.5 + 0.25);
        let expected = pyramid(r) + band - pyramid(0.5);
        let got = hopper.mesh().unwrap().volume();
        assert!((got / expected - 1.0).abs() < 1e-12, "{got} {expected}");
        hopper.facets = 2;
        assert!(
            hopper
                .mesh()
                .unwrap_err()
                .to_string()
                .contains("facets = 2")
        );
        hopper.facets = 4;
        hopper.thickness = 0.0;
        assert!(
            hopper
                .mesh()
                .unwrap_err()
                .to_string()
                .contains("thickness = 0")
        );
    }
}
