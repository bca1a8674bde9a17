//! Tetrahedra with shape functions, about the origin of a contact.

use super::posed::{Posed, bounds, extent};
use femdem_mesh::{Matrix3, Vector3};

/// A tetrahedron posed about the origin of a pair.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Current {
    pub corners: [Vector3; 4],
    /// The field at the corners, Pa: scaled by the pressure of the pair's law.
    pub values: [f64; 4],
    /// Its gradient, Pa/m.
    pub gradient: Vector3,
    /// Shape functions of the corners, `levels[k]` + `slopes[k]`.x.
    pub levels: [f64; 4],
    pub slopes: [Vector3; 4],
    /// m^3.
    pub six_volumes: f64,
    pub low: Vector3,
    pub high: Vector3,
    /// Largest extent of the box, m.
    pub size: f64,
    /// Bit k: the face opposite corner k lies on the skin.
    pub skin: u8,
}

impl Current {
    /// Sets this to the tetrahedron of `corners` with the given field; `false` if its volume is not positive.
    #[must_use]
    #[inline(always)]
    pub fn deform(
        &mut self,
        corners: [Vector3; 4],
        values: &[f64; 4],
        pressure: f64,
        skin: u8,
    ) -> bool {
        let [a, b, c, d] = &corners;
        let (ab, ac, ad) = (b - a, c - a, d - a);
        // Twice the area vectors, outwards; their sum is zero.
        let (of_b, of_c, of_d) = (ad.cross(&ac), ab.cross(&ad), ac.cross(&ab));
        let of_a = -(of_b + of_c + of_d);
        let six_volumes = -of_d.dot(&ad);
        if six_volumes.is_nan() || six_volumes <= 0.0 {
            return false;
        }
        let scale = -1.0 / six_volumes;
        self.slopes = [of_a * scale, of_b * scale, of_c * scale, of_d * scale];
        self.levels = [
            -self.slopes[0].dot(b),
            -self.slopes[1].dot(c),
            -self.slopes[2].dot(d),
            -self.slopes[3].dot(a),
        ];
        // The slopes add up to zero, so only differences of values enter.
        self.gradient = (self.slopes[1] * (values[1] - values[0])
            + self.slopes[2] * (values[2] - values[0])
            + self.slopes[3] * (values[3] - values[0]))
            * pressure;
        self.values = values.map(|v| v * pressure);
        self.six_volumes = six_volumes;
        [self.low, self.high] = bounds(&corners);
        self.size = extent(&self.low, &self.high);
        self.skin = skin;
        self.corners = corners;
        true
    }

    /// The corner with the largest value, which lies inside the body.
    #[inline(always)]
    pub fn pole(&self) -> usize {
        let larger = |i: usize, k: usize| {
            if self.values[k] > self.values[i] {
                k
            } else {
                i
            }
        };
        larger(larger(0, 1), larger(2, 3))
    }

    /// Computes the shape functions anew from the corners, so that they are zero at corners that a pose has rounded.
    pub fn align(&mut self) {
        for face in 0..4 {
            let normal = -self.slopes[face].normalize();
            let offset = normal.dot(&self.corners[(face + 1) % 4]);
            let inverse_height = 1.0 / (offset - normal.dot(&self.corners[face]));
            self.slopes[face] = normal * -inverse_height;
            self.levels[face] = offset * inverse_height;
        }
    }

    /// The tetrahedron of a rigid body at x -> rotation x + offset, with its field in units of `pressure`.
    #[inline(always)]
    pub fn placed(&self, rotation: &Matrix3, offset: &Vector3, pressure: f64) -> Self {
        let [a, b, c, d] = &self.corners;
        let at = |x: &Vector3| rotation * x + offset;
        let [e, f, g, h] = &self.slopes;
        let slopes = [rotation * e, rotation * f, rotation * g, rotation * h];
        self.posed(
            [at(a), at(b), at(c), at(d)],
            slopes,
            rotation * self.gradient,
            offset,
            pressure,
        )
    }

    /// As [`placed`](Self::placed), without a rotation and in its own units.
    #[inline(always)]
    pub fn shifted(&self, offset: &Vector3) -> Self {
        let [a, b, c, d] = &self.corners;
        let corners = [a + offset, b + offset, c + offset, d + offset];
        self.posed(corners, self.slopes, self.gradient, offset, 1.0)
    }

    #[inline(always)]
    fn posed(
        &self,
        corners: [Vector3; 4],
        slopes: [Vector3; 4],
        gradient: Vector3,
        offset: &Vector3,
        pressure: f64,
    ) -> Self {
        let [low, high] = bounds(&corners);
        let [p, q, r, s] = &slopes;
        let levels = &self.levels;
        Self {
            levels: [
                levels[0] - p.dot(offset),
                levels[1] - q.dot(offset),
                levels[2] - r.dot(offset),
                levels[3] - s.dot(offset),
            ],
            gradient: gradient * pressure,
            values: self.values.map(|v| v * pressure),
            six_volumes: self.six_volumes,
            size: extent(&low, &high),
            skin: self.skin,
            corners,
            slopes,
            low,
            high,
        }
    }

    /// The same, with the planes of its faces.
    pub fn planes(&self) -> Posed {
        let normals = [0, 1, 2, 3].map(|k| self.normal(k));
        let [a, b, c, d] = &self.corners;
        Posed {
            corners: self.corners,
            offsets: [
                normals[0].dot(b),
                normals[1].dot(c),
                normals[2].dot(d),
                normals[3].dot(a),
            ],
            normals,
            gradient: self.gradient,
            level: self.values[0] - self.gradient.dot(a),
            low: self.low,
            high: self.high,
            size: self.size,
            skin: self.skin,
        }
    }

    /// The outward normal of a face.
    #[inline(always)]
    pub fn normal(&self, face: usize) -> Vector3 {
        self.slopes[face] * (-1.0 / self.slopes[face].norm())
    }

    /// The signed distance of a face from a point along its outward normal, m: negative in front of it.
    #[inline]
    pub fn height(&self, face: usize, x: &Vector3) -> f64 {
        self.normal(face).dot(&(self.corners[(face + 1) % 4] - x))
    }

    /// Distance of a point along the normals of the faces, m; 0 if its shape functions are no less than -`noise`.
    #[inline]
    pub fn gap(&self, x: &Vector3, noise: f64) -> f64 {
        let mut gap = 0.0;
        for (weight, slope) in self.weights(x).iter().zip(&self.slopes) {
            if *weight < -noise {
                gap = f64::max(gap, -weight / slope.norm());
            }
        }
        gap
    }

    /// Whether the boxes overlap.
    #[inline(always)]
    pub fn is_near(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// The shape functions at a point.
    #[inline]
    pub fn weights(&self, x: &Vector3) -> [f64; 4] {
        let [a, b, c, d] = &self.slopes;
        let levels = &self.levels;
        [
            levels[0] + a.dot(x),
            levels[1] + b.dot(x),
            levels[2] + c.dot(x),
            levels[3] + d.dot(x),
        ]
    }
}
