//! The field of a body, linear in each of its cells, over the part of a sphere within it.
//!
//! Cells are tetrahedra, or the pyramids over the facets of a convex polyhedron. In cell i the field is
//! phi = a_i + g_i . y, y from the body's origin. With D_i the part of the ball in the cell, V_i its volume and M_i its
//! first moment about the ball's centre, S the part of the sphere in the body, the divergence theorem gives (x from the
//! ball's centre, n = x/R on S; phi vanishes on the skin and is continuous between cells)
//!
//! int_S phi n dS = sum g_i V_i,   int_S phi x dS = R int_S phi n dS,   R int_S phi dS = 3 int phi dV + sum g_i . M_i,
//!
//! and for the moments of the stiffness per area n . grad phi, with A_f the faces of D_i other than S and their normals
//! n_f out of D_i,
//!
//! int_S n_k x_j dS = V_i delta_jk - sum_f n_k int x_j dA, and likewise for 1 and for x_i x_j.
//!
//! V_i and M_i are those of the ball, if its centre is in the cell, less what lies behind the faces ([`SolidSums`]).
//!
//! The stiffness of polyhedra counts nothing where n . grad phi is negative. Here it counts nothing for a cell over
//! whose part of the sphere the sum is negative, which differs only where the sphere is in touch on both sides of the
//! circle on which n . grad phi = 0: at edges sharper than 90 degrees, or pressed in deep beside an edge.

use super::patch::{Face, Patch};
use super::sums::SolidSums;
use crate::foundation::FoundationSums;
use femdem_mesh::Vector3;
use smallvec::SmallVec;
use std::f64::consts::PI;

/// A ball centred inside a body is moved by this, over its radius, off the faces between its cells.
pub(super) const ASIDE: [f64; 3] = [1.9e-11, 1.3e-11, 0.7e-11];

/// The field in a cell, `level` + `slope` . y at y from the body's origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear {
    pub level: f64,
    /// 1/m.
    pub slope: Vector3,
}

/// The part of the ball in a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    number: u32,
    field: Linear,
    /// V_i and M_i.
    volume: f64,
    moment: Vector3,
    /// Of the faces: sum g_i . n_f int dA, and with x and x x^T.
    faces: FoundationSums,
}

/// A body's field over the sphere.
#[derive(Debug, Default)]
pub(super) struct OwnField {
    cells: SmallVec<[Cell; 4]>,
}

impl OwnField {
    /// The cell of a number, which is made with this field if it is new.
    pub fn cell(&mut self, number: u32, field: impl FnOnce() -> Linear) -> &mut Cell {
        let known = self.cells.iter().rposition(|cell| cell.number == number);
        let k = known.unwrap_or_else(|| {
            self.cells.push(Cell {
                number,
                field: field(),
                volume: 0.0,
                moment: Vector3::zeros(),
                faces: FoundationSums::default(),
            });
            self.cells.len() - 1
        });
        &mut self.cells[k]
    }

    /// Adds the field over the sphere around a centre (from the body's origin) to a patch.
    pub fn add_to(&self, patch: &mut Patch, centre: &Vector3, radius: f64) {
        let (mut force, mut along, mut energy) = (Vector3::zeros(), 0.0, 0.0);
        for cell in &self.cells {
            let Linear { level, slope } = &cell.field;
            force += slope * cell.volume;
            along += slope.dot(&cell.moment);
            energy += (level + slope.dot(centre)) * cell.volume;
            // Less than none where the sphere turns away from the field.
            if cell.faces.total < 0.0 {
                let across = slope * cell.moment.transpose();
                patch.stiffness += FoundationSums {
                    total: -cell.faces.total,
                    first: slope * cell.volume - cell.faces.first,
                    second: across + across.transpose() - cell.faces.second,
                };
            }
        }
        energy += along;
        let pressure = (3.0 * energy + along) / radius;
        patch.force -= force;
        patch.pressure += pressure;
        patch.moment += force * radius;
        patch.second += pressure * radius * radius;
        patch.energy += energy;
    }
}

impl Cell {
    /// Adds a face; `sign` is -1 if its normal points into the cell.
    pub fn add(&mut self, face: &Face, sign: f64, sums: &SolidSums) {
        let (n, side) = (&face.normal, face.side());
        self.volume -= sign * side * sums.volume;
        self.moment -= (n * sums.moment_normal + face.vector(&sums.moment) * side) * sign;
        let steep = sign * self.field.slope.dot(n);
        let first = face.foot() * sums.area + face.vector(&sums.first);
        self.faces += FoundationSums {
            total: steep * sums.area,
            first: first * steep,
            second: face.second(sums.area, &sums.first, &sums.second) * steep,
        };
    }

    /// Adds the whole ball, whose centre lies in the cell.
    pub fn add_centre(&mut self, radius: f64) {
        self.volume += 4.0 / 3.0 * PI * radius.powi(3);
    }
}
