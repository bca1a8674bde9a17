//! Loop over the candidates of a pair.

use super::near::{Failure, Near, Sides};
use super::operand::Operand;
use super::sums::{Place, Triangles};
use crate::tets::current::Current;
use crate::tets::pieces::distance;
use crate::tets::posed::PosedList;
#[cfg(target_arch = "x86_64")]
use crate::tets::row::V3;
use crate::tets::row::{Lanes, Plain};
use crate::tets::skins::Met;

/// The candidates of a pair, and storage for their posed tetrahedra.
pub(crate) struct Walk<'a, 's> {
    pub sides: &'a Sides<'s>,
    /// Pressures of the fields of A and B, Pa.
    pub pressures: [f64; 2],
    pub near: &'a mut Near,
    pub motion: f64,
    pub tets: &'a mut [PosedList<Current>; 2],
    /// Number of candidates tested.
    pub candidates: &'a mut usize,
}

/// The operation on two tetrahedra. (Not a closure, whose inlining cannot be forced.)
pub(crate) trait Meet {
    fn meet(&mut self, lanes: impl Lanes, places: &[Place; 2], triangles: &Triangles) -> Met;
}

impl Walk<'_, '_> {
    /// Calls `task` for every candidate that may touch. Returns up to which motion none touches, or `None` if
    /// one was unclear.
    #[inline(always)]
    pub fn all(self, lanes: impl Lanes, task: &mut impl Meet) -> Result<Option<f64>, Failure> {
        let Near {
            origin,
            sides: members,
            pairs,
        } = self.near;
        *self.candidates = 0;
        let [list_a, list_b] = self.tets;
        list_a.reset(members[0].tets.len());
        list_b.reset(members[1].tets.len());
        let mut clear = f64::INFINITY;
        let mut failure = None;
        for candidate in pairs {
            if self.motion >= candidate.clear {
                let [i, j] = candidate.places;
                let mut pose = |side: usize, at: u32, room: &mut Current| {
                    let tet = *members[side].tets.get(at as usize)?;
                    let pressure = self.pressures[side];
                    let posed = self.sides.operands[side].pose(tet, pressure, origin, room);
                    posed.unwrap_or_else(|inverted| {
                        failure.get_or_insert((side, inverted));
                        None
                    })
                };
                let (Some(a), Some(b)) = (
                    list_a.get(i, |room| pose(0, i, room)),
                    list_b.get(j, |room| pose(1, j, room)),
                ) else {
                    continue;
                };
                *self.candidates += 1;
                let places = [(a, i, 0), (b, j, 1)].map(|(tet, place, side)| Place {
                    tet,
                    place,
                    nodes: members[side].corners.get(place as usize),
                });
                let triangles = self.sides.operands[1].triangles(members[1].tets[j as usize]);
                match task.meet(lanes, &places, &triangles) {
                    Met::Unclear => return Ok(None),
                    Met::Apart => {
                        candidate.clear = self.motion + distance(&a.planes(), &b.planes());
                    }
                    Met::Inside | Met::Skins => {}
                }
            }
            clear = clear.min(candidate.clear);
        }
        match failure {
            Some(failure) => Err(failure),
            None => Ok(Some(clear)),
        }
    }

    /// As [`all`](Self::all), by AVX2 where the machine has it. Products and sums are never fused, so that
    /// both give the same bits.
    pub fn all_at_once(self, task: &mut impl Meet) -> Result<Option<f64>, Failure> {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = V3::try_new() {
            return lanes.vectorize(All {
                walk: self,
                lanes,
                task,
            });
        }
        self.all(Plain, task)
    }
}

#[cfg(target_arch = "x86_64")]
struct All<'a, 's, M> {
    walk: Walk<'a, 's>,
    lanes: V3,
    task: &'a mut M,
}

#[cfg(target_arch = "x86_64")]
impl<M: Meet> pulp::NullaryFnOnce for All<'_, '_, M> {
    type Output = Result<Option<f64>, Failure>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.walk.all(self.lanes, self.task)
    }
}

impl Operand<'_> {
    /// Triangles of the skin at a tetrahedron of a deformable body.
    fn triangles(&self, tet: u32) -> Triangles {
        let none = Triangles {
            faces: [0; 4],
            nearest: 0,
        };
        match self {
            Self::Deformable(shape, _) => {
                shape.tets().get(tet as usize).map_or(none, |t| Triangles {
                    faces: t.triangles,
                    nearest: t.nearest,
                })
            }
            _ => none,
        }
    }
}
