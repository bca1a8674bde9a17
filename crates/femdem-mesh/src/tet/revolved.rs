//! Shells of revolution: silos, hoppers, tubes, drums and discs with a wall of even thickness.

use super::TetMesh;
use crate::{MeshError, Point3};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// A shell about the z axis: a profile, turned around the axis, and the plates behind it.
///
/// The plates lie on the right of the profile, seen along it: outside of a profile that goes up, below one that goes
/// outwards. They are cut off square to the profile at its ends. Around the axis there are plane facets, each tangent to
/// the circle, so that the space within is larger than that of the circle by the factor tan(π/n) n/π (0.08 % for 64).
///
/// ```
/// use femdem_mesh::tet::RevolvedShell;
///
/// // A tube with an inner radius of 0.5 m and a height of 2 m, 0.1 m thick.
/// let tube = RevolvedShell { profile: vec![[0.5, 0.0], [0.5, 2.0]], thickness: 0.1, facets: 64 };
/// let volume = std::f64::consts::PI * (0.6_f64.powi(2) - 0.5_f64.powi(2)) * 2.0;
/// assert!((tube.mesh()?.volume() / volume - 1.0).abs() < 1e-3);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RevolvedShell {
    /// Inner radius and height, \[m\], of its corners, one after the other. Only the first and the last may be on the axis,
    /// which closes the shell there.
    pub profile: Vec<[f64; 2]>,
    /// Thickness of the plates \[m\].
    pub thickness: f64,
    /// Number of facets around the axis.
    pub facets: u32,
}

/// The six tetrahedra of a cell about its diagonal (Kuhn's), as the two corners between 0 and 7; bit 0 of a corner is its
/// place along the profile, bit 1 that through the plate, bit 2 that around the axis. Those of neighbouring cells match.
const PATHS: [[usize; 2]; 6] = [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]];

/// The tetrahedra of plates in `[parts, facets]` cells, where `point(i, j, k)` is the number of the corner of ring `i` and
/// facet `k`, which goes up to the number of facets, in front (`j` = 0) or behind (1).
pub(super) fn cells(
    [parts, facets]: [usize; 2],
    point: &mut impl FnMut(usize, usize, usize) -> u32,
) -> Vec<[u32; 4]> {
    let mut tets = Vec::new();
    for i in 0..parts {
        for k in 0..facets {
            let mut corner = |bits: usize| point(i + (bits & 1), bits >> 1 & 1, k + (bits >> 2));
            for [a, b] in PATHS {
                let tet = [0, a, b, 7].map(&mut corner);
                // On the axis corners of a cell are one.
                if (0..4).all(|m| !tet[m + 1..].contains(&tet[m])) {
                    tets.push(tet);
                }
            }
        }
    }
    tets
}

impl RevolvedShell {
    /// The plates as one solid, six tetrahedra for each part of the profile and facet.
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] for a thickness or a part of the profile that is not positive and finite, a radius below 0,
    /// here or behind the plates, or 0 between the ends, fewer than 2 corners, and fewer than 3 or more than 10,000 facets;
    /// [`MeshError::FlatTetrahedron`] where the profile turns towards the plates by more than these leave room for.
    pub fn mesh(&self) -> Result<TetMesh, MeshError> {
        self.check()?;
        let behind = self.behind();
        if let Some([r, _]) = behind.iter().find(|[r, _]| *r < 0.0) {
            return Err(MeshError::OutOfRange {
                what: "radius of a shell behind its plates",
                value: *r,
                allowed: "0 m and more: thinner plates, or a profile in the other direction",
            });
        }
        let fronts = self.profile.iter();
        let rings: Vec<[[f64; 2]; 2]> = fronts.zip(behind).map(|(f, b)| [*f, b]).collect();
        let mut points: Vec<Point3> = Vec::new();
        let mut known: BTreeMap<[usize; 3], u32> = BTreeMap::new();
        let facets = self.facets as usize;
        let sector = TAU / f64::from(self.facets);
        // Facets are tangent to the circle, so their corners lie outside it.
        let out = 1.0 / (PI / f64::from(self.facets)).cos();
        let mut point = |i: usize, j: usize, k: usize| {
            let [r, z] = rings[i][j];
            let k = if r > 0.0 { k % facets } else { 0 };
            *known.entry([i, j, k]).or_insert_with(|| {
                let (sin, cos) = (sector * (k as f64 - 0.5)).sin_cos();
                points.push(Point3::new(r * out * cos, r * out * sin, z));
                points.len() as u32 - 1
            })
        };
        let tets = cells([rings.len() - 1, facets], &mut point);
        TetMesh::new(points, tets)
    }

    fn check(&self) -> Result<(), MeshError> {
        let refuse = |what, value, allowed| {
            Err(MeshError::OutOfRange {
                what,
                value,
                allowed,
            })
        };
        if !(self.thickness > 0.0 && self.thickness.is_finite()) {
            let allowed = "finite numbers above 0, in m";
            return refuse("thickness of a shell", self.thickness, allowed);
        }
        if !(3..=10_000).contains(&self.facets) {
            return refuse("number of facets", f64::from(self.facets), "3 to 10000");
        }
        if self.profile.len() < 2 {
            let count = self.profile.len() as f64;
            return refuse("number of corners of a profile", count, "2 and more");
        }
        let last = self.profile.len() - 1;
        for (i, [r, _]) in self.profile.iter().enumerate() {
            let is_end = i == 0 || i == last;
            if !(*r > 0.0 || (is_end && *r == 0.0)) {
                let allowed = "finite numbers above 0, in m; 0 at the ends of a profile only";
                return refuse("radius of a shell", *r, allowed);
            }
        }
        for pair in self.profile.windows(2) {
            let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            if !(length > 0.0 && length.is_finite()) {
                let allowed = "finite numbers above 0, in m";
                return refuse("length of a part of a profile", length, allowed);
            }
        }
        Ok(())
    }

    /// The profile shifted by the thickness to its right, corners mitred. Ends on the axis stay there.
    fn behind(&self) -> Vec<[f64; 2]> {
        let profile = &self.profile;
        let normal = |k: usize| {
            let [dr, dz] = [0, 1].map(|c| profile[k + 1][c] - profile[k][c]);
            let length = dr.hypot(dz);
            [dz / length, -dr / length]
        };
        let last = profile.len() - 1;
        let shifted = |(k, &[r, z]): (usize, &[f64; 2])| {
            let (m, n) = (normal(k.max(1) - 1), normal(k.min(last - 1)));
            if r > 0.0 {
                let scale = self.thickness / (1.0 + m[0] * n[0] + m[1] * n[1]);
                [r + (m[0] + n[0]) * scale, z + (m[1] + n[1]) * scale]
            } else {
                // Along the axis to the shifted line: its r is 0 where n . (x - x0) = t.
                [0.0, z + self.thickness / n[1]]
            }
        };
        profile.iter().enumerate().map(shifted).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Area of a regular polygon over its inscribed circle's radius squared.
    fn polygon(n: u32) -> f64 {
        f64::from(n) * (PI / f64::from(n)).tan()
    }

    /// Volume of a frustum of a cone over π.
    fn frustum(h: f64, a: f64, b: f64) -> f64 {
        h / 3.0 * (a * a + a * b + b * b)
    }

    fn volume(profile: &[[f64; 2]], thickness: f64, facets: u32) -> f64 {
        let shell = RevolvedShell {
            profile: profile.to_vec(),
            thickness,
            facets,
        };
        let mesh = shell.mesh().unwrap();
        // The surface is closed: every edge runs once in either direction.
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let edges: Vec<[u32; 2]> = mesh.skin().iter().flat_map(sides).collect();
        let once: BTreeSet<[u32; 2]> = edges.iter().copied().collect();
        assert_eq!(once.len(), edges.len());
        assert!(once.iter().all(|&[a, b]| once.contains(&[b, a])));
        mesh.volume()
    }

    #[test]
    fn volumes_are_those_of_the_solids() {
        let (n, t) = (24, 0.01);
        // A silo with a cone of 45 degrees, cut off square to it at the outlet.
        let slant = 0.4_f64.hypot(0.4);
        let (dr, dz) = (t * 0.4 / slant, -t * 0.4 / slant);
        let low = 0.4 - t * (PI / 8.0).tan();
        let outer = frustum(low - dz, 0.1 + dr, 0.5 + t) + 0.51 * 0.51 * (1.4 - low);
        let inner = frustum(0.4, 0.1, 0.5) + 0.25;
        let lip = frustum(-dz, 0.1, 0.1 + dr);
        let silo = [[0.1, 0.0], [0.5, 0.4], [0.5, 1.4]];
        let drum = [[0.0, -0.4], [0.3, -0.4], [0.3, 0.4], [0.0, 0.4]];
        let flat = [[0.1, 0.0], [0.5, 0.0], [0.5, 1.0]];
        let disc = [[0.0, 0.2], [0.3, 0.2]];
        for (profile, expected) in [
            (&silo[..], outer - inner - lip),
            (&drum, 0.31 * 0.31 * 0.82 - 0.3 * 0.3 * 0.8),
            (&flat, 0.51 * 0.51 * 1.01 - 0.25 - 0.1 * 0.1 * t),
            (&disc, 0.09 * t),
        ] {
            let ratio = volume(profile, t, n) / (polygon(n) * expected);
            assert!((ratio - 1.0).abs() < 1e-12, "{profile:?}: {ratio}");
        }
    }

    #[test]
    fn four_facets_about_a_point_are_a_pyramid() {
        // The outer pyramid up to the rim, the rim's band, less the free pyramid.
        let pyramid = |r: f64| 4.0 / 3.0 * r.powi(3);
        let dz = 0.02 / 2.0_f64.sqrt();
        let r = 0.5 + dz;
        let expected = pyramid(r) + 4.0 * frustum(dz, r, 0.5) - pyramid(0.5);
        let ratio = volume(&[[0.0, 0.0], [0.5, 0.5]], 0.02, 4) / expected;
        assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
    }

    #[test]
    fn shells_that_cannot_be_are_refused() {
        let tube = RevolvedShell {
            profile: vec![[0.5, 0.0], [0.5, 1.0]],
            thickness: 0.1,
            facets: 8,
        };
        let through = |profile: Vec<[f64; 2]>| RevolvedShell {
            profile,
            ..tube.clone()
        };
        for (shell, message) in [
            (
                RevolvedShell {
                    facets: 2,
                    ..tube.clone()
                },
                "facets",
            ),
            (
                RevolvedShell {
                    thickness: 0.0,
                    ..tube.clone()
                },
                "thickness",
            ),
            (through(vec![[0.5, 0.0]]), "corners"),
            (through(vec![[-0.5, 0.0], [0.5, 1.0]]), "radius"),
            (
                through(vec![[0.5, 0.0], [0.0, 0.5], [0.5, 1.0]]),
                "ends of a profile",
            ),
            (through(vec![[0.5, 1.0], [0.5, 1.0]]), "length of a part"),
            // The plates of a narrow tube that go inwards pass the axis.
            (through(vec![[0.05, 1.0], [0.05, 0.0]]), "behind its plates"),
            // A groove narrower than the plates are thick.
            (
                through(vec![[0.5, 0.0], [0.3, 0.01], [0.5, 0.02]]),
                "etrahedron",
            ),
        ] {
            let error = shell.mesh().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
