//! `femdem run --check`: the contents and the estimated cost of a scene.

use std::time::{Duration, Instant};

use anyhow::Result;
use femdem::run::{BodySummary, Run};

use super::progress::span;
use super::{complain, overlaps, say, say_notes};

/// Largest number of trial steps, and the time on the clock after which no more are taken.
const TRIAL_STEPS: u64 = 50;
const TRIAL_TIME: Duration = Duration::from_secs(2);

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
    let walls: Vec<_> = simulation.world.walls().iter().map(|w| w.name()).collect();
    if !walls.is_empty() {
        say(&format!("walls: {}", walls.join(", ")));
    }
    let began = Instant::now();
    let first = simulation.step();
    overlaps::warn(&simulation, complain);
    first?;
    scenario.check_step(simulation.world.time_step())?;
    while simulation.world.steps() < TRIAL_STEPS && began.elapsed() < TRIAL_TIME {
        simulation.step()?;
    }
    let taken = simulation.world.steps() as f64;
    let step = simulation.world.time_step();
    let steps = scenario.duration / step;
    let left = began.elapsed().as_secs_f64() / taken * steps;
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
        "cost: about {} on {threads} threads, files not counted, if the run goes on as its first {taken} steps",
        span(time)
    ));
    Ok(())
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
