//! The tables as a few lines of text.

use std::fmt;

use femdem_analysis::{Estimate, Mixing, TiltGroup};

use super::Tables;

/// The residual of a pack at rest is below this.
const UNBALANCED: f64 = 0.05;

impl fmt::Display for Tables {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: Option<String>| match text {
            Some(text) => writeln!(f, "  {name:<20} {text}"),
            None => Ok(()),
        };
        line("density", self.density_text())?;
        line("bed", self.bed_text())?;
        line("free surface", self.surface_text())?;
        line("orientation", self.orientation_text())?;
        line("tilt", self.tilt_text())?;
        line("mixing", self.mixing_text())?;
        line("coordination", self.coordination_text())?;
        line("contact classes", self.classes_text())?;
        line("rattlers", self.rattlers_text())?;
        line("forces", self.forces_text())?;
        line("force chains", self.chains_text())?;
        line("stress of the core", self.stress_text())?;
        line("vertical balance", self.balance_text())?;
        line("fabric", self.fabric_text())?;
        // Tables that are missing for the same reason share a line.
        let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
        for missing in &self.missing {
            match reasons
                .iter_mut()
                .find(|(reason, _)| *reason == missing.reason)
            {
                Some((_, tables)) => tables.push(&missing.table),
                None => reasons.push((&missing.reason, vec![&missing.table])),
            }
        }
        for (reason, tables) in reasons {
            writeln!(f, "  not computed: {}: {reason}", tables.join(", "))?;
        }
        Ok(())
    }
}

impl Tables {
    fn density_text(&self) -> Option<String> {
        let density = self.density.as_ref()?;
        let error = density
            .standard_error
            .map_or(String::new(), |e| format!(" +- {e:.4}"));
        let grid = density
            .grid
            .map_or(String::new(), |grid| format!(", {grid:.4} by grid"));
        let core = self.core.as_ref().map_or(String::new(), |core| {
            let (min, max) = core.density_region().corners();
            let side = |k: usize| (max[k] - min[k]) / self.diameter;
            format!(", {:.1} x {:.1} x {:.1} d", side(0), side(1), side(2))
        });
        Some(format!(
            "{:.4}{error} exact{grid}, of the {}{core}",
            density.exact,
            self.density_space()
        ))
    }

    fn bed_text(&self) -> Option<String> {
        let bed = self.bed.as_ref()?;
        Some(format!(
            "void fraction {:.4}, density {:.4}, from the floor to the mean top, {:.1} d high",
            bed.void_fraction,
            bed.density,
            (bed.top - bed.floor) / self.diameter
        ))
    }

    fn surface_text(&self) -> Option<String> {
        let surface = self.surface.as_ref()?;
        Some(format!(
            "slope {:.1} +- {:.1} degrees as a plane, {:.1} degrees as a heap",
            surface.plane_angle, surface.plane_error, surface.cone_angle
        ))
    }

    fn tilt_text(&self) -> Option<String> {
        let tilt = self.tilt.as_ref()?;
        let mean = |group: &TiltGroup, name: &str| {
            group.mean.map(|mean| format!("{mean:.1} degrees {name}"))
        };
        let parts = [
            mean(&tilt.all, "on average, 57.3 by chance"),
            tilt.side_walls
                .as_ref()
                .and_then(|g| mean(g, "near the side walls")),
            tilt.core.as_ref().and_then(|g| mean(g, "in the core")),
        ];
        Some(parts.into_iter().flatten().collect::<Vec<_>>().join("; "))
    }

    fn mixing_text(&self) -> Option<String> {
        let text = |name: &str, found: &Mixing| {
            let index = found.lacey_index?;
            Some(format!("Lacey's index by {name} {index:.3}"))
        };
        let parts = [
            ("shape", &self.mixing_by_shape),
            ("size", &self.mixing_by_size),
        ];
        let texts = parts
            .iter()
            .filter_map(|(name, found)| text(name, found.as_ref()?));
        Some(texts.collect::<Vec<_>>().join(", ")).filter(|text| !text.is_empty())
    }

    fn orientation_text(&self) -> Option<String> {
        let order = &self.orientation.as_ref()?.order;
        // Three axes at right angles never have nematic order: it is not worth mentioning.
        let parts = [("nematic", &order.nematic), ("cubatic", &order.cubatic)]
            .into_iter()
            .filter(|(_, found)| found.random_deviation > 1e-9)
            .map(|(name, found)| {
                let (mean, deviation) = (found.random_mean, found.random_deviation);
                format!(
                    "{name} order {:.3}, {mean:.3} +- {deviation:.3} by chance",
                    found.value
                )
            });
        Some(parts.collect::<Vec<_>>().join("; ")).filter(|text| !text.is_empty())
    }

    fn coordination_text(&self) -> Option<String> {
        let all = self.coordination.as_ref()?;
        let error = |found: Option<Estimate>| {
            let error = found.and_then(|found| found.standard_error);
            error.map_or(String::new(), |e| format!(" +- {e:.2}"))
        };
        let core = self.core_coordination.as_ref();
        let core = core.filter(|_| !self.has_thin_core());
        let core = core.map_or(String::new(), |c| {
            format!(
                "; {:.2}{} in the core",
                c.mean,
                error(self.core_mean_coordination)
            )
        });
        Some(format!(
            "{:.2}{}, {:.2} without walls{core}",
            all.mean,
            error(self.mean_coordination),
            all.mean_without_walls
        ))
    }

    fn classes_text(&self) -> Option<String> {
        let [face, edge, point, _] = self.classes.as_ref()?.bodies.map(|c| 100.0 * c.share);
        Some(format!(
            "{face:.0} % face-face, {edge:.0} % edge-face, {point:.0} % point"
        ))
    }

    fn rattlers_text(&self) -> Option<String> {
        let found = self.rattlers.as_ref()?;
        Some(format!(
            "{:.1} % of the bodies; constraints over freedoms {:.2} with friction, {:.2} without",
            100.0 * found.share,
            found.stiffness_ratio_frictional,
            found.stiffness_ratio_frictionless
        ))
    }

    fn forces_text(&self) -> Option<String> {
        let found = self.force_distribution.as_ref()?;
        let tail = found.tail.map_or(String::new(), |tail| {
            let [low, high] = tail.interval;
            format!(
                "; tail exp(-{:.2} f), {low:.2} to {high:.2}, above f = {:.2}",
                tail.exponent, tail.start
            )
        });
        Some(format!(
            "mean {:.3e} N, largest {:.1} times the mean{tail}",
            found.mean_force.mean, found.largest
        ))
    }

    fn chains_text(&self) -> Option<String> {
        let text = |name: &str, network: &femdem_analysis::ChainNetwork| {
            format!(
                "{name}: {} with {:.0} % of the bodies, {:.0} % of the force, {} loops",
                network.chains.len(),
                100.0 * network.share_of_bodies,
                100.0 * network.share_of_force,
                network.cycles
            )
        };
        let weight = self.chains_by_weight.as_ref().map(|n| text("by weight", n));
        let stress = self.chains_by_stress.as_ref().map(|n| text("by stress", n));
        let parts: Vec<String> = weight.into_iter().chain(stress).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    fn stress_text(&self) -> Option<String> {
        let core = self.core_stress.as_ref();
        let stress = &core.filter(|_| !self.has_thin_core())?.stress;
        Some(format!(
            "pressure {:.3e} Pa, deviator {:.3e} Pa",
            stress.pressure, stress.deviator
        ))
    }

    fn balance_text(&self) -> Option<String> {
        let worst = self.vertical_balance.as_ref()?.worst;
        Some(if worst < UNBALANCED {
            format!("holds to {worst:.1e} of the weight above")
        } else {
            format!(
                "FAILS by {:.0} % of the weight above: the pack moves, or contacts are missing, doubled or of the wrong sign",
                100.0 * worst
            )
        })
    }

    fn fabric_text(&self) -> Option<String> {
        let normals = &self.fabric.as_ref()?.normals;
        Some(format!(
            "anisotropy of the normals {:.3}, {:.3} by chance",
            normals.anisotropy, normals.anisotropy_noise
        ))
    }
}
