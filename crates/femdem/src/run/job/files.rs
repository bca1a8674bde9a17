//! Files of a run, written when they are due.

use std::fs;
use std::path::{Path, PathBuf};

use femdem_solve::Alone;
use femdem_view::ViewError;
use femdem_view::output::{cracks, write_file, write_pvd_parts};
use femdem_view::picture::PictureOptions;

use super::shown::Shown;
use super::tables::FRAMES;
use crate::run::history::{MemberState, Table};
use crate::run::measured::Measured;
use crate::run::until::{Lines, Rows};
use crate::run::{
    Ending, Member, Run, RunSummary, Scenario, UntilEntry, WALL_HISTORY_COLUMNS, cells, history,
};
use crate::{Error, Usage};

impl Run {
    /// Writes the rows that are still in memory, so that a checkpoint made next fits the files.
    ///
    /// # Errors
    ///
    /// [`Error::View`].
    pub fn flush(&mut self, folder: &Path) -> Result<(), Error> {
        self.history.flush(&folder.join("history.csv"))?;
        if self.scenario.track {
            self.members.flush(&folder.join("members.csv"))?;
        }
        if self.scenario.moves_walls() {
            self.walls.flush(&folder.join("wall_history.csv"))?;
        }
        if self.simulation.controls.has_cells() {
            self.cells.flush(&folder.join("cells.csv"))?;
        }
        if self.simulation.flow.is_counted() {
            self.flow.flush(&folder.join("flow.csv"))?;
        }
        Ok(())
    }

    /// Writes the files of the end: for a run that was stopped before, a frame of the present state; the
    /// picture; cracks, fragments and broken facets where bodies may break; bonds; and last of all `summary.json`.
    ///
    /// # Errors
    ///
    /// [`Error::View`].
    pub fn finish(&mut self, folder: &Path, usage: &Usage) -> Result<RunSummary, Error> {
        if self.frames.last() != Some(&self.simulation.world.time()) {
            self.write_frame(folder)?;
        }
        self.flush(folder)?;
        self.write_picture(&folder.join("run.png"))?;
        self.write_fracture(folder)?;
        if self.simulation.has_adaptive() {
            let path = folder.join("fidelity.csv");
            write_file(path, |w| self.simulation.write_fidelity(w))?;
        }
        if self.simulation.has_bonds() {
            write_file(folder.join("bonds.csv"), |w| self.simulation.write_bonds(w))?;
        }
        let summary = RunSummary::of(self, usage)?;
        write_file(folder.join("summary.json"), |w| summary.write_json(w))?;
        Ok(summary)
    }

    /// Writes the row and the frame if they are due; at the end both are. A row may end the run.
    pub(super) fn write_due(&mut self, folder: &Path) -> Result<(), Error> {
        if self.is_row_due() {
            let simulation = &self.simulation;
            let seen = simulation.measure(&mut Alone)?;
            let mut looked = Vec::new();
            if self.scenario.sees_members() {
                let (members, time) = (&simulation.members, simulation.world.time());
                let table = &mut self.members;
                let mut rows = MemberRows::new(&self.scenario, members, time, table, folder);
                simulation.member_states(|member, state| rows.add(member, &state))?;
                looked = rows.looked;
            }
            self.write_row(&seen, looked);
        }
        self.write_frame_due(folder)
    }

    /// Writes the frame if it is due.
    pub(super) fn write_frame_due(&mut self, folder: &Path) -> Result<(), Error> {
        if self.is_frame_due() {
            self.write_frame(folder)?;
            self.flush(folder)?;
        }
        Ok(())
    }

    /// The last step may be many intervals long, if the run is shorter than a step.
    fn due_until(&self) -> f64 {
        self.simulation.world.time().min(self.scenario.duration)
    }

    pub(super) fn is_row_due(&self) -> bool {
        let row = due(
            self.due_until(),
            self.scenario.history_interval(),
            self.next_row,
        );
        row.is_some() || self.ending.is_some()
    }

    pub(super) fn is_frame_due(&self) -> bool {
        let frame = due(
            self.due_until(),
            self.scenario.frame_interval(),
            self.next_frame,
        );
        frame.is_some() || self.ending.is_some()
    }

    /// Writes the row but for the members; `looked` are their rows at which limits look.
    pub(super) fn write_row(&mut self, seen: &Measured, looked: Lines) {
        let row = due(
            self.due_until(),
            self.scenario.history_interval(),
            self.next_row,
        );
        self.next_row = row.unwrap_or(self.next_row);
        let time = self.simulation.world.time();
        for (peak, force) in self.peaks.iter_mut().zip(&seen.walls) {
            peak.see(force, time);
        }
        for (peak, force) in self.reaction_peaks.iter_mut().zip(&seen.reactions) {
            peak.see(force, time);
        }
        let simulation = &mut self.simulation;
        let flow = simulation.flow.rows(time);
        let writes_walls = self.scenario.moves_walls();
        let walls = match writes_walls || self.scenario.looks_at(&WALL_HISTORY_COLUMNS) {
            true => cells::wall_rows(simulation, seen),
            false => Vec::new(),
        };
        let rows = Rows {
            history: history::history_row(&simulation.world, seen),
            walls,
            cells: cells::cell_rows(time, &seen.cells),
            flow,
            members: looked,
        };
        self.see(&rows);
        self.history.row(rows.history);
        let lists = [
            (&mut self.walls, rows.walls, writes_walls),
            (&mut self.cells, rows.cells, true),
            (&mut self.flow, rows.flow, true),
        ];
        for (table, rows, writes) in lists {
            for row in rows.into_iter().filter(|_| writes) {
                table.row(row);
            }
        }
    }

    /// Ends the motion where a limit of the scene is passed. In the row of time 0 there are no forces yet.
    fn see(&mut self, rows: &Rows) {
        let time = self.simulation.world.time();
        let over = self.ending.is_some() || self.relaxing.is_some() || time == 0.0;
        if over || self.scenario.until.is_empty() {
            return;
        }
        let header = history::history_header(&self.simulation);
        if self.until.look(&self.scenario.until, rows, &header, time) {
            self.end_motion(Ending::Until);
        }
    }

    fn write_frame(&mut self, folder: &Path) -> Result<(), Error> {
        self.write_files_of_frame(folder, &self.simulation)?;
        self.record_frame(folder, self.simulation.kinds())
    }

    /// Writes the files of a frame, with what is `shown` of rigid bodies, contacts and walls.
    pub(super) fn write_files_of_frame(
        &self,
        folder: &Path,
        shown: &dyn Shown,
    ) -> Result<(), Error> {
        let frames = folder.join(FRAMES);
        fs::create_dir_all(&frames).map_err(|source| ViewError::Write {
            path: frames.clone(),
            source,
        })?;
        let number = self.frames.len();
        let simulation = &self.simulation;
        let [deformable, rigid] = shown.kinds();
        if deformable {
            let path = frames.join(file_name(DEFORMABLE, number));
            write_file(path, |w| shown.write_deformables(w))?;
        }
        if rigid {
            let path = frames.join(file_name(RIGID, number));
            write_file(path, |w| shown.write_rigid(w))?;
        }
        let path = frames.join(file_name(CONTACTS, number));
        write_file(path, |w| shown.write_contacts(w))?;
        if simulation.has_breakable() {
            let path = frames.join(file_name(CRACKS, number));
            write_file(path, |w| simulation.write_cracks(w))?;
        }
        if simulation.has_bonds() {
            let path = frames.join(file_name(BONDS, number));
            write_file(path, |w| simulation.write_bond_facets(w))?;
        }
        if self.scenario.tables {
            self.write_tables(&frames, number)?;
        }
        if self.scenario.pictures {
            self.write_picture(&frames.join(file_name(PICTURE, number)))?;
        }
        let walls = if self.walls_change() {
            frames.join(file_name(WALLS, number))
        } else {
            folder.join(FIXED_WALLS)
        };
        Ok(write_file(walls, |w| shown.write_walls(&self.scenario, w))?)
    }

    /// Notes that a frame of now is there, with deformable bodies or rigid ones.
    pub(super) fn record_frame(&mut self, folder: &Path, kinds: [bool; 2]) -> Result<(), Error> {
        let frame = due(
            self.due_until(),
            self.scenario.frame_interval(),
            self.next_frame,
        );
        self.next_frame = frame.unwrap_or(self.next_frame);
        self.frames.push(self.simulation.world.time());
        self.write_lists(folder, kinds)
    }

    /// Whether walls move or open.
    fn walls_change(&self) -> bool {
        let opens = self.scenario.wall.iter().any(|wall| wall.opens.is_some());
        opens || self.scenario.moves_walls()
    }

    /// Draws the present state, where there is a body or a wall to draw.
    fn write_picture(&self, path: &Path) -> Result<(), Error> {
        match self.picture(&PictureOptions::default()) {
            Ok(picture) => Ok(write_file(path, |w| picture.write_png(w))?),
            Err(Error::View(ViewError::NothingToDraw)) => Ok(()),
            Err(other) => Err(other),
        }
    }

    /// `cracks.vtp`, `fragments.csv` and `events.csv`, where bodies may break.
    fn write_fracture(&self, folder: &Path) -> Result<(), Error> {
        let simulation = &self.simulation;
        if !simulation.has_breakable() {
            return Ok(());
        }
        let (fragments, events) = (simulation.fragments()?.0, simulation.crack_events());
        write_file(folder.join("cracks.vtp"), |w| simulation.write_cracks(w))?;
        write_file(folder.join("fragments.csv"), |w| {
            cracks::write_fragments(&fragments, w)
        })?;
        write_file(folder.join("events.csv"), |w| {
            cracks::write_events(&events, w)
        })?;
        Ok(())
    }

    /// `run.pvd`, `contacts.pvd`, `walls.pvd` and, where bodies may break or are bonded, `cracks.pvd` and `bonds.pvd`.
    fn write_lists(&self, folder: &Path, [deformable, rigid]: [bool; 2]) -> Result<(), Error> {
        let kinds = [(deformable, DEFORMABLE), (rigid, RIGID)];
        let given = || kinds.iter().filter(|(given, _)| *given);
        let (mut bodies, mut contacts) = (Vec::new(), Vec::new());
        let (mut cracks, mut bonds, mut walls) = (Vec::new(), Vec::new(), Vec::new());
        for (number, &time) in self.frames.iter().enumerate() {
            let path = |kind| format!("frames/{}", file_name(kind, number));
            bodies.extend(
                (0..)
                    .zip(given())
                    .map(|(part, (_, kind))| (time, part, path(*kind))),
            );
            contacts.push((time, 0, path(CONTACTS)));
            if self.walls_change() {
                walls.push((time, 0, path(WALLS)));
            }
            cracks.push((time, 0, path(CRACKS)));
            bonds.push((time, 0, path(BONDS)));
        }
        // Walls that stay as they are have one file, which ParaView shows at all times.
        let fixed = self.frames.first().filter(|_| walls.is_empty());
        walls.extend(fixed.map(|&time| (time, 0, FIXED_WALLS.to_owned())));
        write_pvd_parts(folder.join("walls.pvd"), &walls)?;
        if self.simulation.has_breakable() {
            write_pvd_parts(folder.join("cracks.pvd"), &cracks)?;
        }
        if self.simulation.has_bonds() {
            write_pvd_parts(folder.join("bonds.pvd"), &bonds)?;
        }
        write_pvd_parts(folder.join("run.pvd"), &bodies)?;
        Ok(write_pvd_parts(folder.join("contacts.pvd"), &contacts)?)
    }
}

/// The rows of `members.csv` of a time, in the order of the members.
pub(super) struct MemberRows<'a> {
    time: f64,
    members: &'a [Member],
    limits: &'a [UntilEntry],
    /// Where they are written, if they are.
    table: Option<(&'a mut Table, PathBuf)>,
    /// Those at which limits look.
    pub looked: Lines,
}

impl<'a> MemberRows<'a> {
    pub fn new(
        scenario: &'a Scenario,
        members: &'a [Member],
        time: f64,
        table: &'a mut Table,
        folder: &Path,
    ) -> Self {
        let path = folder.join("members.csv");
        Self {
            time,
            members,
            limits: &scenario.until,
            table: scenario.track.then_some((table, path)),
            looked: Vec::new(),
        }
    }

    /// Adds the row of a member.
    pub fn add(&mut self, member: usize, state: &MemberState) -> Result<(), Error> {
        let name = &self.members[member].name;
        let row = state.row(self.time, name);
        let mut limits = self.limits.iter();
        if limits.any(|limit| limit.of.as_ref() == Some(name)) {
            self.looked.push(row.clone());
        }
        match &mut self.table {
            Some((table, path)) => table.row_of_many(row, path),
            None => Ok(()),
        }
    }
}

const DEFORMABLE: (&str, &str) = ("deformable", "vtu");
const RIGID: (&str, &str) = ("rigid", "vtu");
const PICTURE: (&str, &str) = ("picture", "png");
const CONTACTS: (&str, &str) = ("contacts", "vtp");
const BONDS: (&str, &str) = ("bonds", "vtp");
const CRACKS: (&str, &str) = ("cracks", "vtp");
const WALLS: (&str, &str) = ("walls", "vtp");

/// Name of the walls of a run in which none changes.
const FIXED_WALLS: &str = "walls.vtp";

fn file_name((stem, extension): (&str, &str), number: usize) -> String {
    format!("{stem}-{number:05}.{extension}")
}

/// The number after that of the latest due output, if any is due.
pub(super) fn due(time: f64, interval: f64, next: u64) -> Option<u64> {
    let is_due = |number: u64| time >= number as f64 * interval;
    if !is_due(next) {
        return None;
    }
    let mut latest = ((time / interval) as u64).max(next);
    while is_due(latest + 1) {
        latest += 1;
    }
    while latest > next && !is_due(latest) {
        latest -= 1;
    }
    Some(latest + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_fall_due_once_each_and_long_steps_skip_some() {
        let mut next = 0;
        let mut written = Vec::new();
        for step in 0..=30 {
            let time = 0.1 * f64::from(step);
            if let Some(after) = due(time, 0.25, next) {
                written.push(step);
                next = after;
            }
        }
        assert_eq!(written, [0, 3, 5, 8, 10, 13, 15, 18, 20, 23, 25, 28, 30]);
        assert_eq!(due(10.0, 0.25, 3), Some(41));
        assert_eq!(due(0.2, 0.25, 1), None);
    }
}
