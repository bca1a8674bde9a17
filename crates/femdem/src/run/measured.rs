//! What the tables say of all bodies of a run: sums that are the same for any number of ranks, but for energies.

use femdem_contact::{BodyId, ExactSum};
use femdem_mesh::Vector3;
use femdem_solve::{Deformable, Halo, Ledger, SolveError, World};

use super::contacts::by_wall;
use super::{CellState, Simulation};

/// What the rows of a time say but for members and flow.
pub(super) struct Measured {
    pub ledger: Ledger,
    /// What rounding alone gives to deformable bodies \[J\].
    pub rounding: f64,
    pub momentum: Vector3,
    pub centre: Vector3,
    pub contacts: u64,
    pub pieces: u64,
    /// Bonds that hold and that are broken.
    pub bonds: [u64; 2],
    pub deformable_share: f64,
    /// Force on each wall, and what presses on it \[N\].
    pub walls: Vec<Vector3>,
    pub pressing: Vec<f64>,
    /// Of each support.
    pub reactions: Vec<Vector3>,
    pub cells: Vec<CellState>,
}

/// What rounding alone gives to deformable bodies, J. Places x are rounded by u |x| in every step, with the u of double precision: a
/// velocity of u |x|/Δt, which the stiffness of the elements, stable at that step, returns. The steps add up at random, to
/// N ½ m (u |x|/Δt)².
pub(super) fn rounding_of_places(world: &World) -> f64 {
    let steps = world.steps() as f64;
    let step = world.time() / steps;
    let of = |body: Deformable<'_>| {
        let farthest = body.positions().iter().map(Vector3::norm);
        let speed = f64::EPSILON * farthest.fold(0.0, f64::max) / step;
        0.5 * body.mass() * speed * speed
    };
    if step > 0.0 {
        steps * world.deformables().map(of).sum::<f64>()
    } else {
        0.0
    }
}

impl Simulation {
    /// Measures all bodies; this has those of one rank, with those near them.
    pub(super) fn measure(&self, halo: &mut dyn Halo) -> Result<Measured, SolveError> {
        let world = &self.world;
        let contacts = self.own_contacts();
        let mut counts = [contacts.len() as u64, self.piece_count() as u64];
        halo.sum(&mut counts)?;
        let mut sums = self.wall_sums(&contacts);
        // Each is of a body of one rank, or of several that it fell apart into.
        let reactions = self.reactions();
        let on_supports = reactions
            .iter()
            .flat_map(<Vector3 as AsRef<[f64; 3]>>::as_ref);
        sums.extend(on_supports.map(|x| ExactSum::from_iter([*x])));
        let mass = |id: BodyId| world.mass(id);
        sums.push(world.deformables().map(|body| body.mass()).collect());
        sums.push(world.own_bodies(0).filter_map(mass).collect());
        sums.push(ExactSum::from_iter([rounding_of_places(world)]));
        let sums = world.sums_on(sums, halo)?;
        let (on_walls, rest) = sums.split_at(4 * self.walls.len());
        let (on_supports, masses) = rest.split_at(3 * reactions.len());
        let (walls, pressing) = by_wall(on_walls);
        let (on_supports, _) = on_supports.as_chunks::<3>();
        let [soft, all, rounding] = [0, 1, 2].map(|k| masses[k]);
        Ok(Measured {
            ledger: world.ledger_on(halo)?,
            rounding,
            momentum: world.linear_momentum_on(halo)?,
            centre: world.centre_of_mass_on(halo)?,
            contacts: counts[0],
            pieces: counts[1],
            bonds: world.bond_counts_on(halo)?,
            deformable_share: if soft > 0.0 { soft / all } else { 0.0 },
            walls,
            pressing,
            reactions: on_supports.iter().map(|x| Vector3::from(*x)).collect(),
            cells: self.controls.cells(world, halo)?,
        })
    }
}
