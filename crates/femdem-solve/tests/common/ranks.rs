//! Ranks as threads of one program, which talk by channels.

use femdem_solve::{Halo, SolveError};
use std::sync::mpsc::{Receiver, Sender, channel};

type Message = (usize, Vec<u8>);

/// The halo of one thread.
pub struct Threads {
    rank: usize,
    to: Vec<Sender<Message>>,
    from: Receiver<Message>,
    /// Came before it was asked for.
    early: Vec<Message>,
    /// Bytes sent in steps so far.
    pub sent: usize,
}

impl Threads {
    /// Halos of so many threads.
    pub fn of(size: usize) -> Vec<Self> {
        let (to, from): (Vec<_>, Vec<_>) = (0..size).map(|_| channel()).unzip();
        let halo = |(rank, from)| Self {
            rank,
            to: to.clone(),
            from,
            early: Vec::new(),
            sent: 0,
        };
        from.into_iter().enumerate().map(halo).collect()
    }

    /// What so many threads make of their work, in the order of the ranks.
    pub fn each<T: Send>(size: usize, work: impl Fn(&mut Self) -> T + Sync) -> Vec<T> {
        std::thread::scope(|scope| {
            let work = &work;
            let start = |mut halo: Self| scope.spawn(move || work(&mut halo));
            let threads: Vec<_> = Self::of(size).into_iter().map(start).collect();
            let done = threads.into_iter().map(|thread| thread.join().unwrap());
            done.collect()
        })
    }

    fn post(&self, to: usize, bytes: Vec<u8>) -> Result<(), SolveError> {
        let sent = self.to[to].send((self.rank, bytes));
        sent.map_err(|_| SolveError::Ranks {
            why: format!("rank {to} has gone"),
        })
    }

    fn take(&mut self, sender: usize) -> Result<Vec<u8>, SolveError> {
        loop {
            if let Some(at) = self.early.iter().position(|m| m.0 == sender) {
                return Ok(self.early.remove(at).1);
            }
            let wait = std::time::Duration::from_secs(60);
            let message = self.from.recv_timeout(wait);
            self.early.push(message.map_err(|_| SolveError::Ranks {
                why: format!("rank {} waits for rank {sender} in vain", self.rank),
            })?);
        }
    }

    /// The words of all ranks.
    fn all(&mut self, words: &[u64]) -> Result<Vec<Vec<u64>>, SolveError> {
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        for to in 0..self.to.len() {
            self.post(to, bytes.clone())?;
        }
        let word = |b: &[u8]| u64::from_le_bytes(b.try_into().unwrap());
        (0..self.to.len())
            .map(|rank| Ok(self.take(rank)?.chunks(8).map(word).collect()))
            .collect()
    }
}

impl Halo for Threads {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn least(&mut self, values: &mut [f64]) -> Result<(), SolveError> {
        let own: Vec<u64> = values.iter().map(|v| v.to_bits()).collect();
        for other in self.all(&own)? {
            for (least, bits) in values.iter_mut().zip(other) {
                *least = least.min(f64::from_bits(bits));
            }
        }
        Ok(())
    }

    fn sum(&mut self, counts: &mut [u64]) -> Result<(), SolveError> {
        let all = self.all(counts)?;
        for (k, count) in counts.iter_mut().enumerate() {
            *count = all.iter().map(|other| other[k]).sum();
        }
        Ok(())
    }

    fn swap(&mut self, with: &[usize], messages: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, SolveError> {
        for (&to, bytes) in with.iter().zip(messages) {
            self.sent += bytes.len();
            self.post(to, bytes)?;
        }
        with.iter().map(|&rank| self.take(rank)).collect()
    }

    fn send(
        &mut self,
        messages: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, SolveError> {
        let mut out = vec![Vec::new(); self.to.len()];
        let mut named = vec![0; self.to.len()];
        for (to, bytes) in messages {
            out[to] = bytes;
            named[to] = 1;
        }
        let named = self.all(&named)?;
        for (to, bytes) in out.into_iter().enumerate() {
            if named[self.rank][to] > 0 {
                self.post(to, bytes)?;
            }
        }
        let senders: Vec<usize> = (0..self.to.len())
            .filter(|&rank| named[rank][self.rank] > 0)
            .collect();
        senders
            .into_iter()
            .map(|rank| Ok((rank, self.take(rank)?)))
            .collect()
    }
}
