//! 500 bodies released at once from a lattice into a box, by this project and by rapier3d, in one
//! process and on one thread, in turns. See `records/peers.md`.

mod clock;
mod measure;
mod ours;
mod rapier;
mod settle;

use anyhow::{Context, Result, bail};
use ours::Ours;
use rapier::{Rapier, Setting};
use settle::Engine;
use std::env;
use std::fs;

/// Options of the comparison.
struct Options {
    shapes: Vec<String>,
    /// Bodies; `None`: 2,000 tetrahedra, 500 of the others.
    count: Option<u32>,
    /// Mean penetrations over d for which our penalties are chosen.
    penetrations: Vec<f64>,
    /// Of the other engine.
    settings: Vec<Setting>,
    /// Whether bodies may sleep: both, one after the other, or one of them.
    sleeping: Vec<bool>,
    /// Multiples of the explicit limit for implicit steps of our own world, beside explicit ones.
    implicit: Vec<f64>,
    /// Seeds of the orientations.
    seeds: Vec<u64>,
    csv: Option<String>,
}

const USAGE: &str = "options: --shapes P5,A1  --count N  --penetrations X,Y  --rapier 60,960:480  --sleeping true,false  --implicit 6  --seeds 1,2  --csv FILE";

impl Options {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self> {
        let mut options = Self {
            shapes: ["P5", "A1", "P3", "A10", "P1"].map(str::to_owned).to_vec(),
            count: None,
            penetrations: vec![settle::PROTOCOL.usual_penetration()],
            settings: ["60", "240", "960", "960:480"]
                .map(str::parse)
                .into_iter()
                .collect::<Result<_, _>>()?,
            sleeping: vec![true, false],
            implicit: Vec::new(),
            seeds: vec![1],
            csv: None,
        };
        while let Some(word) = words.next() {
            let value = words
                .next()
                .with_context(|| format!("{word} needs a value; {USAGE}"))?;
            let parts = value.split(',');
            match word.as_str() {
                "--shapes" => options.shapes = parts.map(str::to_owned).collect(),
                "--count" => options.count = Some(value.parse()?),
                "--penetrations" => {
                    options.penetrations = parts.map(str::parse).collect::<Result<_, _>>()?;
                }
                "--rapier" => options.settings = parts.map(str::parse).collect::<Result<_, _>>()?,
                "--sleeping" => {
                    options.sleeping = parts.map(str::parse).collect::<Result<_, _>>()?
                }
                "--implicit" => {
                    options.implicit = parts.map(str::parse).collect::<Result<_, _>>()?;
                }
                "--seeds" => options.seeds = parts.map(str::parse).collect::<Result<_, _>>()?,
                "--csv" => options.csv = Some(value),
                _ => bail!("unknown option {word}; {USAGE}"),
            }
        }
        Ok(options)
    }
}

fn main() -> Result<()> {
    let options = Options::read(env::args().skip(1))?;
    let mut csv = String::from(
        "shape,bodies,engine,rests,simulated_s,steps,processor_s,processor_s_per_simulated_s,\
         penetration_max_over_d,penetration_mean_over_d,touching_pairs,density,\
         mean_height_over_d,seed\n",
    );
    for shape in &options.shapes {
        let count = options
            .count
            .unwrap_or(if shape == "P1" { 2000 } else { 500 });
        for &seed in &options.seeds {
            compare(shape, count, seed, &options, &mut csv)?;
            if let Some(path) = &options.csv {
                fs::write(path, &csv)?;
            }
        }
    }
    Ok(())
}

/// Runs all engines on one shape and prints a comparison.
fn compare(shape: &str, count: u32, seed: u64, options: &Options, csv: &mut String) -> Result<()> {
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    for &penetration in &options.penetrations {
        let spec = settle::spec(shape, count, penetration, seed)?;
        for &sleeps in &options.sleeping {
            engines.push(Box::new(Ours::new(&spec, sleeps, None)?));
            for &multiple in &options.implicit {
                engines.push(Box::new(Ours::new(&spec, sleeps, Some(multiple))?));
            }
        }
    }
    let spec = settle::spec(shape, count, settle::PROTOCOL.usual_penetration(), seed)?;
    for &setting in &options.settings {
        for &sleeps in &options.sleeping {
            engines.push(Box::new(Rapier::new(&spec, setting, sleeps)?));
        }
    }
    println!("{count} bodies {shape}, seed {seed}");
    println!(
        "  {:53} {:>5} {:>6} {:>8} {:>7} {:>7} {:>7} {:>7} {:>6}",
        "engine", "rests", "sim s", "cpu s/s", "ratio", "max/d", "mean/d", "density", "z/d"
    );
    let mut first = None;
    for (engine, cost) in settle::settle(&spec, engines)? {
        let found = measure::measure(&spec, &engine.poses()?)?;
        let ours = *first.get_or_insert(cost.ratio());
        println!(
            "  {:53} {:>5} {:6.3} {:8.2} {:7.3} {:7.4} {:7.4} {:7.4} {:6.3}",
            engine.name(),
            if cost.rests { "yes" } else { "no" },
            cost.simulated,
            cost.ratio(),
            cost.ratio() / ours,
            found.penetration_max,
            found.penetration_mean,
            found.density,
            found.mean_height
        );
        csv.push_str(&format!(
            "{shape},{count},\"{}\",{},{:.4},{},{:.3},{:.3},{:.5},{:.5},{},{:.4},{:.4},{seed}\n",
            engine.name(),
            cost.rests,
            cost.simulated,
            engine.steps(),
            cost.processor,
            cost.ratio(),
            found.penetration_max,
            found.penetration_mean,
            found.touching,
            found.density,
            found.mean_height
        ));
    }
    Ok(())
}
