//! A crack that runs along the seam of a beam, and what it takes on the way.

use super::beam::{Beam, Column, Seen};
use super::mean::Mean;
use femdem_contact::BodyId;
use femdem_solve::World;
use std::error::Error;

/// Steps from look to look.
const LOOK: u32 = 20;

/// How a crack is followed.
pub struct Course<'a> {
    pub columns: &'a [Column],
    /// Where the notch ends, m.
    pub tip: f64,
    /// Energy of fracture of the seam, J/m².
    pub energy: f64,
    /// J by the theory of beams, J/m².
    pub of_beam: fn(&Seen) -> f64,
    /// How far beyond the notch the seam is broken when the crack is taken to run steadily, and at the end, m.
    pub steady: f64,
    pub end: f64,
    /// Time in which that has to be, s.
    pub limit: f64,
}

/// What came out.
pub struct Run {
    pub tets: usize,
    /// J over the energy of fracture while the crack runs.
    released: Mean,
    /// The same by the theory of beams, from load and way.
    beam: Mean,
    /// What the broken facets of the seam have taken over their energy of fracture.
    taken: f64,
    /// Relative error of the ledger.
    books: f64,
}

impl Run {
    /// The quantities by name.
    pub fn values(&self) -> [(&'static str, f64); 5] {
        [
            ("released", self.released.value()),
            ("spread", self.released.spread()),
            ("beam", self.beam.value()),
            ("taken", self.taken),
            ("books", self.books),
        ]
    }
}

impl Course<'_> {
    /// Steps a beam that has been started, a body of so many tetrahedra in a world, until its crack has come to the end.
    pub fn follow(
        &self,
        beam: &Beam,
        (mut world, body, tets): (World, BodyId, usize),
    ) -> Result<Run, Box<dyn Error>> {
        let (mut released, mut by_beam) = (Mean::default(), Mean::default());
        loop {
            for _ in 0..LOOK {
                world.step()?;
            }
            let seen = beam.see(&world, body, self.columns)?;
            let broken = beam.front(&world, body) - self.tip;
            if broken > self.steady {
                released.add(seen.released / self.energy);
                by_beam.add((self.of_beam)(&seen) / self.energy);
            }
            if broken > self.end {
                break;
            }
            if world.time() > self.limit {
                return Err("the crack does not run".into());
            }
        }
        Ok(Run {
            tets,
            released,
            beam: by_beam,
            taken: beam.taken(&world, body) / self.energy,
            books: world.ledger().error_relative(),
        })
    }
}
