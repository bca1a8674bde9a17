//! What ranks show of a run to the first one, which writes it.

use std::path::Path;

use femdem_mesh::Vector3;
use femdem_solve::{Halo, SolveError, World};

use super::files::MemberRows;
use super::part::Part;
use super::shown::{OfRanks, Own, Shown};
use crate::Error;
use crate::gather::or_error_of_another;
use crate::run::until::Lines;
use crate::run::{Run, Simulation};

impl Part {
    /// Shows the bodies to the run, on the first rank, which writes into `folder` what is due, or relaxes all of them for a part
    /// of the steps of a relaxation. Returns whether the run has ended. The first rank has all bodies for it only when the motion
    /// may end, which is at each look once they have been still for long enough, for frames with bonds, bodies that may break, tables
    /// or pictures, and for rows of supports of bodies that may break.
    ///
    /// # Errors
    ///
    /// As [`Run::advance`] but for those of the step, and those of [`World::gather`].
    pub fn go_on(
        &mut self,
        mut run: Option<&mut Run>,
        folder: &Path,
        halo: &mut dyn Halo,
    ) -> Result<bool, Error> {
        if self.is_relaxing() {
            if let Some(run) = run.as_deref_mut() {
                run.advance(folder, 1)?;
            }
        } else {
            let mut due = [0; 2];
            if let Some(run) = run.as_deref_mut() {
                self.lend(run, |run| {
                    due = [run.is_row_due(), run.is_frame_due()].map(u64::from);
                });
            }
            halo.sum(&mut due)?;
            let [row, frame] = due.map(|due| due > 0);
            let may_end = self.may_rest || self.world.time() >= self.scenario.duration;
            if may_end || self.needs_whole(row, frame) {
                self.show_whole(run.as_deref_mut(), halo, |run, world, may_rest| {
                    run.go_on_with(world, may_rest, folder)
                })?;
            } else if self.show_parts(run.as_deref_mut(), [row, frame], folder, halo)? {
                // A limit has ended the motion.
                self.show_whole(run.as_deref_mut(), halo, |run, world, _| {
                    run.simulation.world = world;
                    run.write_frame_due(folder)
                })?;
            }
        }
        let mut now = [0; 3];
        if let Some(run) = run {
            let relaxed = run.steps_relaxed();
            now = [
                u64::from(run.ending.is_some()),
                u64::from(relaxed.is_some()),
                relaxed.unwrap_or(0),
            ];
        }
        halo.sum(&mut now)?;
        let [ended, relaxes, relaxed] = now;
        self.relaxed = (relaxes > 0).then_some(relaxed);
        Ok(ended > 0)
    }

    /// Whether the first rank must have all bodies for a row and a frame if they are due, by what the scene asks for.
    fn needs_whole(&self, row: bool, frame: bool) -> bool {
        let holds_pieces = self.fixtures.hold() && self.world.may_break();
        (frame && !self.has_plain_frames) || (row && holds_pieces)
    }

    /// Gives all bodies to the run, which keeps them if its motion has ended then.
    fn show_whole(
        &self,
        run: Option<&mut Run>,
        halo: &mut dyn Halo,
        show: impl FnOnce(&mut Run, World, bool) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let whole = self.world.gather(halo)?;
        let Some((run, whole)) = run.zip(whole) else {
            return Ok(());
        };
        self.tell(run);
        show(run, whole, self.may_rest)?;
        let goes_on = run.ending.is_none() && run.relaxing.is_none();
        if goes_on {
            let world = &mut run.simulation.world;
            *world = World::new(*world.parameters())?;
        }
        Ok(())
    }

    /// Shows what each rank has measured of its bodies to the run, which writes the row if it is due and, unless that has ended
    /// the motion, the frame. Returns whether it has.
    fn show_parts(
        &mut self,
        mut run: Option<&mut Run>,
        [row, frame]: [bool; 2],
        folder: &Path,
        halo: &mut dyn Halo,
    ) -> Result<bool, Error> {
        let mut before = [f64::INFINITY; 2];
        if let Some(run) = run.as_deref_mut() {
            self.tell(run);
            before = [run.deepest().depth, f64::from(u8::from(run.has_warned()))];
        }
        halo.least(&mut before)?;
        let [most, warned] = before;
        let (seen, depths) = self.with_own(|own| {
            let seen = own.measure(halo)?;
            Ok((seen, own.depths(most, warned > 0.0, halo)?))
        })?;
        let checked = run
            .as_deref_mut()
            .map(|run| self.lend(run, |run| run.check(&depths, &seen.ledger, seen.rounding)));
        or_error_of_another(checked.unwrap_or(Ok(())), halo)?;
        let mut looked = Vec::new();
        if row && self.scenario.sees_members() {
            let run = run.as_deref_mut();
            looked = self.with_own(|own| member_rows(own, run, folder, halo))?;
        }
        let mut ended = [0];
        if let Some(run) = run.as_deref_mut() {
            let over = self.lend(run, |run| {
                if row {
                    run.write_row(&seen, looked);
                }
                run.ending.is_some() || run.relaxing.is_some()
            });
            ended = [u64::from(over)];
        }
        halo.sum(&mut ended)?;
        if frame && ended == [0] {
            let (own, extent) = self.with_own(|own| {
                let extent = extent_of_all(own, halo)?;
                Ok((Own::of(own), extent))
            })?;
            let own = or_error_of_another(own, halo)?;
            let deformable = self.deformable;
            let written = match run {
                Some(run) => self.lend(run, |run| {
                    let (simulation, forces) = (&run.simulation, &seen.walls);
                    let frame = OfRanks::new(own, simulation, deformable, extent, forces, halo);
                    let written = run.write_files_of_frame(folder, &frame);
                    frame.end()?;
                    let kinds = frame.kinds();
                    written?;
                    run.record_frame(folder, kinds)?;
                    run.flush(folder)
                }),
                None => Ok(own.answer(halo)?),
            };
            or_error_of_another(written, halo)?;
        }
        Ok(ended[0] > 0)
    }

    /// Does something with the bodies of this rank as those of a run.
    fn with_own<T>(
        &mut self,
        what: impl FnOnce(&Simulation) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let none = World::new(*self.world.parameters())?;
        let world = std::mem::replace(&mut self.world, none);
        let own = self.fixtures.simulation(world, &self.controls);
        let done = what(&own);
        self.world = own.world;
        done
    }
}

/// Writes the rows of the members of all ranks, if there is such a table, and returns those at which limits look.
fn member_rows(
    own: &Simulation,
    run: Option<&mut Run>,
    folder: &Path,
    halo: &mut dyn Halo,
) -> Result<Lines, Error> {
    let mut numbers = Vec::new();
    let mut rows = None;
    if let Some(run) = run {
        let members = &run.simulation.members;
        numbers.extend(members.iter().map(|member| member.id));
        let (time, table) = (own.world.time(), &mut run.members);
        rows = Some(MemberRows::new(&run.scenario, members, time, table, folder));
    }
    own.member_states_on(&numbers, halo, |member, state| {
        let rows = rows.as_mut();
        rows.map_or(Ok(()), |rows| rows.add(member, &state))
    })?;
    Ok(rows.map_or_else(Vec::new, |rows| rows.looked))
}

/// The box around the bodies of all ranks, as [`Simulation::extent_of_bodies`].
fn extent_of_all(
    own: &Simulation,
    halo: &mut dyn Halo,
) -> Result<Option<[Vector3; 2]>, SolveError> {
    let none = [
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    ];
    let [low, high] = own.extent_of_bodies().unwrap_or(none);
    let mut least = [low.x, low.y, low.z, -high.x, -high.y, -high.z];
    halo.least(&mut least)?;
    let [x, y, z, a, b, c] = least;
    let extent = [Vector3::new(x, y, z), -Vector3::new(a, b, c)];
    Ok(x.is_finite().then_some(extent))
}
