//! What ranks tell each other in a step.

use super::{Share, ranks};
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::active::is_any;
use crate::world::deformables::State;
use femdem_contact::BodyId;
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_mesh::{Rotation, Vector3};

/// Numbers of a moving rigid body: position, orientation, velocity, angular momentum and travel.
const NUMBERS: usize = 14;

impl Share {
    /// Sends the other rank of each link a message, and returns as many that come.
    pub(super) fn exchange(
        &self,
        messages: Vec<Vec<u8>>,
        halo: &mut dyn Halo,
    ) -> Result<Vec<Vec<u8>>, SolveError> {
        let with: Vec<usize> = self.links.iter().map(|link| link.rank).collect();
        let received = halo.swap(&with, messages)?;
        if received.len() == with.len() {
            Ok(received)
        } else {
            Err(ranks("a message is missing"))
        }
    }
}

impl World {
    /// Whether the guests of a body follow it: one that is driven moves everywhere by itself.
    fn is_followed(&self, id: BodyId) -> bool {
        self.batch.is_awake(id) && !self.is_driven_body(id)
    }

    /// Brings guests that are awake where their owners have moved them.
    pub(in crate::world) fn meet_guests(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let Some(share) = self.share.take() else {
            return Ok(());
        };
        let swapped = self.swap(&share, halo, |world, list| {
            let mut bytes = Vec::new();
            for &i in list.iter().filter(|&&i| world.is_followed(i)) {
                world.add_numbers(i, &mut bytes);
            }
            bytes
        });
        let done = swapped.and_then(|received| {
            for (link, bytes) in share.links.iter().zip(received) {
                self.place_guests(link.guests.iter(), &bytes)?;
            }
            Ok(())
        });
        self.share = Some(share);
        done
    }

    /// Tells the others which bodies are awake, and which of the others hold. Bodies that are bonded wake together.
    pub(in crate::world) fn tell_rest(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        loop {
            self.tell_awake(halo)?;
            if !self.shares_bonds() {
                return Ok(());
            }
            let sleepers = self.sleepers_beside_bonded();
            self.wake(&sleepers);
            if !is_any(!sleepers.is_empty(), halo)? {
                return Ok(());
            }
        }
    }

    /// Marks guests that their owners have marked. Returns whether one of them was not marked here.
    pub(in crate::world) fn tell_marks(
        &self,
        marks: &mut [bool],
        halo: &mut dyn Halo,
    ) -> Result<bool, SolveError> {
        let Some(share) = self.share.as_deref() else {
            return Ok(false);
        };
        let of = |_: &Self, list: &[BodyId]| {
            let marks = list.iter().map(|&i| u8::from(marks[i as usize]));
            marks.collect()
        };
        let received = self.swap(share, halo, of)?;
        let mut more = false;
        for (link, bytes) in share.links.iter().zip(received) {
            for (&guest, mark) in link.guests.iter().zip(bytes) {
                let own = &mut marks[guest as usize];
                more |= mark > 0 && !*own;
                *own |= mark > 0;
            }
        }
        Ok(more)
    }

    fn tell_awake(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let Some(mut share) = self.share.take() else {
            return Ok(());
        };
        let swapped = self.swap(&share, halo, |world, list| {
            let state = |&i: &BodyId| {
                if world.batch.is_awake(i) {
                    2
                } else {
                    u8::from(world.batch.is_rigid(i) && world.holds(i))
                }
            };
            list.iter().map(state).collect()
        });
        let done = swapped.and_then(|received| {
            let Share { links, holds, .. } = &mut *share;
            for (link, bytes) in links.iter().zip(received) {
                if bytes.len() != link.guests.len() {
                    return Err(ranks("a message of the wrong length came"));
                }
                for (&guest, state) in link.guests.iter().zip(bytes) {
                    holds[guest as usize] = state == 1;
                    self.set_guest_awake(guest, state == 2);
                }
            }
            Ok(())
        });
        self.share = Some(share);
        done
    }

    /// Whether a sleeping body is balanced: of a guest its owner has said so.
    pub(in crate::world) fn stays_balanced(&self, id: BodyId) -> bool {
        match &self.share {
            Some(share) if self.is_guest(id) => share.holds[id as usize],
            _ => self.holds(id),
        }
    }

    /// Sends the other rank of each link a message about what is lent to it, and returns those that come.
    pub(super) fn swap(
        &self,
        share: &Share,
        halo: &mut dyn Halo,
        message: impl Fn(&Self, &[BodyId]) -> Vec<u8>,
    ) -> Result<Vec<Vec<u8>>, SolveError> {
        let messages = share.links.iter().map(|link| message(self, &link.lent));
        share.exchange(messages.collect(), halo)
    }

    /// Adds the numbers of a body that its guests need to follow it: see [`NUMBERS`] and [`State::add_numbers`].
    fn add_numbers(&self, id: BodyId, bytes: &mut Vec<u8>) {
        if let Some(nodes) = self.nodes_of(id) {
            return nodes.add_numbers(bytes);
        }
        let body = &self.bodies[id as usize];
        let turned = body.orientation.coords;
        let parts = [
            body.position.as_slice(),
            turned.as_slice(),
            body.velocity.as_slice(),
            body.momentum.as_slice(),
            &[body.travelled],
        ];
        let numbers = parts.into_iter().flatten();
        bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
    }

    /// The numbers of those of a list that are deformable, which their guests need.
    pub(super) fn numbers_of_soft(&self, list: &[BodyId]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let soft = list.iter().filter(|id| self.batch.is_deformable(**id));
        for &id in soft.filter(|id| self.is_followed(**id)) {
            self.add_numbers(id, &mut bytes);
        }
        bytes
    }

    /// Takes over the [numbers](Self::numbers_of_soft) of those guests of a list that are deformable.
    pub(super) fn place_soft_guests(
        &mut self,
        guests: &[BodyId],
        bytes: &[u8],
    ) -> Result<(), SolveError> {
        let soft = guests.iter().copied();
        let soft = soft.filter(|id| self.batch.is_deformable(*id));
        let soft: Vec<BodyId> = soft.collect();
        self.place_guests(soft.iter(), bytes)
    }

    fn place_guests<'a>(
        &mut self,
        guests: impl Iterator<Item = &'a BodyId>,
        mut bytes: &[u8],
    ) -> Result<(), SolveError> {
        let wrong = || ranks("a message of the wrong length came");
        for &guest in guests {
            if !self.is_followed(guest) {
                continue;
            }
            let count = self
                .nodes_of(guest)
                .map_or(NUMBERS, State::count_of_numbers);
            let (own, rest) = bytes.split_at_checked(8 * count).ok_or_else(wrong)?;
            let numbers = own.chunks_exact(8).map(|word| {
                // Eight bytes each.
                f64::from_le_bytes(word.try_into().unwrap_or_default())
            });
            match self.deformables.as_mut().and_then(|d| d.nodes_mut(guest)) {
                Some(nodes) => nodes.take_numbers(numbers),
                None => self.place_rigid(guest, numbers),
            }
            bytes = rest;
        }
        if bytes.is_empty() {
            Ok(())
        } else {
            Err(wrong())
        }
    }

    fn place_rigid(&mut self, guest: BodyId, own: impl Iterator<Item = f64>) {
        let mut numbers = [0.0; NUMBERS];
        for (number, own) in numbers.iter_mut().zip(own) {
            *number = own;
        }
        let [x, y, z, i, j, k, w, u, v, s, a, b, c, travelled] = numbers;
        let body = &mut self.bodies[guest as usize];
        body.position = Vector3::new(x, y, z);
        body.orientation =
            Rotation::from(UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)));
        body.velocity = Vector3::new(u, v, s);
        body.momentum = Vector3::new(a, b, c);
        body.travelled = travelled;
        let mut motion = body.motion();
        // As the owner does before it evaluates contacts.
        motion.angular_velocity = body.angular_velocity();
        self.motions[guest as usize] = motion;
    }

    fn set_guest_awake(&mut self, guest: BodyId, awake: bool) {
        if self.batch.is_awake(guest) == awake {
            return;
        }
        self.batch.set_awake(guest, awake);
        if awake {
            return;
        }
        if let Some(nodes) = self.deformables.as_mut().and_then(|d| d.nodes_mut(guest)) {
            return nodes.stop();
        }
        let body = &mut self.bodies[guest as usize];
        body.velocity = Vector3::zeros();
        body.momentum = Vector3::zeros();
        self.motions[guest as usize] = body.motion();
    }
}
