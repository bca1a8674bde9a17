//! A job over ranks, and what these agree on: decisions rest on numbers of the whole pack, which are the same bits on all.

use super::top::{mean_top, place_and_top};
use super::{Job, Packing};
use crate::error::PackError;
use femdem_mesh::Vector3;
use femdem_solve::{Halo, SolveError, World, checkpoint};

impl Packing {
    /// Shares the pack out: each rank has made or read the same job, and keeps a part of its bodies. From then on
    /// [`advance_on`](Self::advance_on) advances it, to the same bits as without ranks.
    ///
    /// # Errors
    /// As [`World::share_out`](femdem_solve::World::share_out), also if the jobs differ.
    pub fn share_out(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        Ok(self.world.share_out_with(&self.job, halo)?)
    }

    /// Shares out a job that the first rank gives, and no other: a whole one, or the part of a first rank of one that ranks shared,
    /// with the worlds of the others, of which each rank has read some or none.
    ///
    /// # Errors
    /// As [`World::share_from_first`] and [`World::share_parts`].
    pub fn share_from_first(
        first: Option<Self>,
        others: Vec<World>,
        halo: &mut dyn Halo,
    ) -> Result<Self, PackError> {
        let mut messages = Vec::new();
        if let Some(Self { world, job }) = &first {
            let bytes = checkpoint::encode(&(job, world.is_shared()))?;
            messages.extend((0..halo.size()).map(|rank| (rank, bytes.clone())));
        }
        let received = halo.send(messages)?;
        let [(0, bytes)] = &received[..] else {
            return Err(SolveError::Ranks {
                why: "the first rank gives the job, and no other rank does".to_owned(),
            }
            .into());
        };
        let (job, is_part): (Job, bool) = checkpoint::decode(bytes)?;
        let first = first.map(|first| first.world);
        let mut count = [others.len() as u64];
        halo.sum(&mut count)?;
        let world = match is_part || count[0] > 0 {
            true => World::share_parts(first.into_iter().chain(others).collect(), halo)?,
            false => World::share_from_first(first, halo)?,
        };
        Ok(Self { world, job })
    }

    /// The whole job, as if there had been no ranks, of the part of the first one and the worlds of the others.
    ///
    /// # Errors
    /// As [`World::of_parts`].
    pub fn of_parts(
        first: Self,
        others: impl IntoIterator<Item = Result<World, SolveError>>,
    ) -> Result<Self, PackError> {
        let Self { world, job } = first;
        let parts = std::iter::once(Ok(world)).chain(others);
        let world = World::of_parts(parts)?;
        Ok(Self { world, job })
    }

    /// The job with all bodies on the first rank, as if there were no others; the one here stays as it is.
    ///
    /// # Errors
    /// As [`World::gather`](femdem_solve::World::gather).
    pub fn gather(&self, halo: &mut dyn Halo) -> Result<Option<Self>, PackError> {
        let world = self.world.gather(halo)?;
        Ok(world.map(|world| Self {
            world,
            job: self.job.clone(),
        }))
    }

    pub(super) fn awake_count(&self, halo: &mut dyn Halo) -> Result<u64, PackError> {
        let mut count = [self.world.awake_count() as u64];
        halo.sum(&mut count)?;
        Ok(count[0])
    }

    /// Centroids of all bodies, m.
    pub(super) fn positions(&self, halo: &mut dyn Halo) -> Result<Vec<Vector3>, PackError> {
        let all = self
            .world
            .of_whole(halo, |world, body| world.position(body))?;
        Ok(all.into_iter().flatten().collect())
    }

    /// See [`mean_top`], m.
    pub(super) fn mean_top(&self, halo: &mut dyn Halo) -> Result<f64, PackError> {
        let all = self.world.of_whole(halo, place_and_top)?;
        let diameter = self.job.spec.diameter();
        Ok(mean_top(
            all.into_iter().flatten(),
            self.world.cell(),
            diameter,
        ))
    }
}

/// The largest of all ranks of each of some numbers, none of which is negative.
pub(super) fn largest<const N: usize>(
    values: [f64; N],
    halo: &mut dyn Halo,
) -> Result<[f64; N], PackError> {
    let mut least = values.map(|value| -value);
    halo.least(&mut least)?;
    Ok(least.map(|value| -value))
}

/// Whether something is so on all ranks.
pub(super) fn is_on_all(so: bool, halo: &mut dyn Halo) -> Result<bool, PackError> {
    let mut least = [f64::from(u8::from(so))];
    halo.least(&mut least)?;
    Ok(least[0] > 0.0)
}
