//! `femdem run --check` and `femdem pack --check`: the contents and the estimated cost of a scene.

use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use femdem::output::{counted, short_number};
use femdem::pack::{PackSpec, Packing, Protocol};
use femdem::run::{BodySummary, ExpectedDepth, FractureMesh, Run, Scenario, Simulation};

use super::progress::span;
use super::{complain, overlaps, say, say_notes};

/// Largest number of trial steps once bodies touch, and the time on the clock after which they are not waited for, and no more steps
/// are taken.
const TRIAL_STEPS: u32 = 50;
const TRIAL_TIME: Duration = Duration::from_secs(1);

/// Time on the clock for a run whose bodies are still to come, and the parts of its duration in which they are counted.
const SOURCE_TIME: Duration = Duration::from_secs(3);
const PARTS: u32 = 64;

/// Steps of a pack between looks at the clock.
const TRIAL_CHUNK: u64 = 20;

/// Steps above which a run has to be wanted expressly: months on any machine.
const MOST_STEPS: f64 = 1e9;

/// Time on the clock for the first bodies of a pack.
const PACK_TIME: Duration = Duration::from_secs(5);

/// Part of the work that placing the bodies is: the rest is coming to rest and the verification.
const PLACING: f64 = 0.9;

/// Time for which bodies that were all released at once fall and come to rest, verification included, beyond the free fall from the
/// lattice, in sqrt(d/g).
const SETTLING: f64 = 30.0;

/// Expected depth over the size of a body from which a forecast warns.
const TOO_DEEP: f64 = 0.1;

/// Bodies of one entry are listed one by one up to this number.
const LISTED: usize = 12;

/// Prints the bodies, then the steps and the time of the run, extrapolated from its beginning.
pub(crate) fn report(run: &Run, threads: usize) -> Result<()> {
    let mut simulation = run.simulation().clone();
    let scenario = run.scenario();
    if !scenario.title.is_empty() {
        say(&scenario.title);
    }
    say_notes(&simulation.notes);
    list(&simulation.bodies());
    for mesh in simulation.fracture_meshes() {
        tell_fracture(&mesh);
    }
    if let Some(bonds) = simulation.bond_summary() {
        say(&format!(
            "bonds: {}, which hold the bodies in {} pieces",
            bonds.count, bonds.pieces
        ));
    }
    let walls: Vec<_> = simulation.world.walls().map(|(_, w)| w.name()).collect();
    if !walls.is_empty() {
        say(&format!("walls: {}", walls.join(", ")));
    }
    if simulation.world.rigid_count() > 0 {
        tell_penalty(run);
    }
    let began = Instant::now();
    let first = simulation.step();
    overlaps::warn(&simulation, complain);
    first?;
    scenario.check_step(simulation.world.time_step())?;
    let touches = |simulation: &Simulation| !simulation.contacts().is_empty();
    while !touches(&simulation) && began.elapsed() < TRIAL_TIME && !is_over(&simulation, scenario) {
        simulation.step()?;
    }
    let touched = touches(&simulation);
    let brings = !scenario.source.is_empty();
    // Bodies come first, so that the cost is that of a step with some of them.
    while brings && began.elapsed() < SOURCE_TIME && !is_over(&simulation, scenario) {
        simulation.step()?;
    }
    let met = Instant::now();
    let mut taken = 0;
    while taken < TRIAL_STEPS && met.elapsed() < TRIAL_TIME {
        simulation.step()?;
        taken += 1;
    }
    let present = simulation.world.rigid_count() + simulation.world.deformable_count();
    let step = simulation.world.time_step();
    let steps = scenario.duration / step;
    let each = met.elapsed().as_secs_f64() / f64::from(taken.max(1));
    let more = match brings {
        true => mean_bodies(&simulation, scenario) / (present.max(1) as f64),
        false => 1.0,
    };
    let left = each * steps * more.max(1.0);
    let tetrahedra: usize = simulation.bodies().iter().map(|body| body.tetrahedra).sum();
    say(&format!(
        "time step: {step:.3e} s, {steps:.0} steps for {} s",
        scenario.duration
    ));
    if let Some(relax) = scenario.relax {
        say(&format!(
            "then at most {} steps to equilibrium, which the cost does not have",
            relax.steps
        ));
    }
    say(&format!(
        "output: {:.0} frames, {tetrahedra} tetrahedra each",
        scenario.duration / scenario.frame_interval() + 1.0
    ));
    let time = Duration::try_from_secs_f64(left).unwrap_or(Duration::MAX);
    say(&format!(
        "cost: about {} on {threads} threads, files not counted, if the run goes on as in {taken} steps from {:.4} s on{}",
        span(time),
        simulation.world.time(),
        match (brings, touched) {
            (true, _) => format!(
                " with {present} of up to {} bodies: contacts that are still to come make it longer",
                simulation.bodies_due(scenario.duration)
            ),
            (false, true) => String::new(),
            (false, false) =>
                ", where nothing touches yet: with contacts it takes longer".to_owned(),
        }
    ));
    if steps > MOST_STEPS {
        complain(&format!(
            "warning: with more than {MOST_STEPS:.0e} steps the run is refused without --yes"
        ));
    }
    Ok(())
}

/// Mean number of bodies over the duration, if none leaves.
fn mean_bodies(simulation: &Simulation, scenario: &Scenario) -> f64 {
    let present = simulation.world.rigid_count() + simulation.world.deformable_count();
    let others = (present as u64).saturating_sub(simulation.bodies_come());
    let at = |part: u32| {
        let time = scenario.duration * (f64::from(part) + 0.5) / f64::from(PARTS);
        simulation.bodies_due(time) as f64
    };
    (0..PARTS).map(at).sum::<f64>() / f64::from(PARTS) + others as f64
}

/// Refuses a run that would take longer than anyone waits for.
pub(crate) fn refuse_too_many_steps(run: &Run) -> Result<()> {
    let (duration, mut trial) = (run.scenario().duration, run.simulation().clone());
    if trial.step().is_err() {
        // The run itself says what is wrong, with its bodies.
        return Ok(());
    }
    let step = trial.world.time_step();
    let steps = (duration - trial.world.time()) / step;
    if steps > MOST_STEPS {
        bail!(
            "the run would take {steps:.1e} steps of {step:.1e} s for {duration} s, above {MOST_STEPS:.0e}: shorten the \
             duration, soften the contacts (contact.penetration), or add --yes"
        );
    }
    Ok(())
}

/// Prints the shapes of a pack, then its steps and its time, extrapolated from the first bodies.
pub(crate) fn pack(mut packing: Packing, threads: usize) -> Result<()> {
    list_shapes(packing.spec());
    say(&format!("penalty: {:.2e} Pa", packing.penalty()));
    let began = Instant::now();
    let mut progress = packing.progress();
    let highest = progress.top;
    while !packing.is_done() && began.elapsed() < PACK_TIME {
        progress = packing.advance(TRIAL_CHUNK)?;
    }
    let spent = began.elapsed().as_secs_f64();
    let step = packing.world().time_step();
    if packing.is_done() {
        say(&format!(
            "cost: {spent:.1} s on {threads} threads, {} steps: the trial came to the end of the job",
            progress.steps
        ));
        return Ok(());
    }
    let spec = packing.spec();
    let part = match spec.protocol {
        Protocol::Release(_) => {
            let unit = (spec.diameter() / spec.gravity).sqrt();
            let fall = (2.0 * highest / spec.gravity).sqrt();
            progress.time / (fall + SETTLING * unit)
        }
        // The bodies come by the clock of the job.
        Protocol::Pour(pour) => {
            PLACING * (progress.time * pour.rate / f64::from(progress.count)).min(1.0)
        }
        _ => PLACING * f64::from(progress.placed) / f64::from(progress.count),
    };
    let time = Duration::try_from_secs_f64(spent / part).unwrap_or(Duration::MAX);
    say(&format!(
        "time step: {step:.3e} s, about {:.1e} steps",
        progress.steps as f64 / part
    ));
    say(&format!(
        "cost: about {} on {threads} threads, files not counted, if the job goes on as in {} steps with {} of {} bodies; a half \
         to twice as much is usual{}",
        span(time),
        progress.steps,
        progress.placed,
        progress.count,
        if packing.world().rigid_contacts().is_empty() {
            ", and more here, where nothing touches yet"
        } else {
            ""
        }
    ));
    Ok(())
}

/// Lists the shapes with the numbers, sizes and masses of their bodies.
fn list_shapes(spec: &PackSpec) {
    say(&format!(
        "{:<28} {:>10} {:>11} {:>11}",
        "shape", "share", "d/m", "mass/kg"
    ));
    for shape in spec.shapes.iter().take(LISTED) {
        say(&format!(
            "{:<28} {:>10} {:>11} {:>11}",
            shape.name,
            short_number(shape.share),
            short_number(shape.diameter()),
            short_number(shape.volume() * shape.density.unwrap_or(spec.density))
        ));
    }
    if spec.shapes.len() > LISTED {
        say(&format!("and {} more", spec.shapes.len() - LISTED));
    }
    let mass = f64::from(spec.count) * spec.mean_volume() * spec.mean_density();
    say(&format!(
        "{} bodies, d = {} m, {} kg; height about {} m",
        spec.count,
        short_number(spec.diameter()),
        short_number(mass),
        short_number(spec.expected_height().max(spec.diameter()))
    ));
}

fn is_over(simulation: &Simulation, scenario: &Scenario) -> bool {
    simulation.world.time() >= scenario.duration
}

/// Prints the penalty and the depths that it lets bodies reach.
fn tell_penalty(run: &Run) {
    let simulation = run.simulation();
    let penalty = &simulation.penalty;
    say(&format!(
        "penalty: {:.2e} Pa: {}",
        penalty.value, penalty.reason
    ));
    let forecast = run.scenario().forecast(simulation);
    let told = |name: &str, ExpectedDepth { depth, body }: &ExpectedDepth| {
        if *depth > 0.0 {
            say(&format!(
                "depth {name}: about {:.2} % of the size of {body}",
                100.0 * depth
            ));
        }
        if *depth > TOO_DEEP {
            complain(&format!(
                "warning: {body} will overlap by {:.0} % of its size {name}: leave contact.penalty out, or take a larger one",
                100.0 * depth
            ));
        }
    };
    told("at rest", &forecast.at_rest);
    told("at the fastest impact", &forecast.at_impact);
}

/// Prints whether the mesh of a breakable body resolves the zone in which its cracks open.
fn tell_fracture(mesh: &FractureMesh) {
    let FractureMesh {
        body,
        process_zone,
        largest_height,
        height,
    } = mesh;
    let length = |metres: &f64| format!("{} m", short_number(*metres));
    say(&format!(
        "cracks of {body}: process zone {}; elements are {} high, at most {} is right",
        length(process_zone),
        length(height),
        length(largest_height)
    ));
    if height > largest_height {
        complain(&format!(
            "warning: the elements of {body} are too coarse: its cracks take more energy than given"
        ));
    }
}

fn list(bodies: &[BodySummary]) {
    say(&format!(
        "{:<24} {:<11} {:>12} {:>9} {:>11}",
        "body", "behaviour", "mass/kg", "nodes", "tetrahedra"
    ));
    for body in bodies.iter().take(LISTED) {
        say(&format!(
            "{:<24} {:<11} {:>12} {:>9} {:>11}",
            body.name,
            body.behaviour,
            short_number(body.mass),
            body.nodes,
            body.tetrahedra
        ));
    }
    if bodies.len() > LISTED {
        say(&format!("and {} more", bodies.len() - LISTED));
    }
    let mass: f64 = bodies.iter().map(|body| body.mass).sum();
    let added: f64 = bodies.iter().map(|body| body.added_mass).sum();
    let scaled = if added > 0.0 {
        format!(
            ", of which mass scaling has added {} kg",
            short_number(added)
        )
    } else {
        String::new()
    };
    say(&format!(
        "{}, {} kg{scaled}",
        counted(bodies.len(), "body", "bodies"),
        short_number(mass)
    ));
}
