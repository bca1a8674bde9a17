//! Plane sections of a ball: integrals over a convex polygon, or the whole plane, within the disc in which the plane
//! cuts the ball.
//!
//! With s^2 = h^2 + rho^2 the distance from the ball's centre of a point of the plane, h that of the plane and rho the
//! distance from the foot of the centre, every integrand is either f(s) or x f(s), x from the foot. In polar
//! coordinates about the foot
//!
//! int f dA = int E(rho) dphi,   E = int_0^rho f r dr,
//!
//! over the boundary. On an arc of the rim E is constant, and on an edge, dphi = l dy/rho^2 for its distance l from the
//! foot, E/rho^2 is known in closed form and analytic. And x f(s) is the gradient of an H(s), so that int x f dA =
//! int H n dy over the boundary, with H chosen to vanish on the rim. Both are integrated along an edge by Gauss-Legendre
//! panels. The integrands are analytic but at the points of the edge's line, complex ones included, where s = 0; panels
//! whose half-lengths are a quarter of the distance of these points leave an error of 1e-14.

use super::rule::EIGHT;
use crate::kernel::Point;
use smallvec::SmallVec;
use std::f64::consts::TAU;

/// Half-length of a panel over the distance of its middle from the ball's centre, at most.
const PANEL: f64 = 0.25;

/// Panels are halved at most so many times: an edge through the ball's centre itself never satisfies [`PANEL`].
const MOST_HALVINGS: u32 = 40;

/// Heights below this fraction of the ball's radius count as this fraction, so that nothing is divided by zero.
const LOWEST: f64 = 1e-13;

/// The section of a ball of `radius` by a plane at `height` from its centre, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disc {
    pub radius: f64,
    pub height: f64,
    /// radius - height, m.
    pub depth: f64,
    /// Square of the disc's radius, m^2.
    pub square: f64,
}

/// A part of the boundary of a section.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Node {
    /// From the foot, m.
    pub at: Point,
    /// Outward normal times length, m.
    pub outward: Point,
    /// x . n dy = rho^2 dphi, m^2.
    pub wedge: f64,
    /// Distance from the ball's centre, m, and by how much it is smaller than the ball's radius.
    pub s: f64,
    pub t: f64,
    /// The same for the squares, m^2.
    pub u: f64,
}

/// Integrals as sums over nodes.
pub(super) trait Sum {
    fn add(&mut self, disc: &Disc, node: &Node);
}

/// Nothing is summed: only whether there is a section counts.
impl Sum for () {
    fn add(&mut self, _: &Disc, _: &Node) {}
}

impl<A: Sum, B: Sum> Sum for (A, B) {
    fn add(&mut self, disc: &Disc, node: &Node) {
        self.0.add(disc, node);
        self.1.add(disc, node);
    }
}

/// Twice the area of the triangle of the origin and two points.
fn cross(p: &Point, q: &Point) -> f64 {
    p.x * q.y - p.y * q.x
}

/// Angle at the origin from one point to another.
fn angle(p: &Point, q: &Point) -> f64 {
    cross(p, q).atan2(p.x * q.x + p.y * q.y)
}

impl Disc {
    /// `None` if the plane at the signed distance `height` does not cut the ball.
    pub fn new(radius: f64, height: f64) -> Option<Self> {
        let height = height.abs().max(LOWEST * radius);
        let depth = radius - height;
        (depth > 0.0).then_some(Self {
            radius,
            height,
            depth,
            square: depth * (radius + height),
        })
    }

    /// Adds the whole disc.
    pub fn add_whole(&self, sums: &mut impl Sum) {
        self.add_arc(TAU, sums);
    }

    /// Adds the part of the disc in a convex polygon, counter-clockwise and about the foot; returns whether there is
    /// any.
    pub fn add_polygon(&self, polygon: &[Point], sums: &mut impl Sum) -> bool {
        let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
        let edges: SmallVec<[_; 8]> = ends.map(|(p, q)| (p, q, Edge::new(self, p, q))).collect();
        if edges.iter().all(|(_, _, edge)| edge.is_none()) {
            // Seen from the foot, all run the same way round if it is inside.
            let whole = edges.iter().all(|(p, q, _)| cross(p, q) >= 0.0) && !edges.is_empty();
            if whole {
                self.add_whole(sums);
            }
            return whole;
        }
        let mut arcs = 0.0;
        for (p, q, edge) in &edges {
            match edge {
                Some(edge) => {
                    arcs += edge.arcs([p, q]);
                    self.add_edge(edge, edge.ends, MOST_HALVINGS, sums);
                }
                None => arcs += angle(p, q),
            }
        }
        self.add_arc(arcs, sums);
        true
    }

    fn add_arc(&self, angle: f64, sums: &mut impl Sum) {
        let node = Node {
            wedge: angle * self.square,
            s: self.radius,
            ..Node::default()
        };
        sums.add(self, &node);
    }

    fn add_edge(&self, edge: &Edge, [low, high]: [f64; 2], halvings: u32, sums: &mut impl Sum) {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let flat = self.height * self.height + edge.distance * edge.distance;
        let away2 = flat + middle * middle;
        if half * half > PANEL * PANEL * away2 && halvings > 0 {
            self.add_edge(edge, [low, middle], halvings - 1, sums);
            self.add_edge(edge, [middle, high], halvings - 1, sums);
            return;
        }
        for (node, weight) in EIGHT {
            let y = low + 2.0 * half * node;
            let length = 2.0 * half * weight;
            let s = (flat + y * y).sqrt();
            let u = (edge.half_chord - y) * (edge.half_chord + y);
            let node = Node {
                at: edge.point(y),
                outward: Point {
                    x: edge.normal().x * length,
                    y: edge.normal().y * length,
                },
                wedge: edge.distance * length,
                s,
                t: u / (self.radius + s),
                u,
            };
            sums.add(self, &node);
        }
    }
}

/// The part of an edge within the disc.
struct Edge {
    /// Unit vector along it.
    along: Point,
    /// Distance of its line from the foot, positive if the foot is on its inner side, m.
    distance: f64,
    /// Half the chord that the line cuts from the disc, m.
    half_chord: f64,
    /// Ends of the part in the disc and of the whole edge, from the line's foot, m.
    ends: [f64; 2],
    whole: [f64; 2],
}

impl Edge {
    /// `None` if no part of the edge from `p` to `q` is in the disc.
    fn new(disc: &Disc, p: &Point, q: &Point) -> Option<Self> {
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let length = dx.hypot(dy);
        if length.is_nan() || length <= 0.0 {
            return None;
        }
        let along = Point {
            x: dx / length,
            y: dy / length,
        };
        let distance = cross(p, &along);
        let square = disc.square - distance * distance;
        if square <= 0.0 {
            return None;
        }
        let half_chord = square.sqrt();
        let start = p.x * along.x + p.y * along.y;
        let whole = [start, start + length];
        let ends = [whole[0].max(-half_chord), whole[1].min(half_chord)];
        (ends[0] < ends[1]).then_some(Self {
            along,
            distance,
            half_chord,
            ends,
            whole,
        })
    }

    /// Unit normal away from the polygon.
    fn normal(&self) -> Point {
        Point {
            x: self.along.y,
            y: -self.along.x,
        }
    }

    fn point(&self, y: f64) -> Point {
        let normal = self.normal();
        Point {
            x: normal.x * self.distance + self.along.x * y,
            y: normal.y * self.distance + self.along.y * y,
        }
    }

    /// Angle of the arcs outside which the edge runs; `corners` are its ends.
    fn arcs(&self, [p, q]: [&Point; 2]) -> f64 {
        let mut sum = 0.0;
        if self.ends[0] > self.whole[0] {
            sum += angle(p, &self.point(self.ends[0]));
        }
        if self.ends[1] < self.whole[1] {
            sum += angle(&self.point(self.ends[1]), q);
        }
        sum
    }
}
