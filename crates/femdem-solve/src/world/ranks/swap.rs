//! What ranks tell each other in a step.

use super::{Share, ranks};
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use femdem_contact::BodyId;
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_mesh::{Rotation, Vector3};

/// Numbers of a moving body: position, orientation, velocity, angular momentum and travel.
const NUMBERS: usize = 14;

impl World {
    /// Brings guests that are awake where their owners have moved them.
    pub(in crate::world) fn meet_guests(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let Some(share) = self.share.take() else {
            return Ok(());
        };
        let swapped = self.swap(&share, halo, |world, list| {
            let awake = list.iter().filter(|&&i| world.batch.is_awake(i));
            awake.flat_map(|&i| world.numbers_of(i)).collect()
        });
        let done = swapped.and_then(|received| {
            for (link, bytes) in share.links.iter().zip(received) {
                self.place_guests(&link.guests, &bytes)?;
            }
            Ok(())
        });
        self.share = Some(share);
        done
    }

    /// Tells the others which bodies are awake, and which of the others hold.
    pub(in crate::world) fn tell_rest(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let Some(mut share) = self.share.take() else {
            return Ok(());
        };
        let swapped = self.swap(&share, halo, |world, list| {
            let state = |&i: &BodyId| match world.batch.is_awake(i) {
                true => 2,
                false => u8::from(world.holds(i)),
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

    fn swap(
        &self,
        share: &Share,
        halo: &mut dyn Halo,
        message: impl Fn(&Self, &[BodyId]) -> Vec<u8>,
    ) -> Result<Vec<Vec<u8>>, SolveError> {
        let with: Vec<usize> = share.links.iter().map(|link| link.rank).collect();
        let messages = share.links.iter().map(|link| message(self, &link.lent));
        let received = halo.swap(&with, messages.collect())?;
        if received.len() == with.len() {
            Ok(received)
        } else {
            Err(ranks("a message is missing"))
        }
    }

    fn numbers_of(&self, id: BodyId) -> [u8; 8 * NUMBERS] {
        let body = &self.bodies[id as usize];
        let turned = body.orientation.coords;
        let parts = [
            body.position.as_slice(),
            turned.as_slice(),
            body.velocity.as_slice(),
            body.momentum.as_slice(),
            &[body.travelled],
        ];
        let mut bytes = [0; 8 * NUMBERS];
        let numbers = parts.into_iter().flatten();
        for (to, number) in bytes.chunks_exact_mut(8).zip(numbers) {
            to.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    fn place_guests(&mut self, guests: &[BodyId], bytes: &[u8]) -> Result<(), SolveError> {
        let mut messages = bytes.chunks_exact(8 * NUMBERS);
        let awake: Vec<BodyId> = guests
            .iter()
            .copied()
            .filter(|&i| self.batch.is_awake(i))
            .collect();
        if bytes.len() != 8 * NUMBERS * awake.len() {
            return Err(ranks("a message of the wrong length came"));
        }
        for guest in awake {
            let mut numbers = [0.0; NUMBERS];
            let words = messages.next().unwrap_or_default().chunks_exact(8);
            for (number, word) in numbers.iter_mut().zip(words) {
                *number = f64::from_le_bytes(word.try_into().unwrap_or_default());
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
        Ok(())
    }

    fn set_guest_awake(&mut self, guest: BodyId, awake: bool) {
        if self.batch.is_awake(guest) == awake {
            return;
        }
        self.batch.set_awake(guest, awake);
        if !awake {
            let body = &mut self.bodies[guest as usize];
            body.velocity = Vector3::zeros();
            body.momentum = Vector3::zeros();
            self.motions[guest as usize] = body.motion();
        }
    }
}
