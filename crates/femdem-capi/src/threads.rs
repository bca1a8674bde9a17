//! On which threads a batch or a world computes.

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::border::{Failure, FemdemStatus};

/// Most threads that can be asked for.
const MOST: u32 = 1024;

/// Threads of one object; those of the process if it has none of its own.
#[derive(Debug, Default)]
pub(crate) struct Threads {
    own: Option<ThreadPool>,
}

impl Threads {
    /// So many threads; 0: those of the process.
    pub fn new(count: u32) -> Result<Self, Failure> {
        if count > MOST {
            return Err(Failure::refused(
                "threads",
                count,
                "at most 1024; 0 for those of the process",
            ));
        }
        let make = || ThreadPoolBuilder::new().num_threads(count as usize).build();
        let own = (count > 0).then(make).transpose();
        let own = own.map_err(|error| Failure::new(FemdemStatus::Refused, error))?;
        Ok(Self { own })
    }

    /// Works on these threads.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.own {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
