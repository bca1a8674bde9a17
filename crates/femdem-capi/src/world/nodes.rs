//! The state of the deformable bodies of a world.

use std::mem::MaybeUninit;

use femdem_solve::contact::BodyId;

use crate::border::{Failure, FemdemStatus, answer, border, place, room};
use crate::handles::FemdemWorld;

/// A deformable body as numbers. Those that break get more nodes, and may get fewer tetrahedra by femdem_world_fragment_bodies.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemDeformable {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centroid: [f64; 3],
    /// Velocity of that, m/s.
    pub velocity: [f64; 3],
    /// J.
    pub kinetic_energy: f64,
    /// Elastic energy, J, without that of its cracks.
    pub strain_energy: f64,
    /// Nodes.
    pub node_count: usize,
    /// Tetrahedra.
    pub tet_count: usize,
    /// Triangles of its skin.
    pub triangle_count: usize,
    /// Number of its model.
    pub model: u32,
    /// 1 if it may break, else 0.
    pub breakable: i32,
    /// 1 if it is frozen, else 0.
    pub asleep: i32,
}

/// Writes the number of deformable bodies, and their numbers, ascending, if `room` is not 0: then it must suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_deformables(
    world: FemdemWorld,
    bodies: *mut u32,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let ids = world.with(|own| Ok(own.world.deformable_ids().collect::<Vec<BodyId>>()))?;
        // SAFETY: as the caller promises.
        unsafe { answer("bodies", ids.into_iter(), (bodies, room), count) }
    })
}

/// Writes a deformable body as numbers.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_deformable(
    world: FemdemWorld,
    body: u32,
    deformable: Option<&mut MaybeUninit<FemdemDeformable>>,
) -> FemdemStatus {
    border(|| {
        let to = place("deformable", deformable)?;
        world.with(|own| {
            let soft = own.deformable(body)?;
            let (mass, mesh) = (soft.mass(), soft.model().mesh());
            to.write(FemdemDeformable {
                mass,
                centroid: soft.centroid().into(),
                velocity: (soft.momentum() / mass).into(),
                kinetic_energy: soft.kinetic_energy(),
                strain_energy: soft.internal().energy,
                node_count: soft.positions().len(),
                tet_count: mesh.tets().len(),
                triangle_count: mesh.skin().len(),
                model: soft.model_id(),
                breakable: i32::from(soft.cracks().is_some()),
                asleep: i32::from(soft.is_asleep()),
            });
            Ok(())
        })
    })
}

/// Rows of a deformable body, of which the caller must have as many as there are.
///
/// # Safety
/// As [`room`].
unsafe fn rows<const N: usize, T>(
    name: &str,
    start: *mut T,
    count: usize,
    rows: impl ExactSizeIterator<Item = [T; N]>,
) -> Result<(), Failure> {
    if count != rows.len() {
        let what = "rows, as femdem_world_deformable counts them";
        return Err(Failure::size(name, count, rows.len(), what));
    }
    // SAFETY: rows of numbers have the layout of the numbers; the rest the caller promises.
    let to = unsafe { room(name, start.cast::<[T; N]>(), count)? };
    for (to, row) in to.iter_mut().zip(rows) {
        to.write(row);
    }
    Ok(())
}

/// Writes the positions of the nodes of a deformable body, m, three numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_node_positions(
    world: FemdemWorld,
    body: u32,
    positions: *mut f64,
    count: usize,
) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let each = own.deformable(body)?.positions().iter();
            let each = each.map(|x| <[f64; 3]>::from(*x));
            // SAFETY: as the caller promises.
            unsafe { rows("positions", positions, count, each) }
        })
    })
}

/// Writes the velocities of the nodes of a deformable body, m/s, three numbers each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_node_velocities(
    world: FemdemWorld,
    body: u32,
    velocities: *mut f64,
    count: usize,
) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let each = own.deformable(body)?.velocities().iter();
            let each = each.map(|x| <[f64; 3]>::from(*x));
            // SAFETY: as the caller promises.
            unsafe { rows("velocities", velocities, count, each) }
        })
    })
}

/// Writes the tetrahedra of a deformable body, four numbers of nodes each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_tets(
    world: FemdemWorld,
    body: u32,
    tets: *mut u32,
    count: usize,
) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let mesh = own.deformable(body)?.model().mesh();
            // SAFETY: as the caller promises.
            unsafe { rows("tets", tets, count, mesh.tets().iter().copied()) }
        })
    })
}

/// Writes the triangles of the skin of a deformable body, three numbers of nodes each, counter-clockwise from outside.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_skin(
    world: FemdemWorld,
    body: u32,
    triangles: *mut u32,
    count: usize,
) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let skin = own.deformable(body)?.model().mesh().skin().iter().copied();
            // SAFETY: as the caller promises.
            unsafe { rows("triangles", triangles, count, skin) }
        })
    })
}

/// Writes the Cauchy stresses in the tetrahedra of a deformable body, Pa, tension positive: xx, yy, zz, xy, yz, zx each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_stresses(
    world: FemdemWorld,
    body: u32,
    stresses: *mut f64,
    count: usize,
) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let found = own.deformable(body)?.stresses();
            let found = found.map_err(|error| Failure::new(FemdemStatus::Failed, error))?;
            let each = found.iter().map(|element| {
                let s = &element.cauchy;
                let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
                pairs.map(|pair| s[pair])
            });
            // SAFETY: as the caller promises.
            unsafe { rows("stresses", stresses, count, each) }
        })
    })
}
