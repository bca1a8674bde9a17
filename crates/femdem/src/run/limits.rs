//! Limits of what a scene may ask for.

use super::Scenario;
use crate::Error;
use crate::error::wrong;

/// Most steps of a run: a year of processor time for a body alone.
const MOST_STEPS: f64 = 1e12;

impl Scenario {
    /// Refuses a duration of more than 10¹² steps of `step` \[s\]: such steps come of a number that is wrong, or
    /// vanish beside the time.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the step and what determines it.
    pub fn check_step(&self, step: f64) -> Result<(), Error> {
        if step * MOST_STEPS >= self.duration {
            return Ok(());
        }
        Err(wrong(
            "time step",
            &format!("{step:.3e} s"),
            "at least 1e-12 of the duration: check time-step.safety, time-step.largest, densities, stiffnesses, \
             viscosities and speeds, or shorten the duration",
        ))
    }
}

#[cfg(test)]
mod tests {
    use crate::run::{Run, Scenario};

    const SCENE: &str = "duration = 1
        [material.m]
        density = 1000
        law = \"hencky\"
        young = 1e6
        poisson = 0.3
        shear-viscosity = 1
        [[body]]
        shape = \"cube\"
        size = 0.1
        mesh-size = 1
        behaviour = \"deformable\"
        material = \"m\"
        ";

    fn refused(from: &str, to: &str) -> String {
        let text = SCENE.replacen(from, to, 1);
        let folder = tempfile::tempdir().unwrap();
        let run = Run::new(Scenario::from_toml(&text).unwrap());
        let tried = run.and_then(|mut run| run.advance(folder.path(), 2));
        tried.unwrap_err().to_string()
    }

    #[test]
    fn numbers_with_which_no_run_would_end_are_refused() {
        let safety = "duration = 1\ntime-step.safety = 1e-300\n";
        let viscosity = "shear-viscosity = 1e300";
        for (from, to, words) in [
            (
                "duration = 1",
                safety,
                ["time-step.safety = 0.000", "1e-6 to 1"],
            ),
            (
                "shear-viscosity = 1",
                viscosity,
                ["viscosity = 1000", "from 0 to 1e21 Pa s"],
            ),
            (
                "shear-viscosity = 1",
                "shear-viscosity = 1e21",
                ["time step = ", "viscosities"],
            ),
            (
                "young = 1e6",
                "young = 1e60",
                ["time step = ", "stiffnesses"],
            ),
        ] {
            let message = refused(from, to);
            assert!(words.iter().all(|w| message.contains(w)), "{to}: {message}");
        }
    }
}
