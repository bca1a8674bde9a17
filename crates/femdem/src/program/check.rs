//! `femdem run --check`: the contents and the estimated cost of a scene.

use std::time::{Duration, Instant};

use anyhow::Result;
use femdem::run::{BodySummary, ExpectedDepth, Run, Scenario, Simulation};

use super::progress::span;
use super::{complain, overlaps, say, say_notes};

/// Largest number of trial steps once bodies touch, and the time on the clock after which they are not waited for, and no more steps
/// are taken.
const TRIAL_STEPS: u32 = 50;
const TRIAL_TIME: Duration = Duration::from_secs(1);

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
    let met = Instant::now();
    let mut taken = 0;
    while taken < TRIAL_STEPS && met.elapsed() < TRIAL_TIME {
        simulation.step()?;
        taken += 1;
    }
    let step = simulation.world.time_step();
    let steps = scenario.duration / step;
    let left = met.elapsed().as_secs_f64() / f64::from(taken.max(1)) * steps;
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
        if touched {
            ""
        } else {
            ", where nothing touches yet: with contacts it takes longer"
        }
    ));
    Ok(())
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

fn list(bodies: &[BodySummary]) {
    say(&format!(
        "{:<24} {:<11} {:>12} {:>9} {:>11}",
        "body", "behaviour", "mass/kg", "nodes", "tetrahedra"
    ));
    for body in bodies.iter().take(LISTED) {
        say(&format!(
            "{:<24} {:<11} {:>12.5e} {:>9} {:>11}",
            body.name, body.behaviour, body.mass, body.nodes, body.tetrahedra
        ));
    }
    if bodies.len() > LISTED {
        say(&format!("and {} more", bodies.len() - LISTED));
    }
    let mass: f64 = bodies.iter().map(|body| body.mass).sum();
    let added: f64 = bodies.iter().map(|body| body.added_mass).sum();
    let scaled = if added > 0.0 {
        format!(", of which mass scaling has added {added:.5e} kg")
    } else {
        String::new()
    };
    say(&format!("{} bodies, {mass:.5e} kg{scaled}", bodies.len()));
}
