//! The light that reaches a point: shadows of the lamp, and dark narrow gaps.

use femdem_mesh::{Point3, Vector3};

use super::raster::{DepthBuffer, DepthMap};
use super::view::{Seen, View};

/// The pixel in which a coordinate lies. `f64::floor` is a call where the processor may be an old one.
fn floor(x: f64) -> isize {
    let toward_zero = x as isize;
    toward_zero - isize::from(x < toward_zero as f64)
}

/// Points spread evenly over the unit disc (a sunflower: Vogel 1979).
fn disc<const N: usize>() -> [[f64; 2]; N] {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    std::array::from_fn(|k| {
        let radius = ((k as f64 + 0.5) / N as f64).sqrt();
        let angle = GOLDEN_ANGLE * k as f64;
        [radius * angle.cos(), radius * angle.sin()]
    })
}

/// One of four rotations of a sample pattern, different for neighbouring pixels: bands caused by few samples
/// become a fine grain that the eye does not see.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    sin: f64,
    cos: f64,
}

impl Turn {
    pub fn of_pixel(x: usize, y: usize) -> Self {
        let (sin, cos) = (0.35 * ((x + 2 * y) % 4) as f64).sin_cos();
        Self { sin, cos }
    }

    fn apply(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.cos - y * self.sin, x * self.sin + y * self.cos]
    }
}

/// The lamp and its view; what it does not see lies in shadow.
pub(super) struct Lamp {
    view: View,
    seen: DepthMap,
    samples: [[f64; 2]; 32],
    /// Radius of the penumbra \[pixels of the lamp\].
    blur: f64,
}

impl Lamp {
    pub fn new(view: View, seen: DepthMap, penumbra: f64) -> Self {
        let blur = (penumbra * view.scale).max(1.0);
        Self {
            view,
            seen,
            samples: disc(),
            blur,
        }
    }

    /// Unit vector towards the lamp.
    pub fn direction(&self) -> Vector3 {
        self.view.toward
    }

    /// Share of the lamp, 0 to 1, that a point on a surface with this normal sees.
    pub fn share(&self, point: &Point3, normal: &Vector3, turn: Turn) -> f64 {
        if normal.dot(&self.direction()) <= 0.0 {
            return 0.0;
        }
        // Surfaces must not shade themselves: start a few of the lamp's pixels off the surface.
        let lift = (1.0 + self.blur) / self.view.scale;
        let Seen { x, y, nearness } = self.view.see(&(point + normal * lift));
        let sees = |sample: &[f64; 2]| {
            let [dx, dy] = turn.apply(*sample);
            let (x, y) = (x + self.blur * dx, y + self.blur * dy);
            let blocker = self.seen.at(floor(x), floor(y));
            blocker.is_none_or(|near| f64::from(near) <= nearness + lift)
        };
        // Most points see all of the lamp or nothing of it: a quarter of the samples, spread over it, shows which.
        let share_of = |step: usize| {
            let lit = self
                .samples
                .iter()
                .step_by(step)
                .filter(|s| sees(s))
                .count();
            lit as f64 / (self.samples.len() / step) as f64
        };
        let rough = share_of(4);
        if rough == 0.0 || rough == 1.0 {
            rough
        } else {
            share_of(1)
        }
    }
}

/// Ambient occlusion from the visible surfaces (after McGuire et al. 2011, "The Alchemy screen-space ambient
/// obscurance algorithm").
pub(super) struct Gaps<'a> {
    pub view: &'a View,
    pub seen: &'a DepthBuffer,
    /// The distance over which neighbours darken each other \[m\].
    reach: f64,
    samples: [[f64; 2]; 40],
}

impl<'a> Gaps<'a> {
    pub fn new(view: &'a View, seen: &'a DepthBuffer, reach: f64) -> Self {
        Self {
            view,
            seen,
            reach,
            samples: disc(),
        }
    }

    /// Share of the sky, 0 to 1, that a point on a surface with this normal sees.
    pub fn openness(&self, point: &Point3, normal: &Vector3, turn: Turn) -> f64 {
        const STRENGTH: f64 = 4.0;
        let here = self.view.see(point);
        let radius = (self.reach * self.view.scale * 0.8).max(2.0);
        let mut blocked = 0.0;
        for sample in &self.samples {
            let [dx, dy] = turn.apply(*sample);
            let (x, y) = (floor(here.x + radius * dx), floor(here.y + radius * dy));
            let Some((_, near)) = self.seen.at(x, y) else {
                continue;
            };
            let seen = Seen {
                x: x as f64 + 0.5,
                y: y as f64 + 0.5,
                nearness: f64::from(near),
            };
            let to = self.view.point(seen) - point;
            let distance = to.norm();
            if distance > 0.0 && distance < self.reach {
                // Nothing at grazing angles, where the pixels of the surface itself lie.
                let rise = (normal.dot(&to) / distance - 0.08).max(0.0);
                blocked += rise * (1.0 - (distance / self.reach).powi(2));
            }
        }
        (1.0 - STRENGTH * blocked / self.samples.len() as f64).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene::Mesh;
    use super::super::view::Frame;
    use super::*;
    use crate::testing::{by_sequence, two_cubes};

    #[test]
    fn a_stack_shades_the_floor_behind_it_and_not_its_own_top() {
        let snapshot = two_cubes();
        let mut mesh = Mesh::of_bodies(&snapshot, &by_sequence(&snapshot));
        let floor = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]];
        mesh.add_floor(&floor.map(|[x, y]| Point3::new(x, y, 0.0)));
        let frame = Frame {
            left: 0.0,
            top: 0.0,
            right: 400.0,
            bottom: 400.0,
        };
        // The lamp stands at the front, 45 degrees high; the stack is 2 m high and 1 m wide.
        let view = View::fit(
            0.0,
            std::f64::consts::FRAC_PI_4,
            f64::INFINITY,
            &mesh.points().collect::<Vec<_>>(),
            frame,
        );
        let seen = DepthMap::of(&mesh, &view, 400, 400);
        let lamp = Lamp::new(view, seen, 0.01);
        let share =
            |x, y, z| lamp.share(&Point3::new(x, y, z), &Vector3::z(), Turn::of_pixel(0, 0));
        assert_eq!(share(0.25, 1.5, 0.0), 0.0);
        assert_eq!(share(0.25, 3.0, 0.0), 1.0);
        assert_eq!(share(0.25, 0.0, 2.0), 1.0);
        assert_eq!(share(2.0, 0.0, 0.0), 1.0);
    }

    #[test]
    fn the_foot_of_a_wall_is_dimmer_than_open_ground() {
        let snapshot = two_cubes();
        let mut mesh = Mesh::of_bodies(&snapshot, &by_sequence(&snapshot));
        let floor = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]];
        mesh.add_floor(&floor.map(|[x, y]| Point3::new(x, y, 0.0)));
        let frame = Frame {
            left: 0.0,
            top: 0.0,
            right: 400.0,
            bottom: 400.0,
        };
        let view = View::fit(0.0, 0.7, 30.0, &mesh.points().collect::<Vec<_>>(), frame);
        let seen = DepthBuffer::of(&mesh, &view, 400, 400);
        let gaps = Gaps::new(&view, &seen, 1.0);
        let turn = Turn::of_pixel(0, 0);
        let openness = |y| gaps.openness(&Point3::new(0.25, y, 0.0), &Vector3::z(), turn);
        assert!(
            openness(-0.55) < 0.9 * openness(-3.0),
            "{} {}",
            openness(-0.55),
            openness(-3.0)
        );
        assert!(openness(-3.0) > 0.95);
    }
}
