//! Sums over a patch, for unit penalty, about the local origin.

use crate::foundation::FoundationSums;
use crate::tets::polygon::PolygonSums;
use femdem_mesh::Vector3;
use std::ops::AddAssign;

/// Sums over a patch and over the polygons of both skins that bound it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sums {
    pub volume: f64,
    /// Integral of the energy density.
    pub energy: f64,
    /// Force and torque on B.
    pub force: Vector3,
    pub torque: Vector3,
    /// Integrals of phi, x phi, |x|^2 phi over the polygons.
    pub pressure: f64,
    pub pressure_moment: Vector3,
    pub pressure_second: f64,
    /// Of the polygons.
    pub stiffness: FoundationSums,
    /// Integrals of n over A's polygons and over B's.
    pub areas: [Vector3; 2],
    /// Mean of the integrals of x cross n over B's polygons and of minus that over A's.
    pub area_moment: Vector3,
    /// Integral of x.n over all polygons: three times the volume that they enclose, if they are closed.
    pub enclosed: f64,
}

impl AddAssign<&Self> for Sums {
    fn add_assign(&mut self, other: &Self) {
        self.volume += other.volume;
        self.energy += other.energy;
        self.force += other.force;
        self.torque += other.torque;
        self.pressure += other.pressure;
        self.pressure_moment += other.pressure_moment;
        self.pressure_second += other.pressure_second;
        self.stiffness += other.stiffness;
        self.enclosed += other.enclosed;
        self.area_moment += other.area_moment;
        for (area, more) in self.areas.iter_mut().zip(&other.areas) {
            *area += more;
        }
    }
}

/// Largest vector area of a closed surface over those of its parts.
const CLOSED: f64 = 1e-6;

impl Sums {
    /// Whether the polygons of both skins surely are the outer boundary of a part of the overlap: they are closed, and
    /// enclose a positive volume. The boundary of a hole in it encloses a negative one. (Where skins coincide, polygons
    /// are missing.)
    pub fn is_outer(&self) -> bool {
        let [a, b] = &self.areas;
        (a + b).norm() <= CLOSED * (a.norm() + b.norm()) && self.enclosed > 0.0
    }

    /// Adds what a polygon of one side's skin tells of the area, the pressure and the stiffness. `gradient` is that of
    /// the other side's field, and `counts` the part of the area that counts.
    #[inline(always)]
    pub fn add_polygon(
        &mut self,
        side: usize,
        sums: &PolygonSums,
        normal: &Vector3,
        gradient: &Vector3,
        counts: f64,
    ) {
        let weight = normal.dot(gradient);
        if weight > 0.0 {
            self.stiffness += FoundationSums {
                total: weight * sums.area,
                first: sums.first * weight,
                second: sums.second * weight,
            };
        }
        self.pressure += sums.pressure;
        self.pressure_moment += sums.moment;
        self.pressure_second += sums.spread;
        self.areas[side] += normal * (counts * sums.area);
        let half = if side == 1 { 0.5 } else { -0.5 };
        self.area_moment += sums.first.cross(normal) * (half * counts);
    }
}
