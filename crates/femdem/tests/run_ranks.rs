//! Runs over ranks: the files of one world.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use femdem::run::{Ending, HISTORY_COLUMNS, Member, Part, Run, Scenario};
use femdem::solve::{Alone, Halo, SolveError};
use femdem::{Error, Usage};

use crate::threads::Threads;

pub const STONES: &str = r#"
duration = 3
every = 0.04
track = true

[contact]
friction = 0.4
damping = 0.5
penalty = 1e6

[material.stone]
density = 2500

[[wall]]
name = "box"
box = { lower = [0, 0, 0], upper = [0.42, 0.15, 0.3], open = true }

[[body]]
name = "stone"
shape = "A10"
diameter = 0.05
material = "stone"
position = [0.03, 0.035, 0.03]
copies = { count = [7, 2, 2], spacing = [0.058, 0.07, 0.07], seed = 1 }
"#;

/// The frames and tables of a run, and why it ended and when.
pub type Result = (BTreeMap<String, Vec<u8>>, Option<Ending>, f64);

/// Over time.
const OF_TIME: [&str; 4] = ["flow.csv", "members.csv", "wall_history.csv", "cells.csv"];

/// Where bodies may break, of the end.
const TABLES: [&str; 3] = ["cracks.vtp", "fragments.csv", "events.csv"];

/// What a run has made; one in which bodies broke is ended, which writes their tables.
pub fn result(run: &mut Run, folder: &Path) -> Result {
    let ending = run.ending();
    if run.simulation().members.iter().any(|m| m.of.is_some()) {
        run.finish(folder, &Usage::default()).unwrap();
    }
    let files = fs::read_dir(folder.join("frames")).unwrap();
    let file = |entry: std::io::Result<fs::DirEntry>| {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read(path).unwrap())
    };
    let mut files: BTreeMap<String, Vec<u8>> = files.map(file).collect();
    for name in OF_TIME.into_iter().chain(TABLES) {
        let table = fs::read(folder.join(name)).ok();
        files.extend(table.map(|table| (name.to_owned(), table)));
    }
    let rest = history(folder).into_iter().map(|[rest, _]| rest.join(","));
    let rest: Vec<String> = rest.collect();
    files.insert("history.csv".to_owned(), rest.join("\n").into_bytes());
    let time = run.simulation().world.time();
    (files, ending, time)
}

/// The rows of `history.csv`: what is the same over ranks, and the energies.
fn history(folder: &Path) -> Vec<[Vec<String>; 2]> {
    let text = fs::read_to_string(folder.join("history.csv")).unwrap();
    let columns = HISTORY_COLUMNS.map(|column| column == "kinetic" || column == "energy_error");
    let ends: Vec<usize> = (0..36).filter(|k| columns[*k]).collect();
    let split = |line: &str| {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        let energies = fields.drain(ends[0]..=ends[1]).collect();
        [fields, energies]
    };
    text.lines().map(split).collect()
}

/// A rank's part of a run to its end, or so many steps, with what the first one has made.
fn on_rank(text: &str, folder: &Path, steps: u64, halo: &mut dyn Halo) -> Option<Run> {
    let mut run = (halo.rank() == 0).then(|| {
        let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
        run.advance(folder, 0).unwrap();
        run
    });
    let part = Part::share_out(run.as_mut(), halo).unwrap();
    finish(part, run, folder, steps, halo)
}

/// The same of a part and, on the first rank, its run; with a checkpoint at the end.
fn finish(
    mut part: Part,
    mut run: Option<Run>,
    folder: &Path,
    steps: u64,
    halo: &mut dyn Halo,
) -> Option<Run> {
    assert!(part.is_relaxing() || part.world().own_bodies(0).next().is_some());
    let mut ended = false;
    while !ended && part.steps() < steps {
        let may_end = part.step(halo).unwrap();
        let mut due = [run.as_ref().map_or(f64::INFINITY, Run::next_due)];
        halo.least(&mut due).unwrap();
        if may_end || part.world().time() >= due[0] {
            ended = part.go_on(run.as_mut(), folder, halo).unwrap();
        }
    }
    save(&mut part, run.as_mut(), folder, halo).unwrap();
    run
}

/// Writes a checkpoint.
pub fn save(
    part: &mut Part,
    mut run: Option<&mut Run>,
    folder: &Path,
    halo: &mut dyn Halo,
) -> std::result::Result<(), Error> {
    if let Some(run) = &mut run {
        run.flush(folder)?;
    }
    part.save(run, folder, &Usage::default(), halo)
}

pub fn alone(text: &str) -> Result {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    run.advance(folder.path(), u64::MAX).unwrap();
    result(&mut run, folder.path())
}

fn shared(text: &str, size: usize) -> Result {
    let folder = tempfile::tempdir().unwrap();
    let runs = Threads::each(size, |halo| on_rank(text, folder.path(), u64::MAX, halo));
    let mut run = runs.into_iter().flatten().next().unwrap();
    result(&mut run, folder.path())
}

/// A run over ranks that is stopped after so many steps, with a checkpoint.
pub fn stopped(text: &str, folder: &Path, steps: u64, size: usize) -> Run {
    let runs = Threads::each(size, |halo| on_rank(text, folder, steps, halo));
    runs.into_iter().flatten().next().unwrap()
}

/// The same to its end, on from its checkpoint, by so many ranks.
pub fn resumed(folder: &Path, size: usize) -> Run {
    let runs = Threads::each(size, |halo| {
        let (part, read) = Part::resume(folder, halo).unwrap();
        finish(part, read.map(|(run, _)| run), folder, u64::MAX, halo)
    });
    runs.into_iter().flatten().next().unwrap()
}

fn has_the_same_end(text: &str, ending: Ending) {
    let expected = alone(text);
    assert_eq!(expected.1, Some(ending));
    assert!(expected.0.len() > 4, "{} files", expected.0.len());
    for size in [2, 3] {
        assert!(shared(text, size) == expected, "{size} ranks");
    }
}

#[test]
fn a_run_over_ranks_ends_at_rest_where_it_does_alone() {
    has_the_same_end(
        &format!("rest = {{ energy = 1e-6, time = 0.02 }}\n{STONES}"),
        Ending::Rest,
    );
}

#[test]
fn a_run_over_ranks_ends_at_a_limit_where_it_does_alone() {
    let until =
        "until = [{ column = \"kinetic\", below = 1e-3, after = 0.1 }]\nhistory-every = 5e-3";
    has_the_same_end(&format!("{until}\n{STONES}"), Ending::Until);
}

/// Of a body, whose rank alone knows it.
#[test]
fn a_limit_of_a_body_holds_over_ranks() {
    let until = "until = [{ of = \"stone 28\", column = \"z\", below = 0.0995 }]";
    let text = STONES.replace("track = true", until);
    let (files, ending, _) = alone(&text);
    assert!(ending == Some(Ending::Until) && !files.contains_key("members.csv"));
    for size in [2, 3] {
        assert!(shared(&text, size).1 == ending, "{size} ranks");
    }
}

/// Energies are sums of what each rank has summed up, which differ by rounding.
#[test]
fn energies_over_ranks_are_those_alone() {
    let soft = STONES.replace("duration = 3", "duration = 0.1");
    for text in [format!("{soft}\n{RUBBER}"), BOND_ROW.to_owned()] {
        let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [one, three] = folders.each_ref().map(|folder| folder.path());
        let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        run.advance(one, u64::MAX).unwrap();
        stopped(&text, three, u64::MAX, 3);
        let [rows, others] = [one, three].map(history);
        assert_eq!(rows.len(), others.len());
        let rows = rows.into_iter().zip(others);
        let mut moving = 0;
        for ([_, own], [_, other]) in rows.skip(1) {
            let values =
                |row: Vec<String>| -> Vec<f64> { row.iter().map(|x| x.parse().unwrap()).collect() };
            let (own, other) = (values(own), values(other));
            let most = own.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            moving += usize::from(own[0] > 1e-6);
            for (a, b) in own.iter().zip(&other) {
                assert!((a - b).abs() <= 1e-12 * most, "{own:?} {other:?}");
            }
        }
        assert!(moving > 10, "{moving}");
    }
}

/// What ranks tell the first one, at a time.
struct Weighed<'a> {
    halo: &'a mut dyn Halo,
    most: usize,
}

impl Halo for Weighed<'_> {
    fn rank(&self) -> usize {
        self.halo.rank()
    }

    fn size(&self) -> usize {
        self.halo.size()
    }

    fn least(&mut self, values: &mut [f64]) -> std::result::Result<(), SolveError> {
        self.halo.least(values)
    }

    fn sum(&mut self, counts: &mut [u64]) -> std::result::Result<(), SolveError> {
        self.halo.sum(counts)
    }

    fn swap(
        &mut self,
        with: &[usize],
        messages: Vec<Vec<u8>>,
    ) -> std::result::Result<Vec<Vec<u8>>, SolveError> {
        self.halo.swap(with, messages)
    }

    fn send(
        &mut self,
        messages: Vec<(usize, Vec<u8>)>,
    ) -> std::result::Result<Vec<(usize, Vec<u8>)>, SolveError> {
        let bytes = messages.iter().map(|(_, bytes)| bytes.len());
        self.most = bytes.fold(self.most, usize::max);
        self.halo.send(messages)
    }
}

/// A row and a frame on the way take a fifth of what the whole does at most, which the end takes.
#[test]
fn rows_and_frames_take_no_whole() {
    let text = STONES.replace("duration = 3", "duration = 0.1");
    let folder = tempfile::tempdir().unwrap();
    let weights = Threads::each(2, |halo| {
        let mut run = (halo.rank() == 0).then(|| {
            let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
            run.advance(folder.path(), 0).unwrap();
            run
        });
        let mut part = Part::share_out(run.as_mut(), halo).unwrap();
        let mut show = |part: &mut Part, halo: &mut dyn Halo| {
            let mut weighed = Weighed { halo, most: 0 };
            let ended = part.go_on(run.as_mut(), folder.path(), &mut weighed);
            (ended.unwrap(), weighed.most)
        };
        let mut on_the_way = 0;
        while !part.step(halo).unwrap() {
            let (ended, most) = show(&mut part, halo);
            assert!(!ended);
            on_the_way = on_the_way.max(most);
        }
        let (ended, at_the_end) = show(&mut part, halo);
        assert!(ended && run.is_none_or(|run| run.frames().len() == 4));
        [on_the_way, at_the_end]
    });
    for [on_the_way, at_the_end] in weights {
        assert!(
            on_the_way > 0 && 5 * on_the_way < at_the_end,
            "{on_the_way} and {at_the_end} bytes"
        );
    }
}

/// A lid that presses, and a side that comes nearer.
#[test]
fn controlled_walls_go_on_over_ranks_from_a_checkpoint() {
    let control = "control = { x = { strain-rate = 0.4, sides = \"upper\" }, z = { stress = 2e3, speed = 0.3, sides = \"upper\" } }";
    let lidded = STONES.replace("open = true }", &format!("open = false }}\n{control}"));
    let text = lidded
        .replace("duration = 3", "duration = 0.16")
        .replace("0.15, 0.3]", "0.15, 0.125]");
    let expected = alone(&text);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    assert_eq!(stopped(&text, path, 150, 3).ending(), None);
    // By one world, whose controls are those of the ranks.
    let (mut run, _) = Run::read(path).unwrap();
    run.advance(path, u64::MAX).unwrap();
    assert!(result(&mut run, path) == expected);
    let simulation = run.simulation();
    let cells = simulation
        .controls
        .cells(&simulation.world, &mut Alone)
        .unwrap();
    assert!(
        cells[0].stress[2] > 1e3 && cells[0].strain[0] > 0.05,
        "{cells:?}"
    );
}

/// Stones that lie are pushed at a time, some more than others, so that they wake and slide.
#[test]
fn loads_over_ranks_are_those_alone() {
    let loads = r#"[[load]]
bodies = ["stone 3", "stone 9", "stone 10", "stone 22"]
force = [0, 0, 4]
table = [[0.2, 0], [0.22, 1], [0.3, 1], [0.34, 0]]
[[load]]
acceleration = [-3, 0, 0]
table = [[0.2, 0], [0.25, 1]]"#;
    let text = STONES.replace("duration = 3", "duration = 0.4");
    let unloaded = alone(&text);
    let text = format!("{text}\n{loads}");
    let expected = alone(&text);
    assert!(expected.0 != unloaded.0);
    for size in [2, 3] {
        assert!(shared(&text, size) == expected, "{size} ranks");
    }
}

/// Two blocks over the stones.
const RUBBER: &str = r#"[material.rubber]
density = 1200
law = "neo-hookean"
young = 1e6
poisson = 0.3
[[body]]
name = "rubber"
block = [1, 1, 1]
sides = [0.1, 0.1, 0.1]
material = "rubber"
behaviour = "deformable"
position = [0.11, 0.075, 0.2]
copies = { count = [2, 1, 1], spacing = [0.2, 0.1, 0.1] }"#;

/// Rubber between stones, which the first rank relaxes: from the end of the motion, and in a run that goes on in the relaxation.
#[test]
fn a_relaxation_over_ranks_is_that_alone() {
    let text = STONES.replace("duration = 3", "duration = 0.16");
    let text = format!("relax = {{ tolerance = 1e-9, steps = 5000 }}\n{text}\n{RUBBER}");
    let expected = alone(&text);
    assert_eq!(expected.1, Some(Ending::Time));
    for size in [2, 3] {
        assert!(shared(&text, size) == expected, "{size} ranks");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let first = stopped(&text, path, 4000, 2);
    let so_far = first.relaxation().map(|relaxed| relaxed.steps);
    assert!(
        first.ending().is_none() && so_far == Some(4000),
        "{so_far:?}"
    );
    assert!(result(&mut resumed(path, 3), path) == expected);
}

/// Stones on a floor that leans over, some of which are pushed, until a wall opens; others come between and behind them.
const FLOWING: &str = r#"
duration = 0.5
every = 0.05
history-every = 0.01
gravity = [4, 0, -9]

[contact]
friction = 0.3
damping = 0.5
penalty = 1e6

[material.stone]
density = 2500

[[wall]]
name = "floor"
plane = { normal = [0, 0, 1] }
[[wall]]
name = "back"
plane = { normal = [1, 0, 0] }
[[wall]]
name = "right"
plane = { normal = [0, 1, 0] }
[[wall]]
name = "left"
plane = { normal = [0, -1, 0], offset = -0.15 }
[[wall]]
name = "gate"
plane = { normal = [-1, 0, 0], offset = -0.43 }
opens = 0.12

[[body]]
name = "stone"
shape = "A10"
diameter = 0.05
material = "stone"
position = [0.03, 0.035, 0.03]
copies = { count = [7, 2, 2], spacing = [0.058, 0.07, 0.07], seed = 1 }

[[source]]
name = "rain"
shape = "cube"
diameter = 0.03
material = "stone"
lower = [0.04, 0.03, 0.12]
upper = [0.4, 0.12, 0.2]
velocity = [0, 0, -1]
rate = 60
number = 20
[[source]]
name = "row"
shape = "sphere"
diameter = 0.04
material = "stone"
places = [[0.05, 0.07, 0.2], [0.05, 0.07, 0.21], [0.2, 0.07, 0.25], [0.05, 0.07, 0.2]]
rate = 100
start = 0.3

[[load]]
bodies = ["rain", "stone 3"]
acceleration = [1, 0, 0]

[[gauge]]
name = "line"
plane = { normal = [-1, 0, 0], offset = -0.46 }
[[sink]]
name = "end"
plane = { normal = [-1, 0, 0], offset = -0.52 }
[[sink]]
name = "below"
plane = { normal = [0, 0, 1], offset = -0.5 }
"#;

/// Bodies get the numbers of those that have left; the run also goes on from a checkpoint on another number of ranks.
#[test]
fn what_flows_over_ranks_is_what_flows_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::new(Scenario::from_toml(FLOWING).unwrap()).unwrap();
    run.advance(folder.path(), u64::MAX).unwrap();
    let expected = result(&mut run, folder.path());
    let rows = expected.0["flow.csv"]
        .iter()
        .filter(|&&c| c == b'\n')
        .count();
    assert!(rows > 10, "{rows}");
    let members = &run.simulation().members;
    let left = members.iter().filter(|m| m.id == Member::GONE).count();
    assert!(
        left > 10 && members.len() > 40,
        "{left} of {}",
        members.len()
    );
    let last = members
        .iter()
        .map(|m| m.id)
        .filter(|id| *id != Member::GONE);
    assert!(last.max().unwrap() < members.len() as u32 - 5);
    for size in [1, 2, 3] {
        assert!(shared(FLOWING, size) == expected, "{size} ranks");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let half = run.simulation().world.steps() * 2 / 3;
    let first = stopped(FLOWING, path, half, 3);
    let mut so_far = first.simulation().members.iter();
    assert!(so_far.any(|m| m.id == Member::GONE));
    let mut last = resumed(path, 2);
    assert!(result(&mut last, path) == expected);
    assert_eq!(last.simulation().members, *members);
}

/// Blocks that break on a floor and on stones, under loads of which pieces bear their part, past a gauge.
const BREAKING: &str = r#"
duration = 6e-4
every = 1e-4
history-every = 2e-5

[contact]
friction = 0.4
damping = 0.2

[material.glass]
density = 2500
law = "neo-hookean"
young = 2e9
poisson = 0.2
[material.glass.fracture]
tensile = 5e6
cohesion = 2e7
friction-angle = 35
energy = [5, 25]
coarse = true
[material.stone]
density = 2500

[[wall]]
name = "trough"
material = "stone"
box = { lower = [0, 0, 0], upper = [0.2, 0.05, 0.2], open = true }

[[body]]
name = "block"
block = [2, 2, 2]
sides = [0.02, 0.02, 0.02]
material = "glass"
behaviour = "breakable"
position = [0.03, 0.025, 0.02]
velocity = [0, 0, -40]
copies = { count = [4, 1, 1], spacing = [0.03, 0.02, 0.02], seed = 1 }
[[body]]
name = "stone"
shape = "A10"
diameter = 0.02
material = "stone"
behaviour = "rigid"
position = [0.03, 0.025, 0.05]
velocity = [0, 0, -40]
copies = { count = [3, 1, 1], spacing = [0.035, 0.02, 0.02], seed = 3 }

[[load]]
bodies = ["block 1", "block 3"]
force = [200, 0, 0]
rise = 4e-4

[[gauge]]
name = "line"
plane = { normal = [0, 0, 1], offset = 0.012 }
"#;

/// Also on from a checkpoint amid the cracks, on another number of ranks.
#[test]
fn what_breaks_over_ranks_is_what_breaks_alone() {
    let folder = tempfile::tempdir().unwrap();
    let mut run = Run::new(Scenario::from_toml(BREAKING).unwrap()).unwrap();
    run.advance(folder.path(), u64::MAX).unwrap();
    let expected = result(&mut run, folder.path());
    let rows = |name: &str| expected.0[name].split(|&c| c == b'\n').count() - 2;
    let broken = TABLES.map(|name| expected.0[name].len());
    assert!(broken[0] > 1000 && rows(TABLES[1]) > 8 && rows(TABLES[2]) > 20);
    let passed = run.finish(folder.path(), &Usage::default()).unwrap().flow["line"].bodies;
    assert!(passed > 0, "{passed}");
    let members = &run.simulation().members;
    let pieces = members.iter().filter(|member| member.of.is_some()).count();
    assert!(pieces > 8, "{pieces}");
    let unloaded = BREAKING.replace("force = [200", "force = [0");
    assert!(alone(&unloaded) != expected);
    for size in [2, 3] {
        assert!(shared(BREAKING, size) == expected, "{size} ranks");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let half = run.simulation().world.steps() * 4 / 5;
    let first = stopped(BREAKING, path, half, 3);
    let so_far = first.simulation().members.len();
    assert!(so_far > 7 && so_far < members.len(), "{so_far}");
    let mut last = resumed(path, 2);
    assert!(result(&mut last, path) == expected);
    assert_eq!(last.simulation().members, *members);
}

/// A bonded row under a lid that keeps a pressure, between a driven block to which it is bonded and one that is pulled.
const BOND_ROW: &str = r#"
duration = 0.06
every = 0.01
gravity = [0, 0, -9]

[contact]
friction = 0.4
damping = 0.3
penalty = 1e7

[material.brick]
density = 2500

[[wall]]
name = "press"
box = { lower = [0, 0, 0], upper = [0.6, 0.05, 0.052] }
control = { z = { stress = 2e3, speed = 0.3, sides = "upper" } }

[[body]]
name = "end"
shape = "cube"
diameter = 0.08660254037844386
material = "brick"
position = [0.035, 0.025, 0.025]
motion = { shake = { stroke = [4e-4, 0, 0], frequency = 60, start = 0.02, periods = 2 } }
[[body]]
name = "block"
shape = "cube"
diameter = 0.08660254037844386
material = "brick"
position = [0.085, 0.025, 0.025]
copies = { count = [9, 1, 1], spacing = [0.05, 0.05, 0.05] }

[[load]]
bodies = ["block 9"]
force = [300, 0, 0]
rise = 0.05

[[bond]]
between = ["end", "block"]
gap = 1e-6
tensile = 5e4
cohesion = 1e5
energy = [4, 16]
stiffness = 1e9
damping = 0.2
[[bond]]
between = ["block", "block"]
gap = 1e-6
tensile = 5e4
cohesion = 1e5
energy = [4, 16]
stiffness = 1e9
damping = 0.2
"#;

#[test]
fn bonds_with_servos_drives_and_loads_over_ranks_are_those_alone() {
    let expected = alone(BOND_ROW);
    for part in ["[300", "[4e-4", "2e3, speed"] {
        let other = BOND_ROW.replace(part, &format!("{}1{}", &part[..1], &part[1..]));
        assert!(other != BOND_ROW && alone(&other) != expected, "{part}");
    }
    for size in [1, 2, 3, 4] {
        assert!(shared(BOND_ROW, size) == expected, "{size} ranks");
    }
}

#[test]
fn what_ranks_cannot_do_is_said() {
    let adaptive = r#"[material.plaster]
density = 1500
law = "neo-hookean"
young = 1e9
poisson = 0.2
[material.plaster.fracture]
tensile = 1e5
cohesion = 3e5
friction-angle = 30
energy = [10, 50]
[[body]]
name = "block"
block = [1, 1, 1]
sides = [0.05, 0.05, 0.05]
material = "plaster"
behaviour = "adaptive"
position = [0.1, 0.075, 0.25]"#;
    let text = format!("{STONES}\n{adaptive}");
    let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    let refused = Part::share_out(Some(&mut run), &mut Alone).err().unwrap();
    let refused = refused.to_string();
    assert!(refused.contains("near their strength"), "{refused}");
    // The run stays whole, and the others are told.
    let errors = Threads::each(2, |halo| {
        let new = || Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        let mut run = (halo.rank() == 0).then(new);
        let refused = Part::share_out(run.as_mut(), halo).err().unwrap();
        let world = run.as_ref().map(|run| &run.simulation().world);
        assert!(world.is_none_or(|world| world.body_count() == 29));
        refused.to_string()
    });
    assert!(
        errors[0].contains("near their strength") && errors[1].contains("the first rank gives")
    );
    let none = Part::share_out(None, &mut Alone).err().unwrap().to_string();
    assert!(none.contains("the first rank gives"), "{none}");
}
