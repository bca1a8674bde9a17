//! Shells of rectangular section: bins with a hopper below.

use super::TetMesh;
use super::revolved::cells;
use crate::{MeshError, Point3};

/// A shell about the z axis that becomes wider with height: rectangles one above the other, and the plates around them.
///
/// The plates reach from each rectangle outwards and down by their thickness, which is that of upright and of level ones;
/// leaning ones are thicker by up to a factor of √2. At the rim the plates are cut off level.
///
/// ```
/// use femdem_mesh::tet::RectangularShell;
///
/// // A wedge that narrows from 1 m to a slot of 0.2 m over its whole width, with a bin of 1 m on it.
/// let sections = vec![[0.2, 0.5, 0.0], [1.0, 0.5, 0.8], [1.0, 0.5, 1.8]];
/// let mesh = RectangularShell { sections, thickness: 0.05 }.mesh()?;
/// assert_eq!(mesh.tets().len(), 48);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RectangularShell {
    /// Inner sides along x and y, and height, \[m\], from the lowest rectangle to the highest.
    pub sections: Vec<[f64; 3]>,
    /// Thickness of the plates \[m\].
    pub thickness: f64,
}

impl RectangularShell {
    /// The plates as one solid, 24 tetrahedra for each part between two rectangles.
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] for a thickness or a side that is not positive and finite, fewer than 2 rectangles, one that is
    /// lower or narrower than that before it, or the same.
    pub fn mesh(&self) -> Result<TetMesh, MeshError> {
        self.check()?;
        let last = self.sections.len() - 1;
        let mut points = Vec::new();
        for (i, &[x, y, z]) in self.sections.iter().enumerate() {
            let t = self.thickness;
            let down = if i == last { 0.0 } else { t };
            for [x, y, z] in [[x / 2.0, y / 2.0, z], [x / 2.0 + t, y / 2.0 + t, z - down]] {
                let signs = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
                points.extend(signs.map(|[a, b]| Point3::new(a * x, b * y, z)));
            }
        }
        let mut corner = |i: usize, j: usize, k: usize| (8 * i + 4 * j + k % 4) as u32;
        let tets = cells([last, 4], &mut corner);
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
        if self.sections.len() < 2 {
            let count = self.sections.len() as f64;
            return refuse("number of rectangles of a shell", count, "2 and more");
        }
        let lengths = self.sections.iter().flat_map(|[x, y, _]| [*x, *y]);
        for length in lengths.chain([self.thickness]) {
            if !(length > 0.0 && length.is_finite()) {
                let allowed = "finite numbers above 0, in m";
                return refuse("side or thickness of a shell", length, allowed);
            }
        }
        for pair in self.sections.windows(2) {
            let steps = [0, 1, 2].map(|k| pair[1][k] - pair[0][k]);
            if steps[2] == 0.0 && (steps[0] == 0.0 || steps[1] == 0.0) {
                let allowed = "above 0 in both directions where the height is the same";
                return refuse("growth from a rectangle to the next one", 0.0, allowed);
            }
            let grows = steps.iter().all(|x| (0.0..f64::INFINITY).contains(x));
            if !(grows && steps.iter().any(|x| *x > 0.0)) {
                let least = steps.into_iter().fold(f64::INFINITY, f64::min);
                let allowed =
                    "0 m and more in each direction, and not all 0: list the rectangles upwards";
                return refuse("growth from a rectangle to the next one", least, allowed);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Volume of a prismatoid between two rectangles, by Simpson's rule, which is exact for it.
    fn between(low: [f64; 3], high: [f64; 3]) -> f64 {
        let area = |t: f64| {
            let side = |k: usize| low[k] + t * (high[k] - low[k]);
            side(0) * side(1)
        };
        (high[2] - low[2]) / 6.0 * (area(0.0) + 4.0 * area(0.5) + area(1.0))
    }

    #[test]
    fn volumes_are_those_of_the_plates() {
        let t = 0.02;
        let wedge = [[0.1, 0.4, 0.0], [0.5, 0.4, 0.5], [0.5, 0.4, 1.0]];
        let pyramid = [[0.1, 0.2, 0.0], [0.5, 0.3, 0.4], [0.5, 0.3, 0.9]];
        let flat = [[0.1, 0.1, 0.2], [0.5, 0.3, 0.2], [0.5, 0.3, 0.7]];
        for sections in [wedge, pyramid, flat] {
            let shell = RectangularShell {
                sections: sections.to_vec(),
                thickness: t,
            };
            let mesh = shell.mesh().unwrap();
            let out = |[x, y, z]: [f64; 3], down: f64| [x + 2.0 * t, y + 2.0 * t, z - down];
            let outer = [
                out(sections[0], t),
                out(sections[1], t),
                out(sections[2], 0.0),
            ];
            let inner = between(sections[0], sections[1]) + between(sections[1], sections[2]);
            // Below the lowest rectangle the plates end in a slope, which is free inside.
            let free = between(outer[0], sections[0]);
            let expected = between(outer[0], outer[1]) + between(outer[1], outer[2]) - inner - free;
            assert!(
                (mesh.volume() / expected - 1.0).abs() < 1e-12,
                "{sections:?}"
            );
        }
    }

    #[test]
    fn shells_that_cannot_be_are_refused() {
        let good = vec![[0.1, 0.1, 0.0], [0.2, 0.2, 0.1]];
        for (sections, thickness, message) in [
            (good.clone(), 0.0, "thickness"),
            (good[..1].to_vec(), 0.1, "rectangles"),
            (vec![[0.0, 0.1, 0.0], good[1]], 0.1, "side"),
            (vec![good[1], good[0]], 0.1, "upwards"),
            (vec![good[0], good[0]], 0.1, "both directions"),
            (vec![good[0], [0.1, 0.2, 0.0]], 0.1, "both directions"),
            (vec![good[0], [0.2, 0.2, f64::NAN]], 0.1, "growth"),
        ] {
            let shell = RectangularShell {
                sections,
                thickness,
            };
            let error = shell.mesh().unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
