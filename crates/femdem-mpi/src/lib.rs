//! Ranks of femdem that talk by MPI.
//!
//! For runs that take too long on one machine: [`MpiHalo`] is the [`Halo`] of
//! [`World::share_out`](femdem::solve::World::share_out) and [`step_on`](femdem::solve::World::step_on), and the program
//! `femdem-mpi` runs scenes over ranks. Not for one machine with shared memory: there the threads of `femdem` do the same with
//! less.
//!
//! ```no_run
//! use femdem::solve::{World, WorldParameters};
//! use femdem_mpi::MpiHalo;
//!
//! let universe = mpi::initialize().ok_or("MPI runs already")?;
//! let mut halo = MpiHalo::new(&universe.world());
//! // All ranks build the same world, and keep their parts of it.
//! let mut world = World::new(WorldParameters::default())?;
//! world.share_out(&mut halo)?;
//! for _ in 0..1000 {
//!     world.step_on(&mut halo)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! An error of MPI ends all ranks, as MPI does by default. A rank whose own step fails should call
//! [`MpiHalo::abort`], since the others wait for it.

use femdem::solve::{Halo, SolveError};
use mpi::collective::SystemOperation;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Equivalence, Source};

/// Tags of messages within steps, and of those when bodies are dealt.
const STEP: i32 = 1;
const DEAL: i32 = 2;

/// The way of a rank to the others.
pub struct MpiHalo {
    comm: SimpleCommunicator,
    rank: usize,
    size: usize,
}

impl MpiHalo {
    /// Over the processes of a communicator, which it duplicates.
    pub fn new(comm: &impl Communicator) -> Self {
        let comm = comm.duplicate();
        Self {
            rank: comm.rank() as usize,
            size: comm.size() as usize,
            comm,
        }
    }

    /// Ends all ranks with an exit status.
    pub fn abort(&self, status: i32) -> ! {
        self.comm.abort(status)
    }

    fn reduce<T: Equivalence + Copy>(&self, values: &mut [T], operation: SystemOperation) {
        let own = values.to_vec();
        self.comm.all_reduce_into(&own[..], values, operation);
    }

    /// Sends messages and receives one from each of some ranks.
    fn exchange(&self, tag: i32, messages: &[(usize, Vec<u8>)], from: &[usize]) -> Vec<Vec<u8>> {
        mpi::request::scope(|scope| {
            let sends: Vec<_> = messages
                .iter()
                .map(|(to, bytes)| {
                    let to = self.comm.process_at_rank(*to as i32);
                    to.immediate_send_with_tag(scope, &bytes[..], tag)
                })
                .collect();
            let receive = |rank: &usize| {
                let process = self.comm.process_at_rank(*rank as i32);
                process.receive_vec_with_tag(tag).0
            };
            let received = from.iter().map(receive).collect();
            for send in sends {
                send.wait();
            }
            received
        })
    }
}

impl Halo for MpiHalo {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn least(&mut self, values: &mut [f64]) -> Result<(), SolveError> {
        self.reduce(values, SystemOperation::min());
        Ok(())
    }

    fn sum(&mut self, counts: &mut [u64]) -> Result<(), SolveError> {
        self.reduce(counts, SystemOperation::sum());
        Ok(())
    }

    fn swap(&mut self, with: &[usize], messages: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, SolveError> {
        let messages: Vec<_> = with.iter().copied().zip(messages).collect();
        Ok(self.exchange(STEP, &messages, with))
    }

    fn send(
        &mut self,
        mut messages: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, SolveError> {
        let mut named = vec![0_u8; self.size];
        for (to, _) in &messages {
            named[*to] = 1;
        }
        let mut names = vec![0_u8; self.size];
        self.comm.all_to_all_into(&named[..], &mut names[..]);
        // What a rank sends to itself needs no way.
        let own = messages.iter().position(|(to, _)| *to == self.rank);
        let own = own.map(|at| messages.swap_remove(at));
        let named = names.iter().enumerate().filter(|(_, named)| **named > 0);
        let others: Vec<usize> = named
            .map(|(rank, _)| rank)
            .filter(|rank| *rank != self.rank)
            .collect();
        let received = self.exchange(DEAL, &messages, &others);
        let mut all: Vec<_> = others.into_iter().zip(received).chain(own).collect();
        all.sort_by_key(|(rank, _)| *rank);
        Ok(all)
    }
}
