//! Placements of pairs, and pairs.

use super::bodies::TestBody;
use super::features::{Feature, Skin};
use crate::error::ContactError;
use crate::shape::Frame;
use femdem_mesh::strategies::{rotations, vectors};
use femdem_mesh::{Matrix3, Rotation, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Arrangement of two bodies relative to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Arrangement {
    /// No special arrangement: a random direction and orientation.
    General,
    /// A face on a face, in one plane where the depth is 0.
    FaceOnFace,
    /// A face on a face, and an edge of one along an edge of the other.
    AlignedFaces,
    /// An edge on an edge, parallel, crossed at right angles, or at any angle.
    EdgeOnEdge,
    /// A vertex on a vertex, outward directions opposed.
    VertexOnVertex,
    /// A vertex on a face.
    VertexOnFace,
    /// A vertex on a vertex, axes of the bodies parallel or at right angles: bodies of one lattice
    /// have planes, edges and corners in common.
    Lattice,
    /// The centroid of B near that of A: the smaller one inside, if there is room.
    Contained,
    /// The same body twice at the same place, or nearly so.
    Identical,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::General,
        Self::FaceOnFace,
        Self::AlignedFaces,
        Self::EdgeOnEdge,
        Self::VertexOnVertex,
        Self::VertexOnFace,
        Self::Lattice,
        Self::Contained,
        Self::Identical,
    ];
}

/// A placement of any two bodies. Lengths are in radii of the smaller body, except the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The arrangement of the bodies.
    pub arrangement: Arrangement,
    /// Which faces, edges or vertices meet, 0 to 1 of those of A and of B.
    pub picks: [f64; 2],
    /// Overlap depth of the features; negative: gap.
    pub depth: f64,
    /// Angle about the common direction, rad.
    pub angle: f64,
    /// Orientation of B relative to A where the arrangement leaves it free.
    pub turn: Rotation,
    /// Orientation of the pair.
    pub orientation: Rotation,
    /// Position of A, m.
    pub position: Vector3,
}

/// Two bodies and their frames.
#[derive(Debug, Clone, PartialEq)]
pub struct TestPair {
    /// Body A.
    pub a: TestBody,
    /// Frame of A.
    pub frame_a: Frame,
    /// Body B.
    pub b: TestBody,
    /// Frame of B.
    pub frame_b: Frame,
    /// Axes of a wall z <= 0 that touches A at the same place as B does, and as deep.
    pub frame_wall: Frame,
    /// The arrangement of the bodies.
    pub arrangement: Arrangement,
}

impl TestPair {
    /// Places two bodies.
    pub fn new(a: &TestBody, b: &TestBody, placement: &Placement) -> Self {
        let b = match placement.arrangement {
            Arrangement::Identical => a,
            _ => b,
        };
        let (contact, relative) = placement.relative(a, b);
        let frame_a = Frame {
            position: placement.position,
            rotation: placement.orientation.to_rotation_matrix().into_inner(),
        };
        let frame_b = Frame {
            position: frame_a.point(&relative.position),
            rotation: frame_a.rotation * relative.rotation,
        };
        // The outward direction of A's feature points into the wall.
        let [_, x, y] = crate::axes::complete(&-contact.outward);
        let axes = Matrix3::from_columns(&[x, y, -contact.outward]);
        let frame_wall = Frame {
            position: frame_a.point(&contact.point),
            rotation: frame_a.rotation * axes,
        };
        Self {
            a: a.clone(),
            frame_a,
            b: b.clone(),
            frame_b,
            frame_wall,
            arrangement: placement.arrangement,
        }
    }
}

impl Placement {
    /// The feature of A where the bodies meet, and the frame of B in A's axes.
    fn relative(&self, a: &TestBody, b: &TestBody) -> (Feature, Frame) {
        let (skin_a, skin_b) = (Skin(&a.mesh), Skin(&b.mesh));
        let depth = self.depth * a.radius().min(b.radius());
        let turn = self.turn.to_rotation_matrix().into_inner();
        let [i, j] = self.picks;
        let (mut on_a, rotation, on_b) = match self.arrangement {
            Arrangement::General => {
                let (mut on_a, on_b) = (skin_a.vertex(i), skin_b.vertex(j));
                on_a.outward = self.turn * on_a.outward;
                (on_a, turn, on_b)
            }
            Arrangement::FaceOnFace => opposed(skin_a.face(i), skin_b.face(j), self.angle),
            Arrangement::AlignedFaces => {
                let (mut on_a, mut on_b) = (skin_a.face(i), skin_b.face(j));
                (on_a.point, on_b.point) = (skin_a.vertex(i).point, skin_b.vertex(j).point);
                opposed(on_a, on_b, self.right_angles())
            }
            Arrangement::EdgeOnEdge => {
                let angle = if self.turn.w < 0.2 {
                    self.angle
                } else {
                    self.right_angles()
                };
                opposed(skin_a.edge(i), skin_b.edge(j), angle)
            }
            Arrangement::VertexOnVertex => opposed(skin_a.vertex(i), skin_b.vertex(j), self.angle),
            Arrangement::VertexOnFace => opposed(skin_a.face(i), skin_b.vertex(j), self.angle),
            Arrangement::Lattice => (skin_a.vertex(i), lattice(self), skin_b.vertex(j)),
            Arrangement::Contained => return (skin_a.face(i), self.inside(depth, turn)),
            Arrangement::Identical => {
                return (
                    skin_a.face(i),
                    self.inside(depth * 1e-6, Matrix3::identity()),
                );
            }
        };
        on_a.point -= on_a.outward * depth;
        let position = on_a.point - rotation * on_b.point;
        (on_a, Frame { position, rotation })
    }

    fn right_angles(&self) -> f64 {
        (self.angle / FRAC_PI_2).floor() * FRAC_PI_2
    }

    /// B with its centroid at a distance from that of A.
    fn inside(&self, distance: f64, rotation: Matrix3) -> Frame {
        Frame {
            position: self.turn * Vector3::x() * distance,
            rotation,
        }
    }
}

/// The rotation of B that opposes the outward direction of its feature to that of A's.
fn opposed(on_a: Feature, on_b: Feature, angle: f64) -> (Feature, Matrix3, Feature) {
    let (sin, cos) = angle.sin_cos();
    let turn = Matrix3::new(-1.0, 0.0, 0.0, 0.0, cos, sin, 0.0, sin, -cos);
    let rotation = on_a.axes() * turn * on_b.axes().transpose();
    (on_a, rotation, on_b)
}

/// A rotation that maps coordinate axes to coordinate axes.
fn lattice(placement: &Placement) -> Matrix3 {
    let quarter = |axis: usize, times: usize| {
        let (sin, cos) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][times % 4];
        let mut m = Matrix3::identity();
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        (m[(j, j)], m[(j, k)], m[(k, j)], m[(k, k)]) = (cos, -sin, sin, cos);
        m
    };
    let steps = (placement.angle / TAU * 64.0) as usize;
    quarter(0, steps) * quarter(1, steps / 4) * quarter(2, steps / 16)
}

/// Numbers from 10^`low` to 10^`high`, uniform in their logarithm.
fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..=high).prop_map(|e| 10_f64.powf(e))
}

/// Depths: none, tiny, ordinary ones of a pack, deep; and small gaps.
fn depths() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => Just(0.0),
        2 => decades(-16.0, -6.0),
        4 => decades(-6.0, -1.0),
        1 => 0.1..1.0_f64,
        1 => decades(-16.0, -2.0).prop_map(|d| -d),
    ]
}

/// Placements in all arrangements, at the origin, near it, and up to 1e5 m away.
pub fn placements() -> impl Strategy<Value = Placement> + Clone {
    let orientation = prop_oneof![Just(Rotation::identity()), rotations()];
    let position = prop_oneof![
        Just(Vector3::zeros()),
        vectors(1.0),
        (vectors(1.0), decades(0.0, 5.0)).prop_map(|(v, reach)| v * reach),
    ];
    let own = (
        prop::sample::select(&Arrangement::ALL[..]),
        prop::array::uniform2(0.0..1.0_f64),
        depths(),
        0.0..TAU,
        rotations(),
    );
    (own, orientation, position)
        .prop_map(
            |((arrangement, picks, depth, angle, turn), orientation, position)| Placement {
                arrangement,
                picks,
                depth,
                angle,
                turn,
                orientation,
                position,
            },
        )
        .boxed()
}

/// Sizes of A and of B: from 1e-9 to 1e6 m, mostly equal.
fn sizes() -> impl Strategy<Value = [f64; 2]> + Clone {
    let size = prop_oneof![1 => Just(0.1), 2 => decades(-9.0, 6.0)];
    let ratio = prop_oneof![3 => Just(1.0), 1 => decades(-3.0, 0.0)];
    (size, ratio, any::<bool>())
        .prop_map(|(size, ratio, first)| {
            if first {
                [size, size * ratio]
            } else {
                [size * ratio, size]
            }
        })
        .boxed()
}

/// Both bodies at the same or at different sizes.
fn sized([a, b]: [TestBody; 2], [size_a, size_b]: [f64; 2]) -> Result<[TestBody; 2], ContactError> {
    Ok([a.scaled(size_a)?, b.scaled(size_b)?])
}

/// Pairs of the given bodies that touch or nearly do, in all arrangements, from 1e-9 to 1e6 m in
/// size.
pub fn pairs<S>(bodies: S) -> impl Strategy<Value = TestPair>
where
    S: Strategy<Value = TestBody> + Clone,
{
    (bodies.clone(), bodies, sizes(), placements()).prop_filter_map(
        "bodies of this size",
        |(a, b, sizes, placement)| {
            let [a, b] = sized([a, b], sizes).ok()?;
            Some(TestPair::new(&a, &b, &placement))
        },
    )
}
