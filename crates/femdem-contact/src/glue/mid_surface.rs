//! The triangle between the two sides of a facet.

use femdem_mesh::Vector3;

/// The triangle midway between the two sides of a facet, and its axes: the normal, from the first side to the second where the
/// crack opens, the direction of the first edge, and the third.
#[derive(Clone, Copy, Debug)]
pub struct MidSurface {
    /// Normal, along the first edge, and normal to both.
    pub axes: [Vector3; 3],
    edges: [Vector3; 2],
    /// Length of the first edge, m, and of the normal before it was made a unit: twice the area, m².
    sizes: [f64; 2],
}

impl MidSurface {
    /// The mid-surface of the sides; `None` where it has no area. The nodes of either side are counter-clockwise seen from the
    /// second.
    #[must_use]
    pub fn new(a: &[Vector3; 3], b: &[Vector3; 3]) -> Option<Self> {
        let mid = |q: usize| (a[q] + b[q]) * 0.5;
        let edges = [mid(1) - mid(0), mid(2) - mid(0)];
        let area = edges[0].cross(&edges[1]);
        let sizes = [edges[0].norm(), area.norm()];
        let normal = area.try_normalize(0.0)?;
        let along = edges[0].try_normalize(0.0)?;
        Some(Self {
            axes: [normal, along, normal.cross(&along)],
            edges,
            sizes,
        })
    }

    /// Openings of the pairs of nodes in its axes, m.
    #[must_use]
    pub fn openings(&self, a: &[Vector3; 3], b: &[Vector3; 3]) -> [[f64; 3]; 3] {
        [0, 1, 2].map(|q| self.axes.map(|axis| axis.dot(&(b[q] - a[q]))))
    }

    /// Forces on the nodes of the sides, N, from the derivatives of an energy by the [openings](Self::openings), N.
    ///
    /// The axes turn with the nodes: with the pull T_q = Σ_i (∂U/∂δ_qi) e_i and C = Σ_q T_q × d_q, the energy changes by ω·C where
    /// they turn by ω, which the nodes of the mid-surface feel.
    #[must_use]
    pub fn forces(
        &self,
        a: &[Vector3; 3],
        b: &[Vector3; 3],
        slopes: &[[f64; 3]; 3],
    ) -> [[Vector3; 3]; 2] {
        let [normal, _, third] = self.axes;
        let pull = slopes.map(|t| self.axes[0] * t[0] + self.axes[1] * t[1] + self.axes[2] * t[2]);
        let couple: Vector3 = (0..3).map(|q| pull[q].cross(&(b[q] - a[q]))).sum();
        // ω = n x dn + (e2 . de1) n, where dn = (I - n n) dN / |N| and e2 . de1 = e2 . d(m1 - m0) / L.
        let tilt = couple.cross(&normal) / self.sizes[1];
        let spin = third * (couple.dot(&normal) / self.sizes[0]);
        let first = self.edges[1].cross(&tilt) + spin;
        let second = tilt.cross(&self.edges[0]);
        // Each side has half of the mid-surface.
        let turning = [-(first + second), first, second].map(|x| x * 0.5);
        [1.0, -1.0].map(|sign| [0, 1, 2].map(|q| pull[q] * sign - turning[q]))
    }
}
