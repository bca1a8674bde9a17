//! The summary as text.

use std::fmt;

use femdem_view::output::{counted, short_number};

use super::Summary;
use super::parts::SOLID;

/// A part of a whole, to two digits of a percent.
pub(crate) fn percent(part: f64) -> String {
    format!("{} %", short_number((1e4 * part).round() / 1e2))
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let state = if self.settled {
            "settled"
        } else {
            "NOT settled"
        };
        writeln!(
            f,
            "{} {}, d = {} m, {state}",
            counted(self.count, "body", "bodies"),
            self.shape,
            short_number(self.diameter)
        )?;
        let mut line = |name: &str, text: String| writeln!(f, "  {name:<20} {text}");
        if let Some(sizes) = self.sizes_text() {
            line("sizes", sizes)?;
        }
        line("packing density", self.density_text())?;
        line("bed", self.bed_text())?;
        let z = &self.coordination;
        let patches = z.patches_per_pair.filter(|patches| *patches > 1.0);
        let patches = patches.map_or(String::new(), |n| format!("; {n:.2} patches for each pair"));
        line(
            "coordination",
            format!("{:.2} (sd {:.2}){patches}", z.mean, z.sd),
        )?;
        let p = &self.penetration;
        line(
            "penetration / d",
            format!(
                "mean {:.2e}, largest {:.2e}; overlap volume {:.2e} of the solid",
                p.mean_over_d, p.max_over_d, p.overlap_volume_fraction
            ),
        )?;
        let r = &self.residual;
        line(
            "residual / weight",
            format!(
                "mean {:.2e}, largest {:.2e}; kinetic energy {:.1e} m g d",
                r.mean_over_weight, r.max_over_weight, r.kinetic_energy_over_mgd
            ),
        )?;
        let e = &self.energy;
        line(
            "energy",
            format!(
                "{} J in, {} J left, {} J to friction, {} J to damping; ledger error {:.1e}",
                short_number(e.initial),
                short_number(e.final_energy),
                short_number(e.dissipated_friction),
                short_number(e.dissipated_damping),
                e.ledger_error_relative
            ),
        )?;
        line(
            "simulated",
            format!(
                "{}, the last of {:.2e} s, penalty {:.3e} Pa",
                self.steps_text(),
                self.time_step,
                self.contact.penalty
            ),
        )?;
        line("cost", self.cost_text())?;
        line("state hash", self.state_hash.clone())
    }
}

impl Summary {
    /// Simulated time and steps. Implicit ones are mentioned, because they explain a larger error of the
    /// ledger.
    pub(crate) fn steps_text(&self) -> String {
        let kind = self.implicit_multiple.map_or(String::new(), |multiple| {
            format!(", implicit (x{multiple}) up to the verification")
        });
        format!("{:.3} s in {} steps{kind}", self.simulated_time, self.steps)
    }

    /// The sieve curve, if there are several sizes.
    fn sizes_text(&self) -> Option<String> {
        let points = &self.sieve.points;
        let size = |size: f64| short_number(1e3 * size);
        let passing = |part: f64| Some(size(self.sieve.size_passing(part)?));
        let [first, .., last] = points.as_slice() else {
            return None;
        };
        Some(format!(
            "{} to {} mm; by mass d10 {}, d50 {}, d90 {} mm",
            size(first.size),
            size(last.size),
            passing(0.1)?,
            passing(0.5)?,
            passing(0.9)?
        ))
    }

    fn density_text(&self) -> String {
        let Some(density) = &self.packing_density else {
            let reason = match self.container.kind.as_str() {
                SOLID => "a container from a file has no core",
                _ => "the pack is too low to have a core",
            };
            return format!("none: {reason}");
        };
        let error = match density.standard_error {
            Some(error) => format!(" +- {error:.4}"),
            None => String::new(),
        };
        let extent = |k: usize| (density.core.max[k] - density.core.min[k]) / self.diameter;
        let grid = density.grid.map_or(
            "none by grid (the region is too wide for it)".to_owned(),
            |grid| format!("{grid:.4} by grid"),
        );
        let space = match &density.bed_reason {
            Some(reason) => format!("{reason}: whole bed,"),
            None => "core".to_owned(),
        };
        format!(
            "{:.4}{error} exact, {grid}; {space} {:.1} x {:.1} x {:.1} d",
            density.exact,
            extent(0),
            extent(1),
            extent(2)
        )
    }

    fn bed_text(&self) -> String {
        match (&self.bed, &self.bed_missing) {
            (Some(bed), _) => format!(
                "void fraction {:.4}, density {:.4}, from the floor to the mean top, {:.1} d high",
                bed.void_fraction,
                bed.density,
                (bed.top - bed.floor) / self.diameter
            ),
            (None, reason) => format!("unknown: {}", reason.as_deref().unwrap_or("not measured")),
        }
    }

    fn cost_text(&self) -> String {
        let cpu = self
            .cpu_seconds
            .map_or(String::new(), |s| format!(", {s:.1} s CPU"));
        let pair = self.contact_nanoseconds_per_pair;
        let pair = pair.map_or(String::new(), |ns| {
            format!(", {ns:.0} ns per touching pair")
        });
        let memory = self.peak_memory_bytes;
        let memory = memory.map_or(String::new(), |b| format!(", {} MiB", b >> 20));
        format!(
            "{:.1} s on {} threads{cpu}{pair}{memory}",
            self.wall_seconds, self.threads
        )
    }
}
