//! The sums of a pair as integrals over skins: the triangles of one skin inside the tetrahedra of the other body.
//!
//! With U_A = ∫ p φ_A dV over the overlap, the force on the nodes of B's skin is -p ∫ φ_A N_b n_B dS over the
//! part of it in A. The nodes of A get the opposite with their own shape functions, and -I_i grad N_a in each
//! of A's tetrahedra i, where I_i = ∫ p φ_A dV over the part of i that is in B. Likewise for U_B.
//!
//! I_i, of which the energy is the sum, follows from fluxes through the same triangles: see [`tets::skins`](crate::tets::skins).

use super::sums::{PairSums, Place, Triangles};
use crate::tets::clip::Flux;
use crate::tets::row::Lanes;
use crate::tets::skins::{Gather, Met, Polygon, meet};
use femdem_mesh::{Matrix3, Vector3};

/// Action of the skin of the other body on one tetrahedron.
#[derive(Debug, Clone, Copy, Default)]
struct HostSums {
    /// Force, N, and the sum of its parts (columns) times the points (rows) where they act, N m.
    force: Vector3,
    moment: Matrix3,
    /// ∫ p φ dV and ∫ dV over the part in the other body.
    flux: Flux,
    /// Stiffness, N/m, and its first moment, N.
    stiffness: f64,
    first: Vector3,
}

/// Action of the other body on one face of a skin.
#[derive(Debug, Clone, Copy, Default)]
struct FaceSums {
    /// Of the part in the other body, m^2.
    area: f64,
    /// Integrals of p φ and x p φ, N and N m.
    pressure: f64,
    moment: Vector3,
    /// Stiffness, N/m, and its first moment, N.
    stiffness: f64,
    first: Vector3,
}

/// Sums of the tetrahedra and of their faces.
#[derive(Debug, Default)]
pub(crate) struct SkinScratch {
    /// By side and index in the list.
    hosts: [Vec<HostSums>; 2],
    faces: [Vec<[FaceSums; 4]>; 2],
    /// Which data of a tetrahedron is set, as bits: corners that lie in the other body, [`OF_FACE`] and
    /// [`OF_HOST`]. Sums without their bit are left over from another pair.
    met: [Vec<u16>; 2],
}

/// The sums of face 0 are set; the next bits are those of the other faces.
const OF_FACE: u16 = 1 << 4;

/// The sums as a host are set.
const OF_HOST: u16 = 1 << 8;

impl SkinScratch {
    pub fn reset(&mut self, counts: [usize; 2]) {
        for (side, count) in counts.into_iter().enumerate() {
            self.hosts[side].resize(count, HostSums::default());
            self.faces[side].resize(count, [FaceSums::default(); 4]);
            self.met[side].clear();
            self.met[side].resize(count, 0);
        }
    }

    /// Sets bits of a tetrahedron; returns the bits before.
    #[inline(always)]
    fn note(&mut self, side: usize, place: u32, bits: u16) -> u16 {
        let met = self.met[side].get_mut(place as usize);
        met.map_or(0, |met| std::mem::replace(met, *met | bits))
    }
}

/// Adds the polygons of a pair of tetrahedra to the sums of its pair of bodies.
struct Adds<'a> {
    sums: &'a mut PairSums,
    sides: &'a [Place<'a>; 2],
    triangles: &'a Triangles,
    scratch: &'a mut SkinScratch,
}

impl Gather for Adds<'_> {
    #[inline(always)]
    fn note(&mut self, side: usize, sunken: u8) {
        let place = self.sides[side].place;
        self.scratch.note(side, place, u16::from(sunken));
    }

    /// Adds a polygon of a face of one side's skin in the other side's tetrahedron, with its flux.
    #[inline(always)]
    fn add(&mut self, polygon: &Polygon) {
        let Self {
            sums: all,
            sides,
            scratch,
            ..
        } = self;
        let Polygon {
            side,
            face,
            normal,
            sums,
            flux,
            ..
        } = polygon;
        let (side, face) = (*side, *face);
        let triangle = if side == 0 {
            self.triangles.nearest
        } else {
            self.triangles.faces[face]
        };
        let (own, host) = (&sides[side], &sides[1 - side]);
        let known = scratch.note(side, own.place, OF_FACE << face);
        let faces = scratch.faces[side].get_mut(own.place as usize);
        let Some(of_face) = faces.map(|faces| &mut faces[face]) else {
            return;
        };
        if known & OF_FACE << face == 0 {
            *of_face = FaceSums::default();
        }
        of_face.area += sums.area;
        let on_b = if side == 0 { *normal } else { -normal };
        let weight = normal.dot(&host.tet.gradient).max(0.0);
        let Some(centre) = all.add_polygon(sides, triangle, &on_b, weight, sums) else {
            return;
        };
        let stiffness = weight * sums.area;
        let first = sums.first * weight;
        of_face.pressure += sums.pressure;
        of_face.moment += sums.moment;
        of_face.stiffness += stiffness;
        of_face.first += first;
        for place in sides.iter().filter(|place| place.nodes.is_none()) {
            all.stiffen(0, place, &centre, &on_b, stiffness);
        }
        let known = scratch.note(1 - side, host.place, OF_HOST);
        if let Some(of_host) = scratch.hosts[1 - side].get_mut(host.place as usize) {
            if known & OF_HOST == 0 {
                *of_host = HostSums::default();
            }
            of_host.force += normal * sums.pressure;
            of_host.moment += sums.moment * normal.transpose();
            of_host.flux.energy += flux.energy;
            of_host.flux.volume += flux.volume;
            of_host.stiffness += stiffness;
            of_host.first += first;
        }
    }
}

impl PairSums {
    /// Adds the action of the skins of two tetrahedra on each other.
    #[inline(always)]
    pub fn add_skins(
        &mut self,
        lanes: impl Lanes,
        sides: &[Place; 2],
        triangles: &Triangles,
        scratch: &mut SkinScratch,
    ) -> Met {
        let mut adds = Adds {
            sums: self,
            sides,
            triangles,
            scratch,
        };
        let met = meet(lanes, [sides[0].tet, sides[1].tet], &mut adds);
        self.pieces += usize::from(met == Met::Skins);
        met
    }

    /// Distributes the sums of the tetrahedra to their nodes. `tet` returns the tetrahedron of a side and
    /// index.
    pub fn close_skins<'a>(
        &mut self,
        scratch: &SkinScratch,
        tet: impl Fn(usize, u32) -> Option<Place<'a>>,
    ) {
        let mut volumes = [0.0; 2];
        let mut fields = [false; 2];
        for (side, met) in scratch.met.iter().enumerate() {
            for (at, &met) in met.iter().enumerate().filter(|(_, met)| **met != 0) {
                let Some(place) = tet(side, at as u32) else {
                    continue;
                };
                let mut sums = HostSums::default();
                if met & OF_HOST != 0 {
                    sums = scratch.hosts[side][at];
                }
                for (face, of_face) in scratch.faces[side][at].iter().enumerate() {
                    if met & OF_FACE << face == 0 {
                        continue;
                    }
                    let normal = place.tet.normal(face);
                    let on_b = if side == 0 { normal } else { -normal };
                    self.area += on_b * of_face.area;
                    sums.force -= normal * of_face.pressure;
                    sums.moment -= of_face.moment * normal.transpose();
                    sums.stiffness += of_face.stiffness;
                    sums.first += of_face.first;
                }
                // Corners in the other body contribute a quarter of the volume each.
                let sunken = (0..4).filter(|k| met >> k & 1 == 1);
                let pressure: f64 = sunken.map(|k| place.tet.values[k]).sum();
                sums.flux.energy += pressure * place.tet.six_volumes / 24.0;
                let pole = place.tet.pole();
                if place.tet.values[pole] > 0.0 {
                    fields[side] = true;
                    volumes[side] += sums.flux.volume;
                    if met >> pole & 1 == 1 {
                        volumes[side] += place.tet.six_volumes / 6.0;
                    }
                }
                self.add_tet(side, &place, &sums);
            }
        }
        // Both bodies give the same volume, but a wall, which has no field.
        let volume = match fields {
            [true, true] => 0.5 * (volumes[0] + volumes[1]),
            _ => volumes[0] + volumes[1],
        };
        self.volume = volume.max(0.0);
    }

    fn add_tet(&mut self, side: usize, place: &Place, sums: &HostSums) {
        let tet = place.tet;
        let flux = sums.flux.energy;
        self.energy += flux;
        let m = &sums.moment;
        self.wrench[side][0] += sums.force;
        self.wrench[side][1] += Vector3::new(m.m23 - m.m32, m.m31 - m.m13, m.m12 - m.m21);
        for (k, &node) in place.nodes.into_iter().flatten().enumerate() {
            let (level, slope) = (tet.levels[k], &tet.slopes[k]);
            if let Some(total) = self.forces[side].get_mut(node as usize) {
                *total += sums.force * level + m.tr_mul(slope) - slope * flux;
            }
            if let Some(total) = self.stiffness[side].get_mut(node as usize) {
                *total += (sums.stiffness * level + slope.dot(&sums.first)).max(0.0);
            }
        }
    }
}
