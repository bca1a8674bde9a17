//! The summary of a run as rows of text.

use std::fmt;

use femdem_view::output::short_number;

use super::books::NOTED;
use super::{Ending, FractureSummary, Penalty, RelaxSummary, RestSummary, RunSummary};

/// A name and its text.
type Row = (String, String);

impl fmt::Display for RunSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let title = if self.title.is_empty() {
            "run"
        } else {
            &self.title
        };
        let end = match self.ending {
            Some(Ending::Time) => "to its end",
            Some(Ending::Rest) => "to rest",
            Some(Ending::Until) => "to its limit",
            None => "not finished",
        };
        writeln!(f, "{title}: {end}")?;
        let rows = self.rows_of_the_course().into_iter();
        for (name, text) in rows.chain(self.rows_of_loads()).chain([self.row_of_cost()]) {
            writeln!(f, "  {name:<20} {text}")?;
        }
        Ok(())
    }
}

impl RunSummary {
    /// The bodies, the duration, and the energy.
    fn rows_of_the_course(&self) -> Vec<Row> {
        let deformable = self.bodies.iter().filter(|b| b.tetrahedra > 0).count();
        let rigid = self.bodies.len() - deformable;
        let tets = self.tetrahedra;
        let bodies = format!("{deformable} deformable ({tets} tetrahedra), {rigid} rigid");
        let simulated = format!(
            "{} s in {} steps, the last of {:.3e} s{}",
            short_number(self.simulated_time),
            self.steps,
            self.time_step,
            self.beyond()
        );
        let e = &self.energy;
        let missing = e.ledger_error_relative;
        let warning = if missing.abs() > NOTED {
            "; above 1 %: take smaller steps (time-step.safety)"
        } else {
            ""
        };
        let energy = format!(
            "{} J in motion, {} J of strain; the books miss {missing:.1e} of what was turned over{warning}",
            short_number(e.kinetic),
            short_number(e.strain)
        );
        let mut rows = vec![row("bodies", bodies), row("simulated", simulated)];
        rows.extend(self.reached.as_ref().map(|reached| {
            let whose = reached
                .of
                .as_ref()
                .map_or_else(String::new, |of| format!(" of {of}"));
            let text = format!("{}{whose}: {}", reached.column, short_number(reached.value));
            row("limit", text)
        }));
        let of = match self.contacts {
            0 => "loads",
            _ => "mean contact force",
        };
        rows.extend(
            self.relaxed
                .as_ref()
                .map(|r| row("relaxed", relaxed(r, of))),
        );
        rows.extend(self.added_mass().map(|text| row("mass", text)));
        rows.push(row("energy", energy));
        rows.extend(self.fracture.as_ref().map(|found| {
            let taken = e.dissipated_fracture + e.cracks - e.lent;
            row("fracture", broken(found, taken))
        }));
        rows.push(row("rest", self.rest.to_string()));
        rows
    }

    /// Stresses, strains, depths and forces.
    fn rows_of_loads(&self) -> Vec<Row> {
        let stress = self.strain.as_ref().map(|strain| {
            let text = format!("at most {:.4e} Pa", strain.max_von_mises);
            row("von Mises stress", text)
        });
        let strains = self.bodies.iter().filter_map(|b| b.max_plastic_strain);
        let plastic = strains
            .reduce(f64::max)
            .map(|strain| row("plastic strain", format!("at most {strain:.4e}")));
        let rigid = self.bodies.iter().any(|body| body.tetrahedra == 0);
        let Penalty { value, reason } = &self.penalty;
        let penalty = rigid.then(|| row("penalty", format!("{value:.2e} Pa: {reason}")));
        let warnings = self
            .warnings
            .iter()
            .map(|text| row("warning", text.clone()));
        let depth = self.penetration.as_ref().map(|deep| {
            let [a, b] = &deep.peak_between;
            let (peak, time) = (deep.peak, deep.peak_time);
            let text = format!(
                "at most {peak:.3e} m, of {a} and {b} at {} s",
                short_number(time)
            );
            row("penetration", text)
        });
        let peak = |force: f64, time: f64| {
            format!("{} N at {} s", short_number(force), short_number(time))
        };
        let walls = self.walls.iter().filter(|wall| wall.peak_force > 0.0);
        let walls = walls.map(|wall| {
            let text = peak(wall.peak_force, wall.peak_time);
            (format!("peak on {}", wall.name), text)
        });
        let cells = self.cells.iter().map(|cell| {
            let three =
                |of: [f64; 3], digits: usize| of.map(|x| format!("{x:.digits$e}")).join(" ");
            let text = format!(
                "stress {} Pa, strain {}, solid fraction {:.4}",
                three(cell.stress, 3),
                three(cell.strain, 3),
                cell.solid_fraction
            );
            row(&cell.name, text)
        });
        let flow = self.flow.iter();
        let flow = flow.map(|(name, found)| (format!("{} {name}", found.kind), found.to_string()));
        let supports = self.reactions.iter().map(|support| {
            let name = format!("peak of {} {}", support.body, support.boundary);
            (name, peak(support.peak_force, support.peak_time))
        });
        let body = [stress, plastic, penalty, depth].into_iter().flatten();
        body.chain(warnings)
            .chain(walls)
            .chain(cells)
            .chain(flow)
            .chain(supports)
            .collect()
    }

    fn row_of_cost(&self) -> Row {
        let each = self.nanoseconds_per_tet_step.map_or(String::new(), |each| {
            format!(", {each:.1} ns per tetrahedron and step")
        });
        let (wall, threads) = (self.wall_seconds, self.threads);
        row("cost", format!("{wall:.1} s on {threads} threads{each}"))
    }

    /// How far the last step went beyond the duration.
    fn beyond(&self) -> String {
        let beyond = self.simulated_time - self.duration;
        if beyond > 0.0 && self.relaxed.is_none() {
            format!(", {beyond:.1e} s beyond the duration")
        } else {
            String::new()
        }
    }

    /// Mass added by mass scaling, if any.
    fn added_mass(&self) -> Option<String> {
        let added: f64 = self.bodies.iter().map(|body| body.added_mass).sum();
        let mass: f64 = self.bodies.iter().map(|body| body.mass).sum();
        let share = 100.0 * added / mass;
        let text = format!("{added:.4e} kg added by scaling, {share:.2} % of all");
        (added > 0.0).then_some(text)
    }
}

impl fmt::Display for RestSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            at_rest,
            driven,
            frozen,
            residual,
            worst,
            motion,
            force_balance,
        } = self;
        f.write_str(if *at_rest {
            "at rest: "
        } else {
            "NOT at rest: "
        })?;
        if *driven {
            f.write_str("something still moves as prescribed; ")?;
        }
        if *frozen > 0 {
            write!(f, "{frozen} bodies are frozen; ")?;
        }
        write!(f, "{residual:.1e} of a load is out of balance")?;
        if let Some(worst) = worst.as_ref().filter(|_| *residual > 0.0) {
            write!(f, " (most at {worst})")?;
        }
        match motion {
            Some(motion) => write!(f, ", kinetic energy {motion:.1e} of load times size")?,
            None => f.write_str(", a body moves freely")?,
        }
        write!(f, ", walls and weight differ by {force_balance:.1e}")
    }
}

/// `taken` is what the cracks have taken \[J\].
fn broken(found: &FractureSummary, taken: f64) -> String {
    let FractureSummary {
        bodies,
        fragments,
        largest_share,
        broken_area,
        highest,
        ..
    } = found;
    let bodies = match bodies {
        1 => "1 breakable body".to_owned(),
        count => format!("{count} breakable bodies"),
    };
    let pieces = match fragments {
        1 => "in 1 piece".to_owned(),
        count => format!(
            "in {count} pieces, the largest with {:.1} % of the mass",
            100.0 * largest_share
        ),
    };
    format!(
        "{bodies} {pieces}; {} m² broken, {} J in cracks; stress at most {highest:.2} of the strength at the last look",
        short_number(*broken_area),
        short_number(taken)
    )
}

fn row(name: &str, text: String) -> Row {
    (name.to_owned(), text)
}

/// `of` is the reference of the residual.
fn relaxed(found: &RelaxSummary, of: &str) -> String {
    let RelaxSummary {
        converged,
        residual,
        steps,
        solved,
    } = found;
    let missed = if *converged { "" } else { "NOT " };
    let newton = match solved {
        0 => String::new(),
        1 => "Newton's method for one body and ".to_owned(),
        count => format!("Newton's method for {count} bodies and "),
    };
    format!(
        "{missed}in equilibrium after {newton}{steps} more steps: {residual:.1e} of the {of} is left"
    )
}
