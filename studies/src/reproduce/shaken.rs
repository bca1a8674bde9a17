//! Platonic solids in a box that is tapped: from loose towards close.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::Scale;
use super::job::{Size, fingerprint};
use super::paper::{DICE, DICE_ERROR, Dice, solid};
use super::run::{Analysis, analysis_in};
use super::runs::Runs;
use crate::validate::chart::{self, Series};
use crate::validate::program::Summary;
use crate::validate::report::{Check, Report, markdown_table, short};

/// Circumscribed diameter, m: the default of `femdem pack`.
const DIAMETER: f64 = 0.05;

/// Friction coefficient, as for the packs at rest that are compared with dice.
const FRICTION: f64 = 0.5;

/// Distance of the bodies at the start, in d.
const SPACING: f64 = 1.05;

/// Time before the first tap, and between rows of the tables, s.
const SETTLING: f64 = 2.0;

/// Time from tap to tap, s.
const INTERVAL: f64 = 0.5;

/// Stroke, m, and frequency of a tap, 1/s: three times gravity at its ends.
const STROKE: f64 = 0.015;
const FREQUENCY: f64 = 10.0;

/// Penalty, Pa, about as `femdem pack` chooses for such packs.
const PENALTY: f64 = 8e6;

/// Taps between rows.
const EACH: u32 = 4;

/// A box of dice that is tapped.
#[derive(Debug, Clone, PartialEq)]
struct Tapped {
    dice: Dice,
    size: Size,
    taps: u32,
}

/// Results after a number of taps.
struct State {
    taps: u32,
    density: (f64, f64),
    /// Overlaps over the volume of the bodies in the core.
    overlap: f64,
}

fn boxes(scale: Scale) -> Vec<Tapped> {
    let volume = |dice: &Dice| solid(dice.name).map_or(0.0, |solid| solid.volume);
    match scale {
        Scale::Quick => DICE
            .iter()
            .filter(|dice| dice.name == "P5")
            .map(|dice| Tapped {
                dice: *dice,
                size: Size::quick(volume(dice)),
                taps: EACH,
            })
            .collect(),
        Scale::Full => DICE
            .iter()
            .map(|dice| Tapped {
                dice: *dice,
                size: Size::cube(volume(dice), 400.0, 5.5, 1.5),
                taps: 6 * EACH,
            })
            .collect(),
    }
}

impl Tapped {
    /// Bodies along x, y and z at the start.
    fn lattice(&self) -> [u32; 3] {
        let side = (self.size.width / SPACING).floor() as u32;
        [side, side, self.size.bodies.div_ceil(side * side)]
    }

    fn bodies(&self) -> u32 {
        self.lattice().iter().product()
    }

    fn height(&self) -> f64 {
        let [_, _, layers] = self.lattice();
        DIAMETER * SPACING * (f64::from(layers) + 2.0)
    }

    /// The scene for `femdem run`. Rows of the table of bodies are at the ends of intervals, when the box is
    /// back and the bodies have had time to settle.
    fn scene(&self) -> String {
        let half = 0.5 * self.size.width * DIAMETER;
        let space = SPACING * DIAMETER;
        let [side, _, layers] = self.lattice();
        let corner = -0.5 * space * f64::from(side - 1);
        let duration = SETTLING + f64::from(self.taps) * INTERVAL;
        let (name, height, taps) = (self.dice.name, self.height(), self.taps);
        format!(
            "title = \"{name}, tapped\"\n\
             duration = {duration}\nevery = {duration}\nhistory-every = {SETTLING}\ntrack = true\n\n\
             [contact]\npenalty = {PENALTY}\nfriction = {FRICTION}\n\n\
             [material.dice]\ndensity = 2560\n\n\
             [[wall]]\nname = \"box\"\n\
             box = {{ lower = [{0}, {0}, 0], upper = [{half}, {half}, {height}], open = true }}\n\
             motion = {{ tap = {{ stroke = [0, 0, {STROKE}], frequency = {FREQUENCY}, interval = {INTERVAL}, \
             start = {SETTLING}, taps = {taps} }} }}\n\n\
             [[body]]\nshape = \"{name}\"\ndiameter = {DIAMETER}\nmaterial = \"dice\"\n\
             position = [{corner}, {corner}, {space}]\n\
             copies = {{ count = [{side}, {side}, {layers}], spacing = [{space}, {space}, {space}], seed = 1 }}\n",
            -half
        )
    }

    fn folder(&self, runs: &Runs) -> PathBuf {
        let print = fingerprint(&self.scene());
        runs.folder()
            .join(format!("tapped_{}_{print:08x}", self.dice.name))
    }

    /// Runs the scene unless its results exist; returns whether they exist now.
    fn make(&self, runs: &Runs) -> Result<bool> {
        let folder = self.folder(runs);
        if folder.join("summary.json").is_file() {
            return Ok(true);
        }
        if runs.is_as_found() {
            return Ok(false);
        }
        let scene = runs
            .workshop()
            .write(&format!("{}.toml", self.dice.name), self.scene().as_bytes())?;
        runs.program()
            .scene(&scene, "--threads 1 --force", &folder)?;
        runs.sign(&folder)?;
        Ok(true)
    }

    /// Densities after 0, 4, 8 ... taps.
    fn states(&self, runs: &Runs) -> Result<Vec<State>> {
        let folder = self.folder(runs);
        let path = folder.join("members.csv");
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let states = states(&text).with_context(|| format!("{} lacks columns", path.display()))?;
        let half = 0.5 * self.size.width * DIAMETER;
        let options = format!(
            "--inside {0},{0},0,{half},{half},{1} --density 2560",
            -half,
            self.height()
        );
        let mut found = Vec::new();
        for (time, rows) in states {
            let taps = ((time - SETTLING) / INTERVAL).round();
            if taps < 0.0 {
                continue;
            }
            let tables = folder.join(format!("taps-{taps}"));
            let analysis = self.measured(runs, &tables, &rows, &options)?;
            found.push(State {
                taps: taps as u32,
                density: analysis.density(),
                overlap: analysis.number("density.parts.overlap_volume")
                    / analysis.number("density.parts.body_volume"),
            });
        }
        Ok(found)
    }

    fn measured(
        &self,
        runs: &Runs,
        tables: &Path,
        rows: &[String],
        options: &str,
    ) -> Result<Analysis> {
        let name = self.dice.name;
        if !tables.join("bodies.csv").is_file() {
            // One body at rest, for the surface.
            let options = format!("--shape {name} --count 1 --box 2x2 --threads 1 --force");
            runs.program().pack(&options, &tables.join("one"))?;
            let surface = format!("shape-{name}.obj");
            fs::copy(tables.join("one").join(&surface), tables.join(&surface))
                .with_context(|| format!("cannot copy {surface}"))?;
            let body = |row: &String| format!("{name},{row}\n");
            let text: String = std::iter::once("shape,x,y,z,qw,qx,qy,qz\n".to_owned())
                .chain(rows.iter().map(body))
                .collect();
            fs::write(tables.join("bodies.csv"), text)
                .with_context(|| format!("cannot write into {}", tables.display()))?;
        }
        analysis_in(runs.program(), tables, options, self.size.inset, tables)
    }
}

/// The rows of each time of `members.csv`: centroid and quaternion of every body.
fn states(table: &str) -> Option<Vec<(f64, Vec<String>)>> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next()?.split(',').collect();
    let column = |name: &str| names.iter().position(|n| *n == name);
    let wanted = ["x", "y", "z", "qw", "qx", "qy", "qz"];
    let places: Vec<usize> = wanted.into_iter().map(column).collect::<Option<_>>()?;
    let mut states: Vec<(f64, Vec<String>)> = Vec::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let time: f64 = cells.first()?.parse().ok()?;
        let row: Option<Vec<&str>> = places
            .iter()
            .map(|place| cells.get(*place).copied())
            .collect();
        let row = row?.join(",");
        match states.last_mut() {
            Some((last, rows)) if *last == time => rows.push(row),
            _ => states.push((time, vec![row])),
        }
    }
    Some(states)
}

/// # Errors
/// When the program fails or a file cannot be written.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let boxes = boxes(scale);
    let there = runs.each(&boxes, |one| one.make(runs))?;
    let (mut rows, mut table, mut lines, mut checks) = (vec![], vec![], vec![], vec![]);
    for (one, there) in boxes.iter().zip(there) {
        let name = one.dice.name;
        checks.push(Check::holds(
            &format!("{name} was run"),
            "yes",
            there,
            there,
        ));
        if !there {
            continue;
        }
        let summary = Summary::read(&one.folder(runs))?;
        let states = one.states(runs)?;
        table.extend(states.iter().map(|state| row(one, state, &summary)));
        lines.push(Series {
            name: name.to_owned(),
            points: states
                .iter()
                .map(|s| [f64::from(s.taps), s.density.0])
                .collect(),
        });
        rows.extend(in_short(one, &states));
    }
    let last = f64::from(boxes.first().map_or(EACH, |one| one.taps));
    let mut report = Report {
        name: "shaken",
        title: "Dice in a tapped box".to_owned(),
        text: text(&rows, &boxes),
        commands: boxes
            .iter()
            .map(|one| {
                format!(
                    "femdem run {}.toml, which is:\n\n{}",
                    one.dice.name,
                    one.scene()
                )
            })
            .collect(),
        checks,
        columns: vec![
            "solid",
            "bodies",
            "taps",
            "density_exact",
            "standard_error",
            "overlap_over_volume",
            "cpu_s",
        ],
        rows: table,
        attachments: Vec::new(),
    };
    let picture = chart::svg(
        ["taps", "packing density"],
        [0.0, last],
        [0.44, 0.74],
        &lines,
    );
    runs.attach(&mut report, "shaken.svg", &picture)?;
    Ok(report)
}

fn row(one: &Tapped, state: &State, summary: &Summary) -> Vec<String> {
    let cost = summary
        .number("cpu_seconds")
        .map_or_else(|_| "none".to_owned(), short);
    let error = state.density.1;
    vec![
        one.dice.name.to_owned(),
        one.bodies().to_string(),
        state.taps.to_string(),
        format!("{:.4}", state.density.0),
        if error.is_finite() {
            format!("{error:.4}")
        } else {
            "none".to_owned()
        },
        short(state.overlap),
        cost,
    ]
}

/// First and last density compared with loose and close packing, and the part of the way between these.
fn in_short(one: &Tapped, states: &[State]) -> Option<Vec<String>> {
    let (first, last) = (states.first()?, states.last()?);
    let Dice { name, loose, close } = one.dice;
    let part = |density: f64| format!("{density:.3} ({:.2})", (density - loose) / (close - loose));
    Some(vec![
        name.to_owned(),
        one.bodies().to_string(),
        loose.to_string(),
        close.to_string(),
        part(first.density.0),
        format!("{} after {} taps", part(last.density.0), last.taps),
        format!("{:+.3}", last.density.0 - first.density.0),
    ])
}

fn text(rows: &[Vec<String>], boxes: &[Tapped]) -> String {
    let inset = boxes.first().map_or(0.0, |one| one.size.inset);
    let heads = [
        "solid", "bodies", "loose", "close", "before", "after", "gained",
    ];
    format!(
        "Platonic solids with friction {FRICTION} fall from a lattice of {SPACING} d into a box, which after {SETTLING} s is \
         lifted and put down by {STROKE} m in {} s (three times gravity) once in {INTERVAL} s. The density is exact, in a core \
         {inset} d from walls, floor and top. Loose and close are those of dice (J. Baker and A. Kudrolli, Phys. Rev. E 82, \
         061304, 2010; ±{DICE_ERROR}); in brackets the place between them. One box of each.\n\n{}\n![Chart](shaken.svg)",
        1.0 / FREQUENCY,
        markdown_table(&heads, rows)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_table_fall_into_times() {
        let table = "time,body,x,y,z,vx,qw,qx,qy,qz\n0,P5 1,1,2,3,9,1,0,0,0\n0,P5 2,4,5,6,9,0,1,0,0\n\
                     2.0001,P5 1,1,2,2,9,1,0,0,0\n";
        let states = states(table).unwrap();
        assert_eq!(states.len(), 2);
        assert_eq!(states[0].1, ["1,2,3,1,0,0,0", "4,5,6,0,1,0,0"]);
        assert_eq!(states[1].0, 2.0001);
        assert!(super::states("time,x\n0,1\n").is_none());
    }

    #[test]
    fn bodies_fit_into_the_box_and_taps_end_with_the_run() {
        for one in boxes(Scale::Full).into_iter().chain(boxes(Scale::Quick)) {
            let [side, _, _] = one.lattice();
            assert!(f64::from(side) * SPACING <= one.size.width);
            assert!(one.bodies() >= one.size.bodies);
            // Rows fall on whole intervals.
            assert!(
                (f64::from(EACH) * INTERVAL - SETTLING).abs() < 1e-12
                    && one.taps.is_multiple_of(EACH)
            );
            assert!(one.scene().contains(&format!("taps = {}", one.taps)));
        }
        // Peak acceleration of a whole period of stroke (1 - cos)/2.
        let peak = 0.5 * STROKE * (2.0 * std::f64::consts::PI * FREQUENCY).powi(2);
        assert!((peak / 9.81 - 3.0).abs() < 0.05, "{peak}");
    }
}
