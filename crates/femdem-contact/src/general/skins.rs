//! The sums of a pair of rigid solids as integrals over skins: see [`tets::skins`](crate::tets::skins).

use super::cache::{Near, Placed};
use super::patch::Record;
use super::sums::Sums;
use crate::tets::clip::NOISE;
use crate::tets::current::Current;
use crate::tets::pieces::distance;
use crate::tets::posed::PosedList;
#[cfg(target_arch = "x86_64")]
use crate::tets::row::V3;
use crate::tets::row::{Lanes, Plain};
use crate::tets::skins::{Gather, Met, Polygon, meet};

/// What the integrals over skins need and give.
pub(crate) struct Walk<'a, 'p> {
    pub placed: &'a Placed<'p>,
    pub near: &'a mut Near,
    pub motion: f64,
    pub tets: &'a mut [PosedList<Current>; 2],
    /// One for each pair of tetrahedra, or for all if the overlap is one patch.
    pub records: &'a mut Vec<Record>,
    pub is_one: bool,
    /// Numbers of pairs tested, and of those in which the skin of one lies in the other.
    pub counts: &'a mut [usize; 2],
}

/// Energy and volume due to the nodes of either in the other; `None` if there are none.
type Sunken = Option<[f64; 2]>;

impl Walk<'_, '_> {
    /// Fills the records. Returns up to which motion nothing touches, and the contribution of nodes, which is not in
    /// any record; `None` if round-off would decide.
    pub fn run(self) -> Option<(f64, Sunken)> {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = V3::try_new() {
            return lanes.vectorize(Run { walk: self, lanes });
        }
        self.run_by(Plain)
    }

    #[inline(always)]
    fn run_by(mut self, lanes: impl Lanes) -> Option<(f64, Sunken)> {
        let clear = self.skins(lanes)?;
        Some((clear, self.nodes()))
    }

    #[inline(always)]
    fn skins(&mut self, lanes: impl Lanes) -> Option<f64> {
        let Near {
            centre,
            tets: [in_a, in_b],
            pairs,
            ..
        } = &mut *self.near;
        let [list_a, list_b] = &mut *self.tets;
        let mut clear = f64::INFINITY;
        for candidate in pairs {
            if self.motion >= candidate.clear {
                let [i, j] = candidate.places;
                let (Some(&tet_a), Some(&tet_b)) = (in_a.get(i as usize), in_b.get(j as usize))
                else {
                    continue;
                };
                let (Some(a), Some(b)) = (
                    list_a.get(i, |room| self.placed.pose(0, tet_a, centre, room)),
                    list_b.get(j, |room| self.placed.pose(1, tet_b, centre, room)),
                ) else {
                    continue;
                };
                self.counts[0] += 1;
                let is_new = !self.is_one || self.records.is_empty();
                if is_new {
                    self.records.push(Record {
                        pair: [tet_a, tet_b],
                        has_skin: true,
                        ..Record::default()
                    });
                }
                let Some(record) = self.records.last_mut() else {
                    continue;
                };
                let tets = [a, b];
                let met = meet(lanes, tets, &mut Adds { tets, record });
                if met == Met::Skins {
                    self.counts[1] += 1;
                } else if is_new {
                    self.records.pop();
                }
                match met {
                    Met::Unclear => return None,
                    Met::Apart => {
                        candidate.clear = self.motion + distance(&a.planes(), &b.planes());
                    }
                    Met::Inside | Met::Skins => {}
                }
            }
            clear = if candidate.clear < clear {
                candidate.clear
            } else {
                clear
            };
        }
        Some(clear)
    }

    /// Nodes of one body in the other.
    #[inline(always)]
    fn nodes(&mut self) -> Sunken {
        let mut sunken = None;
        for side in 0..2 {
            let (own, other) = (self.placed.side(side), 1 - side);
            let mut last = None;
            for candidate in &mut self.near.nodes[side] {
                let [node, place] = candidate.places;
                if self.motion < candidate.clear || last == Some(node) {
                    continue;
                }
                let (Some(inner), Some(&tet)) = (
                    own.inner.get(node as usize),
                    self.near.tets[other].get(place as usize),
                ) else {
                    continue;
                };
                let centre = &self.near.centre;
                let pose = |room: &mut Current| self.placed.pose(other, tet, centre, room);
                let Some(host) = self.tets[other].get(place, pose) else {
                    continue;
                };
                let gap = host.gap(&self.placed.point(side, &inner.at, centre), NOISE);
                if gap > 0.0 {
                    candidate.clear = self.motion + gap;
                    continue;
                }
                // A node on a face between two tetrahedra is counted once.
                last = Some(node);
                let [energy, volume] = sunken.get_or_insert([0.0; 2]);
                *energy += inner.field;
                // The volume is that of the parts of B's tetrahedra.
                if side == 1 {
                    *volume += inner.volume;
                }
            }
        }
        sunken
    }
}

#[cfg(target_arch = "x86_64")]
struct Run<'a, 'p> {
    walk: Walk<'a, 'p>,
    lanes: V3,
}

#[cfg(target_arch = "x86_64")]
impl pulp::NullaryFnOnce for Run<'_, '_> {
    type Output = Option<(f64, Sunken)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.walk.run_by(self.lanes)
    }
}

struct Adds<'a> {
    tets: [&'a Current; 2],
    record: &'a mut Record,
}

impl Gather for Adds<'_> {
    #[inline(always)]
    fn note(&mut self, _: usize, _: u8) {}

    #[inline(always)]
    fn add(&mut self, polygon: &Polygon) {
        let side = polygon.side;
        let host = self.tets[1 - side];
        self.record.sums.add_skin(polygon, host);
        // Edges on the host's faces, and on other faces of its own tetrahedron.
        let of_host = polygon.edges & 0b1111;
        self.record.faces.bits |= if side == 0 { of_host << 4 } else { of_host };
        self.record.edges[side] |= u16::from(polygon.edges >> 4) << (4 * polygon.face);
    }
}

impl Sums {
    /// Adds a polygon of one side's skin in the other's tetrahedron `host`. The force on B is ∫ φ_B n dS over A's skin
    /// less ∫ φ_A n dS over B's; the volume is found from B's tetrahedra alone.
    #[inline(always)]
    fn add_skin(&mut self, polygon: &Polygon, host: &Current) {
        let Polygon {
            side,
            normal,
            sums,
            flux,
            ..
        } = polygon;
        self.add_polygon(*side, sums, normal, &host.gradient, 1.0);
        let on_b = if *side == 0 { *normal } else { -normal };
        self.force += on_b * sums.pressure;
        self.torque += sums.moment.cross(&on_b);
        self.energy += flux.energy;
        if *side == 0 {
            self.volume += flux.volume;
        }
        self.enclosed += normal.dot(&sums.first);
    }
}

#[cfg(test)]
mod tests {
    use super::super::cache::GeneralCache;
    use super::super::mesh::{Field, FieldMesh};
    use super::*;
    use femdem_mesh::catalogue::{CatalogueShape, Solid};
    use femdem_mesh::{Rotation, TetMesh, Vector3};

    /// The records of two dodecahedra, and what nodes contribute, by plain instructions or the best that there are.
    fn records(plain: bool) -> (Vec<Record>, Sunken) {
        let solid = CatalogueShape::from(Solid::P4).polyhedron(1.0).unwrap();
        let mesh = TetMesh::centroid_fan(&solid).unwrap().refined().unwrap();
        let body = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body).unwrap();
        let turn = Rotation::from_scaled_axis(Vector3::new(0.3, 0.8, -0.5));
        let placed = Placed {
            a: &body.cells,
            b: &body.cells,
            rotation: turn.to_rotation_matrix().into_inner(),
            offset: Vector3::new(0.4, 0.31, 0.23),
            scale: body.inradius(),
        };
        let mut cache = GeneralCache::default();
        let near = cache.candidates(&placed, 0.0).unwrap();
        let mut tets: [PosedList<Current>; 2] = Default::default();
        for (list, places) in tets.iter_mut().zip(&near.tets) {
            list.reset(places.len());
        }
        let mut records = Vec::new();
        let walk = Walk {
            placed: &placed,
            near,
            motion: 0.0,
            tets: &mut tets,
            records: &mut records,
            is_one: false,
            counts: &mut [0; 2],
        };
        let found = if plain {
            walk.run_by(Plain)
        } else {
            walk.run()
        };
        (records, found.unwrap().1)
    }

    #[test]
    fn every_processor_gives_the_same_bits() {
        let ((plain, nodes), (best, same)) = (records(true), records(false));
        assert!(plain.len() > 4);
        assert_eq!(nodes, same);
        assert_eq!(plain.len(), best.len());
        for (x, y) in plain.iter().zip(&best) {
            assert_eq!((x.pair, x.edges, x.faces), (y.pair, y.edges, y.faces));
            assert_eq!(x.sums, y.sums);
        }
    }
}
