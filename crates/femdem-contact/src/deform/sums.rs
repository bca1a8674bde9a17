//! The sums of a pair, and the contributions of common parts of tetrahedra: nodal forces, wrenches, and loads
//! by triangle.

use crate::foundation::FoundationSums;
use crate::tets::current::Current;
use crate::tets::piece::{Moments, Piece};
use crate::tets::pieces::{for_skins, integral};
use crate::tets::polygon::PolygonSums;
use crate::tets::posed::Posed;
use femdem_mesh::Vector3;

/// Load on one triangle of B's skin and on what lies in front of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TriangleLoad {
    pub triangle: u32,
    /// Integral of the traction on B, N.
    pub force: Vector3,
    /// Integrals of p phi and x p phi, N and N m.
    pub pressure: f64,
    pub moment: Vector3,
    /// Of the polygons on it and in front of it.
    pub stiffness: FoundationSums,
    /// Tetrahedra of A and B (indices in the lists) between which the largest part of the load acts, and this
    /// part, N.
    pub hosts: [u32; 2],
    /// Vector area of the same polygons, towards B, m^2.
    pub area: Vector3,
    share: f64,
}

/// Sums over one pair. Points are about the pair's origin.
#[derive(Debug, Default)]
pub(crate) struct PairSums {
    /// By side and index of the node in the list.
    pub forces: [Vec<Vector3>; 2],
    /// The elastic part of `forces`, once [`keep_elastic`](Self::keep_elastic) has been called.
    pub elastic: [Vec<Vector3>; 2],
    pub stiffness: [Vec<f64>; 2],
    /// Rates due to friction, 1/s.
    pub rates: [Vec<f64>; 2],
    pub loads: Vec<TriangleLoad>,
    pub energy: f64,
    pub volume: f64,
    /// Force and torque on A and on B.
    pub wrench: [[Vector3; 2]; 2],
    /// Vector area of A's skin in B less that of B's in A.
    pub area: Vector3,
    /// Centre and normal times stiffness of the polygons, for rigid bodies.
    pub springs: Vec<Spring>,
    pub pieces: usize,
}

/// The stiffness of one polygon, N/m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    pub point: Vector3,
    pub normal: Vector3,
    pub stiffness: f64,
}

/// A tetrahedron of a side: its index in the list, the indices of its nodes, whether it is deformable.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place<'a> {
    pub tet: &'a Current,
    pub place: u32,
    pub nodes: Option<&'a [u32; 4]>,
}

/// Triangles of B's skin: by face of a tetrahedron, and the nearest one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Triangles {
    pub faces: [u32; 4],
    pub nearest: u32,
}

impl PairSums {
    pub fn reset(&mut self, nodes: [usize; 2]) {
        for (k, count) in nodes.into_iter().enumerate() {
            self.forces[k].clear();
            self.forces[k].resize(count, Vector3::zeros());
            self.stiffness[k].clear();
            self.stiffness[k].resize(count, 0.0);
            self.rates[k].clear();
            self.rates[k].resize(count, 0.0);
        }
        self.loads.clear();
        self.springs.clear();
        self.energy = 0.0;
        self.volume = 0.0;
        self.wrench = [[Vector3::zeros(); 2]; 2];
        self.area = Vector3::zeros();
        self.pieces = 0;
    }

    /// Adds the piece in the buffer, the common part of `sides`.
    pub fn add(
        &mut self,
        sides: [Place; 2],
        [a, b]: [&Posed; 2],
        triangles: &Triangles,
        flush: bool,
        piece: &mut Piece,
    ) {
        let (_, whole) = for_skins([a, b], flush, piece, |label, polygon, counts| {
            let (k, own) = (usize::from(label % 4), label < 4);
            let (skin, field, sign) = if own { (a, b, 1.0) } else { (b, a, -1.0) };
            let normal = skin.normals[k];
            let weight = normal.dot(&field.gradient).max(0.0);
            let triangle = if own {
                triangles.nearest
            } else {
                triangles.faces[k]
            };
            let sums = PolygonSums::new(polygon, &normal, field);
            self.area += normal * (sign * counts * sums.area);
            let normal = normal * sign;
            if let Some(centre) = self.add_polygon(&sides, triangle, &normal, weight, &sums) {
                for (side, place) in sides.iter().enumerate() {
                    self.stiffen(side, place, &centre, &normal, weight * sums.area);
                }
            }
        });
        if whole.volume.is_nan() || whole.volume <= 0.0 {
            return;
        }
        self.pieces += 1;
        self.volume += whole.volume;
        self.energy += integral(a, &whole) + integral(b, &whole);
        let gradient = a.gradient - b.gradient;
        self.add_side(0, &sides[0], &whole, &gradient, integral(b, &whole));
        self.add_side(1, &sides[1], &whole, &-gradient, integral(a, &whole));
    }

    /// Forces on one side: density `gradient` in the part with the given moments, and the other
    /// side's field integrated over it.
    fn add_side(
        &mut self,
        side: usize,
        place: &Place,
        part: &Moments,
        gradient: &Vector3,
        other: f64,
    ) {
        let total = gradient * part.volume;
        self.wrench[side][0] += total;
        self.wrench[side][1] += part.first.cross(gradient);
        let Some(nodes) = place.nodes else {
            return;
        };
        for (k, &node) in nodes.iter().enumerate() {
            let (level, slope) = (place.tet.levels[k], &place.tet.slopes[k]);
            let weight = level * part.volume + slope.dot(&part.first);
            if let Some(force) = self.forces[side].get_mut(node as usize) {
                *force += gradient * weight - slope * other;
            }
        }
    }

    /// Adds a polygon that carries pressure along `normal` (on B) to a triangle; returns its
    /// centroid, if it carries any.
    pub fn add_polygon(
        &mut self,
        sides: &[Place; 2],
        triangle: u32,
        normal: &Vector3,
        weight: f64,
        sums: &PolygonSums,
    ) -> Option<Vector3> {
        let carries = sums.area > 0.0 && (sums.pressure > 0.0 || weight > 0.0);
        if !carries {
            return None;
        }
        let load = self.load(triangle);
        load.force += normal * sums.pressure;
        load.pressure += sums.pressure;
        load.moment += sums.moment;
        load.stiffness += FoundationSums {
            total: weight * sums.area,
            first: sums.first * weight,
            second: sums.second * weight,
        };
        load.area += normal * sums.area;
        if sums.pressure > load.share {
            load.hosts = sides.map(|s| s.place);
            load.share = sums.pressure;
        }
        Some(sums.first / sums.area)
    }

    /// Adds a polygon's stiffness to the nodes of one side, or to the springs of a rigid one.
    pub fn stiffen(
        &mut self,
        side: usize,
        place: &Place,
        centre: &Vector3,
        normal: &Vector3,
        stiffness: f64,
    ) {
        let Some(nodes) = place.nodes else {
            self.springs.push(Spring {
                point: *centre,
                normal: *normal,
                stiffness,
            });
            return;
        };
        for (&node, weight) in nodes.iter().zip(place.tet.weights(centre)) {
            if let Some(total) = self.stiffness[side].get_mut(node as usize) {
                *total += stiffness * weight.max(0.0);
            }
        }
    }

    /// Saves the forces so far as the elastic ones.
    pub fn keep_elastic(&mut self) {
        for (kept, forces) in self.elastic.iter_mut().zip(&self.forces) {
            kept.clone_from(forces);
        }
    }

    /// Distributes the loads of slaves to their masters.
    pub fn fold(&mut self, side: usize, slaves: &[(u32, [u32; 4])]) {
        for (slave, masters) in slaves {
            hand_over(
                &mut self.forces[side],
                *slave,
                masters,
                Vector3::zeros(),
                QUARTER,
            );
            hand_over(&mut self.stiffness[side], *slave, masters, 0.0, QUARTER);
            // |sum v_m/4|^2 over the slave's inverse mass is at most sum m_m |v_m|^2: each master gets the
            // full rate.
            hand_over(&mut self.rates[side], *slave, masters, 0.0, 1.0);
        }
    }

    /// The load on a triangle, in the order of triangles.
    fn load(&mut self, triangle: u32) -> &mut TriangleLoad {
        let place = match self.loads.binary_search_by_key(&triangle, |l| l.triangle) {
            Ok(place) => place,
            Err(place) => {
                let load = TriangleLoad {
                    triangle,
                    force: Vector3::zeros(),
                    pressure: 0.0,
                    moment: Vector3::zeros(),
                    stiffness: FoundationSums::default(),
                    hosts: [u32::MAX; 2],
                    area: Vector3::zeros(),
                    share: 0.0,
                };
                self.loads.insert(place, load);
                place
            }
        };
        &mut self.loads[place]
    }
}

/// Share of each of four masters in a slave's load.
const QUARTER: f64 = 0.25;

/// Gives the fraction `part` of a slave's value to each of its masters, and resets the slave to `nothing`.
fn hand_over<T>(list: &mut [T], slave: u32, masters: &[u32; 4], nothing: T, part: f64)
where
    T: Copy + std::ops::Mul<f64, Output = T> + std::ops::AddAssign,
{
    let Some(own) = list.get_mut(slave as usize) else {
        return;
    };
    let share = std::mem::replace(own, nothing) * part;
    for &master in masters {
        if let Some(value) = list.get_mut(master as usize) {
            *value += share;
        }
    }
}
