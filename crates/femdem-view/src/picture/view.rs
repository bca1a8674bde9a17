//! Positions of eye and lamp: from world coordinates to picture coordinates.

use femdem_mesh::{Point3, Vector3};

/// A point in a picture: x to the right and y down in pixels, and how near it is.
///
/// `nearness` grows towards the eye, and is linear across the picture of a plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seen {
    pub x: f64,
    pub y: f64,
    pub nearness: f64,
}

/// An eye that looks at `centre`.
#[derive(Clone, Debug)]
pub(super) struct View {
    right: Vector3,
    up: Vector3,
    /// Unit vector towards the eye.
    pub toward: Vector3,
    centre: Point3,
    /// Distance of the eye from the centre; infinite for parallel rays.
    distance: f64,
    /// Pixels per metre at the centre.
    pub scale: f64,
    /// Where the centre appears.
    offset: [f64; 2],
}

/// A rectangle of the picture in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl View {
    /// Looks from `azimuth` (0 is the front, at negative y; to the right is positive) and `elevation`
    /// (radians), from `distance`, so that all `points` fit the frame.
    pub fn fit(
        azimuth: f64,
        elevation: f64,
        distance: f64,
        points: &[Point3],
        frame: Frame,
    ) -> Self {
        let (sin_a, cos_a) = azimuth.sin_cos();
        let (sin_e, cos_e) = elevation.sin_cos();
        let [low, high] = span(points);
        let mut view = Self {
            right: Vector3::new(cos_a, sin_a, 0.0),
            up: Vector3::new(-sin_a * sin_e, cos_a * sin_e, cos_e),
            toward: Vector3::new(sin_a * cos_e, -cos_a * cos_e, sin_e),
            centre: low + (high - low) * 0.5,
            distance,
            scale: 1.0,
            offset: [0.0; 2],
        };
        let seen: Vec<Seen> = points.iter().map(|p| view.see(p)).collect();
        let range = |of: fn(&Seen) -> f64| {
            let least = seen.iter().map(of).fold(f64::INFINITY, f64::min);
            let most = seen.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            (least, most)
        };
        let ((left, right), (top, bottom)) = (range(|s| s.x), range(|s| s.y));
        let tiny = f64::MIN_POSITIVE;
        view.scale = ((frame.right - frame.left) / (right - left).max(tiny))
            .min((frame.bottom - frame.top) / (bottom - top).max(tiny));
        view.offset = [
            0.5 * (frame.left + frame.right) - 0.5 * view.scale * (left + right),
            0.5 * (frame.top + frame.bottom) - 0.5 * view.scale * (top + bottom),
        ];
        view
    }

    /// Where a point appears.
    pub fn see(&self, point: &Point3) -> Seen {
        let from = point - self.centre;
        let depth = from.dot(&self.toward);
        let shrink = self.shrink(depth);
        Seen {
            x: self.offset[0] + self.scale * shrink * from.dot(&self.right),
            y: self.offset[1] - self.scale * shrink * from.dot(&self.up),
            nearness: if self.distance.is_finite() {
                shrink
            } else {
                depth
            },
        }
    }

    /// Apparent size at a depth, relative to that at the centre.
    fn shrink(&self, depth: f64) -> f64 {
        if self.distance.is_finite() {
            self.distance / (self.distance - depth)
        } else {
            1.0
        }
    }

    /// The distance in front of the centre that corresponds to a nearness \[m\].
    pub fn depth(&self, nearness: f64) -> f64 {
        if self.distance.is_finite() {
            self.distance * (1.0 - 1.0 / nearness)
        } else {
            nearness
        }
    }

    /// The point that appears at a position of the picture.
    pub fn point(&self, seen: Seen) -> Point3 {
        let depth = self.depth(seen.nearness);
        let metres = 1.0 / (self.scale * self.shrink(depth));
        self.centre + self.right * ((seen.x - self.offset[0]) * metres)
            - self.up * ((seen.y - self.offset[1]) * metres)
            + self.toward * depth
    }

    /// Whether a face with this normal through this point is a front face.
    pub fn faces(&self, normal: &Vector3, point: &Point3) -> bool {
        if self.distance.is_finite() {
            let eye = self.centre + self.toward * self.distance;
            normal.dot(&(eye - point)) > 0.0
        } else {
            normal.dot(&self.toward) > 0.0
        }
    }
}

/// Lowest and highest corner of the box around some points; the origin without any.
pub(super) fn span(points: &[Point3]) -> [Point3; 2] {
    let first = points.first().copied().unwrap_or_default();
    let corners = points.iter();
    corners.fold([first; 2], |[low, high], p| [low.inf(p), high.sup(p)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame {
        left: 10.0,
        top: 20.0,
        right: 110.0,
        bottom: 220.0,
    };

    fn corners() -> Vec<Point3> {
        (0..8)
            .map(|i| Point3::from([0, 1, 2].map(|k| f64::from(i >> k & 1) * [1.0, 2.0, 3.0][k])))
            .collect()
    }

    #[test]
    fn everything_fits_and_a_side_is_touched() {
        for distance in [f64::INFINITY, 20.0] {
            let view = View::fit(0.4, 0.3, distance, &corners(), FRAME);
            let seen: Vec<Seen> = corners().iter().map(|p| view.see(p)).collect();
            let slack = |s: &Seen| {
                (s.x - FRAME.left)
                    .min(FRAME.right - s.x)
                    .min(s.y - FRAME.top)
                    .min(FRAME.bottom - s.y)
            };
            let least = seen.iter().map(slack).fold(f64::INFINITY, f64::min);
            assert!(least.abs() < 1e-9, "{least}");
        }
    }

    #[test]
    fn seeing_and_placing_are_inverse() {
        for distance in [f64::INFINITY, 20.0] {
            let view = View::fit(0.4, 0.3, distance, &corners(), FRAME);
            for p in corners() {
                assert!((view.point(view.see(&p)) - p).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn from_the_front_x_goes_right_z_goes_up_and_y_goes_away() {
        let view = View::fit(0.0, 0.0, 20.0, &corners(), FRAME);
        let at = |x, y, z| view.see(&Point3::new(x, y, z));
        assert!(at(1.0, 1.0, 1.0).x > at(0.0, 1.0, 1.0).x);
        assert!(at(0.0, 1.0, 2.0).y < at(0.0, 1.0, 1.0).y);
        assert!(at(0.0, 0.0, 1.0).nearness > at(0.0, 1.0, 1.0).nearness);
        assert!(view.faces(&-Vector3::y(), &Point3::origin()));
        assert!(!view.faces(&Vector3::y(), &Point3::new(0.0, 2.0, 0.0)));
    }
}
