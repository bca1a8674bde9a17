//! Filling triangles into a depth buffer.

use super::scene::Mesh;
use super::view::{Seen, View};

/// No facet.
pub(super) const NOTHING: u32 = u32::MAX;

/// For each pixel the nearness of the nearest facet, row by row from the top; minus infinity where there is
/// none.
pub(super) struct DepthMap {
    pub width: usize,
    pub height: usize,
    pub nearness: Vec<f32>,
}

/// The same with the nearest facet of each pixel.
pub(super) struct DepthBuffer {
    pub depth: DepthMap,
    pub facet: Vec<u32>,
}

impl DepthBuffer {
    fn new(width: usize, height: usize) -> Self {
        Self {
            depth: DepthMap::new(width, height),
            facet: vec![NOTHING; width * height],
        }
    }

    /// The visible parts of a mesh. Back faces are left out.
    pub fn of(mesh: &Mesh, view: &View, width: usize, height: usize) -> Self {
        let mut buffer = Self::new(width, height);
        each_triangle(mesh, view, |corners, facet| buffer.fill(corners, facet));
        buffer
    }

    /// Facet and nearness at a pixel, or `None` outside the picture or where there is nothing.
    pub fn at(&self, x: isize, y: isize) -> Option<(u32, f32)> {
        let i = self.depth.index(x, y)?;
        (self.facet[i] != NOTHING).then(|| (self.facet[i], self.depth.nearness[i]))
    }

    fn fill(&mut self, corners: [Seen; 3], number: u32) {
        let facet = &mut self.facet;
        self.depth.fill(corners, |i| facet[i] = number);
    }
}

/// Calls `draw` with the corners in the view and the facet of each triangle of a mesh that is not a back face.
fn each_triangle(mesh: &Mesh, view: &View, mut draw: impl FnMut([Seen; 3], u32)) {
    let mut seen: Vec<Seen> = Vec::new();
    mesh.for_each_part(|points, triangles, first, normals| {
        seen.clear();
        seen.extend(points.iter().map(|p| view.see(p)));
        for triangle in triangles {
            let normal = &normals[triangle.facet as usize];
            if view.faces(normal, &points[triangle.corners[0] as usize]) {
                let corners = triangle.corners.map(|i| seen[i as usize]);
                draw(corners, first + triangle.facet);
            }
        }
    });
}

impl DepthMap {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            nearness: vec![f32::NEG_INFINITY; width * height],
        }
    }

    /// The nearness of a mesh. Back faces are left out.
    pub fn of(mesh: &Mesh, view: &View, width: usize, height: usize) -> Self {
        let mut map = Self::new(width, height);
        each_triangle(mesh, view, |corners, _| map.fill(corners, |_| {}));
        map
    }

    /// Nearness at a pixel, or `None` outside the picture or where there is nothing.
    pub fn at(&self, x: isize, y: isize) -> Option<f32> {
        let near = self.nearness[self.index(x, y)?];
        (near > f32::NEG_INFINITY).then_some(near)
    }

    fn index(&self, x: isize, y: isize) -> Option<usize> {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        let inside = x < self.width && y < self.height;
        inside.then_some(y * self.width + x)
    }

    /// Fills the pixels whose centres lie in a triangle, where it is the nearest so far, and calls `at` with
    /// them.
    fn fill(&mut self, [a, b, c]: [Seen; 3], mut at: impl FnMut(usize)) {
        let doubled_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if doubled_area == 0.0 || !doubled_area.is_finite() {
            return;
        }
        // Gradients of the barycentric weights of b and c, which are linear over the picture.
        let (bx, by) = ((c.y - a.y) / doubled_area, (a.x - c.x) / doubled_area);
        let (cx, cy) = ((a.y - b.y) / doubled_area, (b.x - a.x) / doubled_area);
        let columns = pixel_range([a.x, b.x, c.x], self.width);
        for y in pixel_range([a.y, b.y, c.y], self.height) {
            let dy = y as f64 + 0.5 - a.y;
            let row = y * self.width;
            for x in columns.clone() {
                let dx = x as f64 + 0.5 - a.x;
                let (of_b, of_c) = (dx * bx + dy * by, dx * cx + dy * cy);
                if of_b < 0.0 || of_c < 0.0 || of_b + of_c > 1.0 {
                    continue;
                }
                let nearness = a.nearness
                    + of_b * (b.nearness - a.nearness)
                    + of_c * (c.nearness - a.nearness);
                if nearness as f32 > self.nearness[row + x] {
                    self.nearness[row + x] = nearness as f32;
                    at(row + x);
                }
            }
        }
    }
}

/// Pixels along one axis whose centres may lie between the least and the largest of three values.
fn pixel_range(values: [f64; 3], size: usize) -> std::ops::Range<usize> {
    let least = values[0].min(values[1]).min(values[2]);
    let most = values[0].max(values[1]).max(values[2]);
    // Conversion of a float to an integer saturates.
    let low = (least - 0.5).ceil().max(0.0) as usize;
    let high = (most + 0.5).floor().max(0.0) as usize;
    low..high.min(size).max(low.min(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(x: f64, y: f64, nearness: f64) -> Seen {
        Seen { x, y, nearness }
    }

    #[test]
    fn two_triangles_fill_a_square_once_and_the_nearer_wins() {
        let mut buffer = DepthBuffer::new(10, 10);
        let square = [
            seen(2.0, 3.0, 1.0),
            seen(8.0, 3.0, 1.0),
            seen(8.0, 9.0, 1.0),
            seen(2.0, 9.0, 1.0),
        ];
        buffer.fill([square[0], square[1], square[2]], 1);
        buffer.fill([square[0], square[2], square[3]], 2);
        let count = |facet| buffer.facet.iter().filter(|&&f| f == facet).count();
        assert_eq!(count(1) + count(2), 36);
        assert_eq!(count(NOTHING), 64);
        buffer.fill(
            [
                seen(-5.0, -5.0, 0.5),
                seen(30.0, -5.0, 0.5),
                seen(-5.0, 30.0, 2.5),
            ],
            3,
        );
        // Nearer than the squares only where its slope has risen above 1.
        assert_eq!(buffer.at(2, 3).map(|p| p.0), Some(1));
        assert_eq!(buffer.at(2, 8).map(|p| p.0), Some(3));
        assert_eq!(buffer.at(10, 0), None);
        assert_eq!(buffer.at(-1, 0), None);
    }

    #[test]
    fn triangles_far_outside_or_not_finite_fill_nothing() {
        let mut buffer = DepthBuffer::new(4, 4);
        buffer.fill(
            [
                seen(1e12, 0.0, 1.0),
                seen(2e12, 0.0, 1.0),
                seen(1e12, 5.0, 1.0),
            ],
            1,
        );
        buffer.fill(
            [
                seen(f64::NAN, 0.0, 1.0),
                seen(4.0, 0.0, 1.0),
                seen(0.0, 5.0, 1.0),
            ],
            1,
        );
        assert!(buffer.facet.iter().all(|&f| f == NOTHING));
    }
}
