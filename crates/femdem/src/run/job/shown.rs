//! What a frame shows: bodies and contacts of one world, or of ranks, of which the first one has a slice at a time.

use std::cell::RefCell;
use std::io;

use femdem_contact::BodyId;
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{Halo, SolveError, checkpoint};
use femdem_view::output::vtu;
use serde::{Deserialize, Serialize};

use crate::grid::{GridBody, write_grid};
use crate::run::frame::Passed;
use crate::run::{ContactLine, Member, Scenario, Side, Simulation};
use crate::{Body, Error};

/// Bodies, or contacts by the body A, or by B of those with walls, of which the first rank gets to know at a time.
const SLICE: usize = 1 << 13;

/// Tetrahedra of deformable bodies of which it gets to know at a time at most, or those of one body.
const TETRAHEDRA: usize = 1 << 14;

/// Bodies, contacts and walls that a frame shows.
pub(super) trait Shown {
    /// Whether there are deformable bodies, and rigid ones.
    fn kinds(&self) -> [bool; 2];

    /// Writes the deformable bodies as [`Simulation::write_deformables`].
    fn write_deformables(&self, writer: &mut dyn io::Write) -> io::Result<()>;

    /// Writes the bodies as [`Simulation::write_rigid`].
    fn write_rigid(&self, writer: &mut dyn io::Write) -> io::Result<()>;

    /// Writes the contacts as [`Simulation::write_contacts`].
    fn write_contacts(&self, writer: &mut dyn io::Write) -> io::Result<()>;

    /// Writes the walls as [`Simulation::write_wall_surfaces`].
    fn write_walls(&self, scene: &Scenario, writer: &mut dyn io::Write) -> io::Result<()>;
}

impl Shown for Simulation {
    fn kinds(&self) -> [bool; 2] {
        [self.has_deformable(), self.has_rigid()]
    }

    fn write_deformables(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        self.write_deformables(writer)
    }

    fn write_rigid(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        self.write_rigid(writer)
    }

    fn write_contacts(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        self.write_contacts(writer)
    }

    fn write_walls(&self, scene: &Scenario, writer: &mut dyn io::Write) -> io::Result<()> {
        self.write_wall_surfaces(scene, writer)
    }
}

/// What a rank shows: its own bodies and contacts by the numbers of bodies in the whole, ascending.
pub(super) struct Own {
    bodies: Vec<(BodyId, Shape)>,
    grids: Vec<(BodyId, GridBody<'static>)>,
    contacts: Vec<ContactLine>,
}

/// Index of the shape, pose and whether it is frozen.
type Shape = (u32, Pose, bool);

/// What the first rank asks of all.
#[derive(Serialize, Deserialize)]
enum Question {
    /// The rigid bodies of these numbers.
    Bodies(Vec<BodyId>),
    /// How many tetrahedra the deformable bodies of these numbers have.
    Tetrahedra(Vec<BodyId>),
    /// The deformable bodies of these numbers.
    Grids(Vec<BodyId>),
    /// The contacts from a pair up to another.
    Contacts([(Side, usize); 2]),
    /// Nothing more.
    End,
}

impl Own {
    /// Of a simulation of the bodies of a rank, members by index.
    ///
    /// # Errors
    ///
    /// If an element has no stress.
    pub fn of(simulation: &Simulation) -> Result<Self, Error> {
        let world = &simulation.world;
        let number = |id| world.number_in_whole(id);
        let bodies = world.own_bodies(0).filter_map(|id| {
            let shape = (
                world.shape_of(id)?,
                simulation.shown(id)?,
                world.is_asleep(id),
            );
            Some((number(id)?, shape))
        });
        let of_member = |member: usize| {
            let id = simulation.members[member].id;
            let number = number(id);
            debug_assert!(number.is_some(), "contacts are of bodies of the world");
            number.unwrap_or(id) as usize
        };
        let contacts = simulation.own_contacts().into_iter().map(|contact| {
            let a = match contact.a {
                Side::Member(member) => Side::Member(of_member(member)),
                wall @ Side::Wall(_) => wall,
            };
            let b = of_member(contact.b);
            ContactLine { a, b, ..contact }
        });
        let strained = simulation.strained()?;
        let grids = strained.iter().filter_map(|body| {
            let number = number(body.entry.id)?;
            Some((number, body.in_grid().into_owned()))
        });
        Ok(Self {
            bodies: bodies.collect(),
            grids: grids.collect(),
            contacts: contacts.collect(),
        })
    }

    /// Those of a list with these numbers, with their places among these.
    fn of_numbers<T>(list: &[(BodyId, T)], numbers: Vec<BodyId>) -> Vec<(u32, &T)> {
        let numbers = (0_u32..).zip(numbers);
        let known = numbers.filter_map(|(at, number)| {
            let place = list.binary_search_by_key(&number, |(number, _)| *number);
            Some((at, &list[place.ok()?].1))
        });
        known.collect()
    }

    fn contacts(&self, [from, to]: [(Side, usize); 2]) -> &[ContactLine] {
        let [from, to] = [from, to].map(|end| {
            let before = |c: &ContactLine| (c.a, c.b) < end;
            self.contacts.partition_point(before)
        });
        self.contacts.get(from..to).unwrap_or_default()
    }

    /// Answers the first rank, until it has no more questions.
    pub fn answer(&self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        while self.answered(&[], halo)?.is_some() {}
        Ok(())
    }

    /// Answers a question that the first rank has sent, and returns what it gets of all ranks; `None` at the end.
    fn answered(
        &self,
        question: &[u8],
        halo: &mut dyn Halo,
    ) -> Result<Option<Vec<Vec<u8>>>, SolveError> {
        let mut messages = Vec::new();
        if halo.rank() == 0 {
            messages.extend((0..halo.size()).map(|rank| (rank, question.to_vec())));
        }
        let received = halo.send(messages)?;
        let none = || SolveError::Ranks {
            why: "the first rank asks what a frame shows".to_owned(),
        };
        let (_, bytes) = received.first().ok_or_else(none)?;
        let own = match checkpoint::decode(bytes)? {
            Question::End => return Ok(None),
            Question::Bodies(numbers) => {
                checkpoint::encode(&Self::of_numbers(&self.bodies, numbers))?
            }
            Question::Tetrahedra(numbers) => {
                let grids = Self::of_numbers(&self.grids, numbers).into_iter();
                let counts: Vec<(u32, usize)> =
                    grids.map(|(at, grid)| (at, grid.stresses.len())).collect();
                checkpoint::encode(&counts)?
            }
            Question::Grids(numbers) => {
                checkpoint::encode(&Self::of_numbers(&self.grids, numbers))?
            }
            Question::Contacts(range) => checkpoint::encode(&self.contacts(range))?,
        };
        let all = halo.send(vec![(0, own)])?.into_iter();
        Ok(Some(all.map(|(_, bytes)| bytes).collect()))
    }
}

/// What all ranks show, on the first one.
pub(super) struct OfRanks<'a> {
    own: Own,
    /// The run's, with the world of this rank.
    simulation: &'a Simulation,
    halo: RefCell<&'a mut dyn Halo>,
    /// The members of bodies, by their numbers in the whole.
    members: Vec<u32>,
    /// Number of deformable bodies in the whole.
    deformable: usize,
    /// Lowest and highest corner of the box around the bodies \[m\].
    extent: Option<[Vector3; 2]>,
    /// Forces on the walls \[N\].
    forces: &'a [Vector3],
    slice: usize,
    tetrahedra: usize,
}

impl<'a> OfRanks<'a> {
    pub fn new(
        own: Own,
        simulation: &'a Simulation,
        deformable: usize,
        extent: Option<[Vector3; 2]>,
        forces: &'a [Vector3],
        halo: &'a mut dyn Halo,
    ) -> Self {
        let there = (0_u32..).zip(&simulation.members);
        let there = there.filter(|(_, member)| member.id != Member::GONE);
        let last = there.clone().map(|(_, member)| member.id).max();
        let mut members = vec![u32::MAX; last.map_or(0, |last| last as usize + 1)];
        for (at, member) in there {
            members[member.id as usize] = at;
        }
        Self {
            own,
            simulation,
            halo: RefCell::new(halo),
            members,
            deformable,
            extent,
            forces,
            slice: SLICE,
            tetrahedra: TETRAHEDRA,
        }
    }

    /// Lets the others go on.
    pub fn end(&self) -> Result<(), SolveError> {
        let question = checkpoint::encode(&Question::End)?;
        let mut halo = self.halo.borrow_mut();
        self.own.answered(&question, &mut **halo).map(|_| ())
    }

    fn ask<T: serde::de::DeserializeOwned>(&self, question: &Question) -> io::Result<Vec<T>> {
        let asked = || {
            let question = checkpoint::encode(question)?;
            let mut halo = self.halo.borrow_mut();
            let answers = self.own.answered(&question, &mut **halo)?;
            let mut all = Vec::new();
            for bytes in answers.into_iter().flatten() {
                let part: Vec<T> = checkpoint::decode(&bytes)?;
                all.extend(part);
            }
            Ok::<_, SolveError>(all)
        };
        asked().map_err(io::Error::other)
    }

    /// Passes on the bodies in the order of the members, with their numbers among these.
    fn pass_bodies(&self, take: &mut dyn FnMut(&Body, i64) -> io::Result<()>) -> io::Result<()> {
        let members = &self.simulation.members;
        let firsts = (0_u32..).step_by(self.slice);
        for (slice, first) in members.chunks(self.slice).zip(firsts) {
            let numbers = slice.iter().map(|member| member.id).collect();
            let mut bodies: Vec<(u32, Shape)> = self.ask(&Question::Bodies(numbers))?;
            bodies.sort_by_key(|(at, _)| *at);
            for (at, (shape, pose, sleeping)) in bodies {
                let sequence = first + at;
                let body = Body {
                    shape,
                    pose,
                    sequence,
                    sleeping,
                };
                take(&body, i64::from(sequence))?;
            }
        }
        Ok(())
    }

    /// Passes on the deformable bodies in the order of the members, with their numbers among these.
    fn pass_grids(&self, take: &mut dyn FnMut(&GridBody<'_>) -> io::Result<()>) -> io::Result<()> {
        let members = &self.simulation.members;
        for slice in self.slices_of_grids()? {
            let numbers = slice.iter().map(|member| members[*member].id).collect();
            let mut bodies: Vec<(u32, GridBody<'static>)> = self.ask(&Question::Grids(numbers))?;
            bodies.sort_by_key(|(at, _)| *at);
            for (at, mut body) in bodies {
                body.number = slice[at as usize];
                body.placed = members[body.number].placed;
                take(&body)?;
            }
        }
        Ok(())
    }

    /// The members that are deformable bodies, in slices of a limited number of tetrahedra or of one body.
    fn slices_of_grids(&self) -> io::Result<Vec<Vec<usize>>> {
        let members = &self.simulation.members;
        let mut slices: Vec<Vec<usize>> = Vec::new();
        let mut room = 0;
        for (slice, first) in members.chunks(self.slice).zip((0..).step_by(self.slice)) {
            let numbers = slice.iter().map(|member| member.id).collect();
            let mut counts: Vec<(u32, usize)> = self.ask(&Question::Tetrahedra(numbers))?;
            counts.sort_by_key(|(at, _)| *at);
            for (at, count) in counts {
                if count > room || slices.is_empty() {
                    slices.push(Vec::new());
                    room = self.tetrahedra;
                }
                room = room.saturating_sub(count);
                if let Some(last) = slices.last_mut() {
                    last.push(first + at as usize);
                }
            }
        }
        Ok(slices)
    }

    /// Passes on the contacts in their order: by A and then B, those with walls last.
    fn pass_contacts(
        &self,
        take: &mut dyn FnMut(&ContactLine) -> io::Result<()>,
    ) -> io::Result<()> {
        let (total, size) = (self.members.len(), self.slice);
        let starts = || (0..total).step_by(size);
        let between = starts().map(|k| [k, k + size].map(|a| (Side::Member(a), 0)));
        let walls = self.simulation.world.walls();
        let with_walls = walls.flat_map(|(wall, _)| {
            let wall = Side::Wall(wall as usize);
            starts().map(move |k| [(wall, k), (wall, k + size)])
        });
        for range in between.chain(with_walls) {
            let mut contacts: Vec<ContactLine> = self.ask(&Question::Contacts(range))?;
            contacts.sort_by_key(|contact| (contact.a, contact.b));
            for mut contact in contacts {
                if let Side::Member(a) = &mut contact.a {
                    *a = self.members[*a] as usize;
                }
                contact.b = self.members[contact.b] as usize;
                take(&contact)?;
            }
        }
        Ok(())
    }
}

impl Shown for OfRanks<'_> {
    fn kinds(&self) -> [bool; 2] {
        let deformable = self.deformable;
        [deformable > 0, self.simulation.has_rigid_beside(deformable)]
    }

    fn write_deformables(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        write_grid(&|take| self.pass_grids(take), writer, |_| {})
    }

    fn write_rigid(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        let shapes = self.simulation.named_shapes();
        vtu::write_passed(&shapes, &|take| self.pass_bodies(take), writer)
    }

    fn write_contacts(&self, writer: &mut dyn io::Write) -> io::Result<()> {
        let contacts: &Passed<'_> = &|take| self.pass_contacts(take);
        self.simulation.write_passed_contacts(contacts, writer)
    }

    fn write_walls(&self, scene: &Scenario, writer: &mut dyn io::Write) -> io::Result<()> {
        let simulation = self.simulation;
        simulation.write_walls_around(self.extent, self.forces, scene, writer)
    }
}

#[cfg(test)]
mod tests {
    use femdem_solve::Alone;

    use super::*;
    use crate::run::{Run, Scenario};

    const STONES: &str = "duration = 1
        [contact]
        penalty = 1e6
        [material.stone]
        density = 2500
        [[wall]]
        name = \"box\"
        box = { lower = [0, 0, 0], upper = [0.16, 0.11, 0.3], open = true }
        [[body]]
        name = \"stone\"
        shape = \"A10\"
        diameter = 0.05
        material = \"stone\"
        position = [0.027, 0.027, 0.026]
        copies = { count = [3, 2, 2], spacing = [0.05, 0.05, 0.047], seed = 1 }
        [material.rubber]
        density = 1200
        law = \"neo-hookean\"
        young = 1e6
        poisson = 0.3
        [[body]]
        name = \"rubber\"
        block = [1, 1, 1]
        sides = [0.03, 0.03, 0.03]
        material = \"rubber\"
        behaviour = \"deformable\"
        position = [0.03, 0.055, 0.14]
        copies = { count = [3, 1, 1], spacing = [0.05, 0.1, 0.1] }";

    /// Slices of two bodies, of those of fewer than two blocks, and of contacts with each other and with the walls.
    #[test]
    fn a_frame_in_slices_is_that_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(STONES).unwrap()).unwrap();
        run.advance(folder.path(), 900).unwrap();
        let simulation = run.simulation();
        let contacts = simulation.contacts();
        let with_walls = contacts
            .iter()
            .filter(|c| matches!(c.a, Side::Wall(_)))
            .count();
        assert!(
            with_walls > 10 && contacts.len() > with_walls + 10,
            "{with_walls}"
        );
        let (extent, forces) = (simulation.extent_of_bodies(), simulation.forces(&contacts));
        let mut halo = Alone;
        let own = Own::of(simulation).unwrap();
        let mut frame = OfRanks::new(own, simulation, 3, extent, &forces.walls, &mut halo);
        frame.slice = 2;
        let blocks = simulation
            .deformables()
            .map(|(_, _, body)| body.model().volumes().len());
        frame.tetrahedra = 2 * blocks.max().unwrap() - 1;
        assert_eq!(frame.slices_of_grids().unwrap().len(), 3);
        let written = |shown: &dyn Shown| {
            let mut files = [const { Vec::new() }; 4];
            shown.write_rigid(&mut files[0]).unwrap();
            shown.write_deformables(&mut files[3]).unwrap();
            shown.write_contacts(&mut files[1]).unwrap();
            shown.write_walls(run.scenario(), &mut files[2]).unwrap();
            files
        };
        assert!(written(&frame) == written(simulation));
    }
}
