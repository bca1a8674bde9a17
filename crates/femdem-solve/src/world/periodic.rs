//! A world in periodic space: the cell, its deformation and its stress.

use super::World;
use super::active::is_any;
use crate::error::{SolveError, check};
use crate::halo::{Alone, Halo};
use crate::ledger::Flows;
use crate::parameters::Medium;
use femdem_contact::PeriodicCell;
use femdem_mesh::{Matrix3, Vector3};

/// The affine motion of deforming space: its streaming velocity at x is `gradient` (x - `centre`).
#[derive(Debug, Clone, Copy)]
pub(super) struct Streaming {
    gradient: Matrix3,
    centre: Vector3,
}

impl Streaming {
    /// Streaming velocity at a place, m/s.
    pub fn at(&self, x: &Vector3) -> Vector3 {
        self.gradient * (x - self.centre)
    }
}

/// Refuses a cell that moves.
pub(super) fn check_rests(cell: &PeriodicCell) -> Result<(), SolveError> {
    check(
        "velocity of the edges of the periodic cell",
        cell.rates().norm(),
        !cell.moves(),
        "0 for implicit steps and for a relaxation: deform_cell with explicit steps",
    )
}

/// The pieces of a body that may break may drift apart by more than a cell.
pub(super) fn apart() -> SolveError {
    SolveError::CannotBreak {
        needs: "space that does not repeat itself",
        found: "a periodic cell".to_owned(),
    }
}

impl World {
    /// Makes space periodic, or changes the cell by hand. Bodies keep their places and velocities, whatever the cell does:
    /// to deform what lies in it use [`deform_cell`](Self::deform_cell). The energy that contacts gain is in
    /// [`Ledger::by_hand`](crate::Ledger::by_hand).
    ///
    /// # Errors
    /// [`SolveError::Contact`] if there are bodies and space does not repeat itself along the same axes already, or if the cell
    /// measures less than 2.25 diameters of the largest body along one of its axes, or walls do not repeat themselves. Later steps
    /// refuse that, too. [`SolveError::CannotBreak`] if a body may break, [`SolveError::Ranks`] in a world that is
    /// [shared out](Self::share_out).
    pub fn set_cell(&mut self, cell: PeriodicCell) -> Result<(), SolveError> {
        self.restored()?;
        self.not_shared("a periodic cell")?;
        if self.body_count() == 0 {
            return Ok(self.batch.set_cell(cell)?);
        }
        if self.deformables().any(|body| body.cracks().is_some()) {
            return Err(apart());
        }
        self.refuse_adaptive(None, "space that does not repeat itself", "a periodic cell")?;
        self.evaluate_if_due()?;
        self.wake_all();
        let before = self.stored_energy();
        self.batch.set_cell(cell)?;
        self.evaluate(0.0)?;
        self.flows.by_hand += self.stored_energy() - before;
        Ok(())
    }

    /// The periodic cell, if there is one.
    pub fn cell(&self) -> Option<&PeriodicCell> {
        self.batch.cell()
    }

    /// Lets the edges of the periodic cell move with these velocities (the columns of a matrix, m/s) from now on, and all free bodies
    /// with the space in which they are: their velocities change by the change of the velocity gradient times the way from their
    /// centre of mass. A deformable body moves as a whole, by the change at its own centre; one with held nodes does not. After that they follow Newton's law alone, as in the method of Lees and Edwards (1972). What this gives
    /// to the bodies, and the work over the edges, is in [`Ledger::work_in`](crate::Ledger::work_in).
    ///
    /// Nothing sleeps while the cell moves. The resistance of a medium is that against the motion in the moving space.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] without a periodic cell, [`SolveError::Parameter`] where steps are implicit, [`SolveError::Mesh`] for velocities that are not
    /// finite or not of an upper triangular matrix.
    pub fn deform_cell(&mut self, rates: Matrix3) -> Result<(), SolveError> {
        self.not_shared("deforming the cell by one rank")?;
        self.deform_cell_on(rates, &mut Alone)
    }

    /// As [`deform_cell`](Self::deform_cell), of a world that is [shared out](Self::share_out), by all ranks.
    ///
    /// # Errors
    /// As [`deform_cell`](Self::deform_cell), and what `halo` reports.
    pub fn deform_cell_on(
        &mut self,
        rates: Matrix3,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.fits(halo)?;
        let Some(cell) = self.cell().copied() else {
            return Err(SolveError::NoSuch {
                what: "periodic cell",
                index: 0,
                count: 0,
            });
        };
        if rates == *cell.rates() {
            return Ok(());
        }
        let moving = cell.with_rates(rates)?;
        if self.parameters.time_step.implicit.is_some() {
            check_rests(&moving)?;
        }
        // Contacts of two sleepers are not among those of the last evaluation.
        let own = self.live_bodies().count();
        self.loaded &= !is_any(self.awake.len() < own, halo)?;
        self.wake_all();
        self.batch.set_cell(moving)?;
        let moments = self.sums_of_all(self.moments_of_free(), halo)?;
        let change = Streaming {
            gradient: moving.velocity_gradient() - cell.velocity_gradient(),
            centre: centre(moments),
        };
        for &i in &self.awake {
            let body = &mut self.bodies[i as usize];
            if body.driven.is_none() {
                let before = body.kinetic_energy();
                body.velocity += change.at(&body.position);
                self.flows.work_in += body.kinetic_energy() - before;
            }
        }
        if let Some(deformables) = &mut self.deformables {
            let batch = &self.batch;
            let follows = |body| !batch.is_guest(body);
            self.flows.work_in += deformables.follow_space(follows, |centre| change.at(centre));
        }
        Ok(())
    }

    /// Mean stress in the periodic cell from the contacts on record, without dashpots, positive in compression, Pa: Σ f lᵀ/V with the force f of
    /// a contact on its side B and the vector l from the centroid of A to that of B (Love 1927, Weber 1966). `None` unless
    /// space repeats itself along all axes.
    pub fn cell_stress(&self) -> Option<Matrix3> {
        let volume = self.cell()?.volume()?;
        Some(self.batch.virial() / volume)
    }

    /// The motion of space now, if it is deformed and a medium resists the motion against it.
    pub(super) fn resisting_stream(
        &self,
        halo: &mut dyn Halo,
    ) -> Result<Option<Streaming>, SolveError> {
        let resists = self.parameters.medium != Medium::default();
        let Some(cell) = self.cell().filter(|cell| resists && cell.moves()) else {
            return Ok(None);
        };
        Ok(Some(Streaming {
            gradient: cell.velocity_gradient(),
            centre: centre(self.sums_of_all(self.moments_of_free(), halo)?),
        }))
    }

    /// Moves the edges of the cell by a step, s.
    pub(super) fn drift_cell(&mut self, dt: f64) -> Result<(), SolveError> {
        if let Some(cell) = self.cell().filter(|cell| cell.moves()) {
            let way = cell.rates() * dt;
            let next = cell.with_edges(cell.edges() + way)?;
            self.check_edges([0, 1, 2].map(|k| way.column(k).norm()))?;
            self.batch.set_cell(next)?;
        }
        Ok(())
    }

    /// Books the work of the moving edges in half a step, s.
    pub(super) fn book_edges(&self, h: f64, flows: &mut Flows) {
        let Some(cell) = self.cell().filter(|cell| cell.moves()) else {
            return;
        };
        for (rate, load) in cell.rates().column_iter().zip(self.batch.edge_loads()) {
            flows.work_in -= rate.dot(&load.total) * h;
            flows.damping_work += rate.dot(&load.damping) * h;
            flows.friction_work += rate.dot(&load.friction) * h;
        }
    }
}

/// The centre of mass of a mass and its first moments, m; the origin without mass.
fn centre([mass, x, y, z]: [f64; 4]) -> Vector3 {
    if mass > 0.0 {
        Vector3::new(x, y, z) / mass
    } else {
        Vector3::zeros()
    }
}
