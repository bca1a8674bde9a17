//! Flow in a step: walls open, bodies come, are counted and leave.

use femdem_mesh::{Point3, Pose, Vector3};
use femdem_solve::{BodySpec, ShapeId};

use super::state::Supply;
use crate::Error;
use crate::run::{Member, Simulation};

/// Places that are tried in a step at most.
const TRIES: u32 = 16;

impl Simulation {
    /// Whether there are, were or will be rigid bodies.
    pub(in crate::run) fn has_rigid(&self) -> bool {
        // Deformable bodies stay.
        self.has_adaptive()
            || self.members.len() > self.world.deformable_count()
            || !self.flow.supplies.is_empty()
    }

    /// Takes away the walls whose time has come.
    pub(in crate::run) fn open_walls(&mut self) -> Result<(), Error> {
        let time = self.world.time();
        let due = self.flow.openings.iter();
        let due: Vec<u32> = due
            .filter(|opening| opening.time <= time)
            .map(|opening| opening.wall)
            .collect();
        for wall in due {
            if self.world.wall(wall).is_some() {
                self.world.remove_wall(wall)?;
            }
        }
        Ok(())
    }

    /// Counts the bodies that have passed gates, and takes away those that are beyond a sink.
    pub(in crate::run) fn pass_gates(&mut self) -> Result<(), Error> {
        let time = self.world.time();
        for k in 0..self.flow.gates.len() {
            for number in 0..self.members.len() {
                let id = self.members[number].id;
                // Bodies that have left, and those that move as prescribed, pass nothing; deformable and adaptive ones stay.
                let (Some(x), Some(mass)) = (self.world.position(id), self.world.mass(id)) else {
                    continue;
                };
                if self.world.follows_drive(id) == Some(true) {
                    continue;
                }
                let gate = &mut self.flow.gates[k];
                let is_beyond = gate.is_beyond(&x);
                if gate.takes {
                    let stays = self.world.is_adaptive(id);
                    if is_beyond && !stays && self.world.follows_drive(id).is_some() {
                        gate.passed.add(1, mass, time);
                        self.world.remove_body(id)?;
                        self.members[number].id = Member::GONE;
                    }
                } else if is_beyond != gate.beyond[number] {
                    gate.passed.add(if is_beyond { 1 } else { -1 }, mass, time);
                    gate.beyond[number] = is_beyond;
                }
            }
        }
        Ok(())
    }

    /// Distance of the farthest point of a shape from its centroid \[m\].
    pub(super) fn reach_of(&self, shape: ShapeId) -> f64 {
        let shape = &self.world.shapes()[shape as usize];
        let polyhedron = &shape.polyhedron;
        shape.sphere.unwrap_or_else(|| polyhedron.bounding_radius())
    }

    /// Adds the bodies of sources that are due and for which there is room.
    pub(in crate::run) fn bring_bodies(&mut self) -> Result<(), Error> {
        let time = self.world.time();
        for k in 0..self.flow.supplies.len() {
            let due = self.flow.supplies[k].due(time);
            let lacks = |supply: &Supply| (supply.come.bodies as u64) < due;
            if !lacks(&self.flow.supplies[k]) {
                continue;
            }
            // What is there, found once a step.
            let mut others = self.balls();
            for _ in 0..TRIES {
                if !lacks(&self.flow.supplies[k]) {
                    break;
                }
                let place = self.flow.supplies[k].next_place();
                let next = self.flow.supplies[k].next_kind();
                let radius = self.flow.supplies[k].kinds[next].radius;
                let x = place.translation.vector;
                let free =
                    |(at, reach): &(Vector3, f64)| self.between(at, &x).norm() >= radius + reach;
                if others.iter().all(free) && self.is_off_walls(&x, radius) {
                    self.bring(k, next, &place)?;
                    others.push((x, radius));
                }
            }
        }
        Ok(())
    }

    /// Bodies that sources will have brought by a time \[s\], if there is room for them.
    #[must_use]
    pub fn bodies_due(&self, time: f64) -> u64 {
        self.flow.due(time)
    }

    /// Bodies that sources have brought so far.
    #[must_use]
    pub fn bodies_come(&self) -> u64 {
        self.flow.come()
    }

    /// Says which sources have brought fewer bodies than are due.
    pub(in crate::run) fn missing_bodies(&self) -> impl Iterator<Item = String> {
        let time = self.world.time();
        self.flow.supplies.iter().filter_map(move |supply| {
            let (due, come) = (supply.due(time), supply.come.bodies);
            let name = &supply.name;
            (due > come as u64).then(|| {
                format!("source {name} has brought {come} of the {due} bodies that are due: there was no room for more")
            })
        })
    }

    /// Balls around all bodies: centroids and radii \[m\].
    fn balls(&self) -> Vec<(Vector3, f64)> {
        let ball = |member: &Member| {
            let x = self.world.position(member.id)?;
            let radius = match self.world.deformable(member.id) {
                Some(body) => {
                    let far = body.positions().iter().map(|p| (p - x).norm());
                    far.fold(0.0, f64::max)
                }
                None => self.reach_of(self.world.shape_of(member.id)?),
            };
            Some((x, radius))
        };
        self.members.iter().filter_map(ball).collect()
    }

    /// Whether a ball overlaps no wall.
    fn is_off_walls(&self, x: &Vector3, radius: f64) -> bool {
        self.world.walls().all(|(wall, shape)| {
            let pose = self.world.wall_pose(wall).unwrap_or_default();
            let x = pose.inverse_transform_point(&Point3::from(*x));
            shape.clearance(&x.coords) >= radius
        })
    }

    /// Adds the next body of a source, with its centroid and orientation at `place`.
    fn bring(&mut self, k: usize, next: usize, place: &Pose) -> Result<(), Error> {
        let supply = &self.flow.supplies[k];
        let kind = supply.kinds[next];
        let polyhedron = &self.world.shapes()[kind.shape as usize].polyhedron;
        let centroid = polyhedron.mass_properties().centroid;
        let pose = place * Pose::from_parts((-centroid.coords).into(), Default::default());
        let id = self.world.add_body(BodySpec {
            shape: kind.shape,
            density: supply.density,
            pose,
            velocity: Vector3::from(supply.velocity),
            angular_velocity: Vector3::zeros(),
            material: supply.material,
        })?;
        let name = format!("{} {}", supply.name, self.members.len());
        let time = self.world.time();
        let supply = &mut self.flow.supplies[k];
        supply.come.add(1, kind.mass, time);
        supply.kinds[next].come += 1;
        let member = Member {
            name,
            id,
            placed: pose,
            of: None,
        };
        self.join(member, None);
        Ok(())
    }

    /// Adds a member that has come in the run, or has broken off another, beyond the gates that this one is known to have passed.
    fn join(&mut self, member: Member, whole: Option<usize>) {
        let x = self.world.position(member.id).unwrap_or_default();
        for gate in &mut self.flow.gates {
            let known = whole.and_then(|whole| gate.beyond.get(whole).copied());
            let is_beyond = known.unwrap_or_else(|| gate.is_beyond(&x));
            gate.beyond.push(is_beyond);
        }
        self.loads.add_member(&member);
        self.members.push(member);
    }

    /// Makes members of the fragments that have become bodies.
    pub(in crate::run) fn fragment_bodies(&mut self) -> Result<(), Error> {
        let fragmentations = self.world.fragment_bodies();
        for fragmentation in fragmentations.map_err(|source| self.named(source))? {
            let Some(whole) = self.member_of(fragmentation.body) else {
                continue;
            };
            let first = self.members[whole].of.unwrap_or(whole as u32);
            for id in fragmentation.fragments {
                let Member { name, placed, .. } = &self.members[first as usize];
                let member = Member {
                    name: format!("{name} fragment {}", self.members.len()),
                    id,
                    placed: *placed,
                    of: Some(first),
                };
                self.join(member, Some(whole));
            }
        }
        Ok(())
    }
}
