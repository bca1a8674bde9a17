//! The cracks of the bodies of a world that may break, and their fragments.

use std::mem::MaybeUninit;

use femdem_solve::fem::fracture::FractureMode;
use femdem_solve::{CrackFacet, Cracks};

use super::Hosted;
use crate::border::{Failure, FemdemStatus, answer, border, place};
use crate::handles::FemdemWorld;

/// A facet of a breakable body that is cut.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FemdemCrack {
    /// The tetrahedra beside it; -1: one of another body, which has the facet, too.
    pub tets: [i64; 2],
    /// Its three corners midway between its sides, m.
    pub corners: [f64; 9],
    /// Mean opening of its sides, m.
    pub opening: f64,
    /// Mean slip of its sides, m.
    pub slip: f64,
    /// 0 when it is cut, 1 when nothing holds any more.
    pub damage: f64,
    /// When it was cut, s.
    pub birth: f64,
    /// When nothing held any more, s; NaN before.
    pub broken_at: f64,
    /// Energy that it has taken to break, without friction, J.
    pub dissipated: f64,
    /// 1 if it was cut by shear, 0 if by tension.
    pub sheared: i32,
}

/// A fragment that has become a body.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FemdemFragment {
    /// Number of the body.
    pub body: u32,
    /// Number of the body that it was a part of, which is the largest of its fragments now.
    pub of: u32,
}

impl From<CrackFacet> for FemdemCrack {
    fn from(facet: CrackFacet) -> Self {
        let [a, b, c] = facet.corners;
        Self {
            tets: facet.tets.map(|tet| tet.map_or(-1, i64::from)),
            corners: [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z],
            opening: facet.opening,
            slip: facet.slip,
            damage: facet.damage,
            birth: facet.birth,
            broken_at: facet.end.unwrap_or(f64::NAN),
            dissipated: facet.taken,
            sheared: i32::from(facet.mode == FractureMode::Shear),
        }
    }
}

impl Hosted {
    fn cracks(&self, body: u32) -> Result<Cracks<'_>, Failure> {
        self.deformable(body)?.cracks().ok_or_else(|| {
            let allowed = "a body that may break: give it a fracture when it is added";
            Failure::refused("body", body, allowed)
        })
    }
}

/// Writes the number of the facets of a breakable body that are cut, and the facets if `room` is not 0: then it must suffice for
/// all. Those that carry nothing any more come first.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_cracks(
    world: FemdemWorld,
    body: u32,
    cracks: *mut FemdemCrack,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = world.with(|own| {
            let cracks = own.cracks(body)?;
            let spent = cracks.spent().iter().copied();
            let all = spent.chain(cracks.facets()).map(FemdemCrack::from);
            Ok(all.collect::<Vec<_>>())
        })?;
        // SAFETY: as the caller promises.
        unsafe { answer("cracks", all.into_iter(), (cracks, room), count) }
    })
}

/// Writes the number of tetrahedra of a breakable body, and the fragment that each belongs to, from 0, if `room` is not 0: then it
/// must suffice for all. Facets that are not broken join them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_fragments(
    world: FemdemWorld,
    body: u32,
    fragments: *mut u32,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = world.with(|own| {
            let mut found = own.cracks(body)?.fragments();
            if found.is_empty() {
                found = vec![0; own.deformable(body)?.model().mesh().tets().len()];
            }
            Ok(found)
        })?;
        // SAFETY: as the caller promises.
        unsafe { answer("fragments", all.into_iter(), (fragments, room), count) }
    })
}

/// Makes bodies of the fragments of all bodies that have fallen into some, and writes how many there are besides the largest of
/// each, which keep the numbers of the bodies. femdem_world_new_fragments tells which. A caller may ask after every step.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_fragment_bodies(
    world: FemdemWorld,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let to = place("count", count)?;
        world.with(|own| {
            let world = &mut own.world;
            let fallen = own.threads.run(|| world.fragment_bodies())?;
            let each = fallen.iter().flat_map(|fallen| {
                let of = fallen.body;
                let bodies = fallen.fragments.iter();
                bodies.map(move |&body| FemdemFragment { body, of })
            });
            own.fragments = each.collect();
            to.write(own.fragments.len());
            Ok(())
        })
    })
}

/// Writes the number of bodies that the last femdem_world_fragment_bodies has made, and which, if `room` is not 0: then it must
/// suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_new_fragments(
    world: FemdemWorld,
    fragments: *mut FemdemFragment,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = world.with(|own| Ok(own.fragments.clone()))?;
        // SAFETY: as the caller promises.
        unsafe { answer("fragments", all.into_iter(), (fragments, room), count) }
    })
}
