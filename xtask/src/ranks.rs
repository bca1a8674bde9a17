//! `cargo xtask ranks`: the program over MPI, whose results must not depend on the number of ranks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::command::{apt_get, cargo, passed, runs};

/// The package, from the workspace root: a workspace of its own.
const PACKAGE: &str = "crates/femdem-mpi";

/// The scenes, in the package: of rigid bodies, of deformable ones among rigid ones that are relaxed, of walls and a cell that follow
/// stresses, of bodies that come and go, of bonded ones, and of some that break.
const SCENE: &str = "scenes/pile.toml";
const SOFT_SCENE: &str = "scenes/soft.toml";
const PRESS: &str = "scenes/press.toml";
const CELL: &str = "scenes/cell.toml";
const FLOW: &str = "scenes/flow.toml";
const BONDED: &str = "scenes/bonded.toml";
const CRACKED: &str = "scenes/crack.toml";

/// What is needed, as a program and as the packages of Debian that have it.
const TOOLS: [(&str, &[&str]); 2] = [
    ("mpirun", &["openmpi-bin"]),
    ("mpicc", &["libopenmpi-dev", "libclang-dev"]),
];

/// Ranks, and threads of each.
const RUNS: [[usize; 2]; 6] = [[1, 1], [2, 1], [3, 1], [4, 1], [1, 2], [2, 2]];

const SOFT_RUNS: [[usize; 2]; 3] = [[1, 1], [2, 1], [4, 1]];

const OTHER_RUNS: [[usize; 2]; 2] = [[2, 1], [3, 1]];

/// Tables of the end of a run where bodies may break.
const TABLES: [&str; 3] = ["cracks.vtp", "fragments.csv", "events.csv"];

/// Steps after which one run is stopped, to go on with another number of ranks.
const STOP: &str = "600";
const SOFT_STOP: &str = "200";
const CRACKED_STOP: &str = "250";

/// Options of the pack, which is relaxed on the way and at its end.
const PACK: [&str; 8] = [
    "--shape", "A10", "--shape", "cube", "--count", "150", "--box", "5x4",
];

/// Ranks that make the pack, one thread each.
const PACKS: [usize; 3] = [1, 2, 4];

/// Steps after which a pack is stopped, to go on with another number of ranks, or by one process.
const STOP_PACK: &str = "4000";

/// Files of a pack that tell how it was made.
const HOW: [&str; 2] = ["scene.toml", "pack.ckpt"];

/// Entries of its summary that tell of costs, and of energies, which are sums of those of the ranks.
const COSTS_AND_BOOKS: [&str; 11] = [
    "threads",
    "wall_seconds",
    "cpu_seconds",
    "contact_nanoseconds_per_pair",
    "peak_memory_bytes",
    "state_hash",
    "initial",
    "final",
    "dissipated_friction",
    "dissipated_damping",
    "ledger_error_relative",
];

/// Builds the program, and compares every file of the frames of its runs, their tables of cracks, and every file of its packs, with
/// those of `femdem`; returns whether all are the same.
///
/// # Errors
/// When it cannot be built, or MPI is missing and cannot be installed.
pub(crate) fn run(root: &Path) -> Result<bool> {
    find_tools()?;
    let manifest = format!("{PACKAGE}/Cargo.toml");
    let built = |arguments: &[&str]| -> Result<bool> {
        let mut command = cargo();
        command.args(arguments).current_dir(root);
        passed(command.env("CARGO_TARGET_DIR", xtask::target_folder(root)))
    };
    let lints = [
        "clippy",
        "--locked",
        "--all-targets",
        "--manifest-path",
        &manifest,
    ];
    ensure!(
        built(&[&lints[..], &["--", "-D", "warnings"]].concat())?
            && built(&["build", "--locked", "--manifest-path", &manifest])?
            && built(&["build", "--locked", "-p", "femdem"])?,
        "the program was not built"
    );
    let programs = xtask::target_folder(root).join("debug");
    let place = xtask::target_folder(root).join("ranks");
    if place.exists() {
        fs::remove_dir_all(&place)?;
    }
    fs::create_dir_all(&place)?;
    let runs = |scene, runs: &[[usize; 2]], stop, place| {
        runs_are_same(
            &root.join(PACKAGE).join(scene),
            runs,
            stop,
            &programs,
            place,
        )
    };
    Ok(runs(SCENE, &RUNS, STOP, &place.join("rigid"))?
        & runs(SOFT_SCENE, &SOFT_RUNS, SOFT_STOP, &place.join("soft"))?
        & runs(PRESS, &OTHER_RUNS, STOP, &place.join("press"))?
        & runs(CELL, &OTHER_RUNS, STOP, &place.join("cell"))?
        & runs(FLOW, &OTHER_RUNS, STOP, &place.join("flow"))?
        & runs(BONDED, &OTHER_RUNS, STOP, &place.join("bonded"))?
        & runs(CRACKED, &SOFT_RUNS, CRACKED_STOP, &place.join("cracked"))?
        & packs_are_same(&programs, &place)?)
}

/// Runs a scene over ranks and threads, and once more with a stop after so many steps.
fn runs_are_same(
    scene: &Path,
    runs: &[[usize; 2]],
    stop: &str,
    programs: &Path,
    place: &Path,
) -> Result<bool> {
    let alone = place.join("alone");
    let mut femdem = Command::new(programs.join("femdem"));
    femdem.arg("run").arg(scene).arg("--out").arg(&alone);
    ensure!(passed(femdem.arg("--quiet"))?, "femdem run has failed");

    let mpi = programs.join("femdem-mpi");
    let mut good = true;
    for &[ranks, threads] in runs {
        println!("{ranks} ranks of {threads} threads");
        let out = place.join(format!("{ranks}-{threads}"));
        let mut command = over(ranks, &mpi);
        command.arg("run").arg(scene).arg("--out").arg(&out);
        command.args(["--threads", &threads.to_string()]);
        good &= passed(&mut command)? && are_same_runs(&alone, &out)?;
    }
    let out = place.join("restart");
    let mut command = over(4, &mpi);
    command.arg("run").arg(scene).arg("--out").arg(&out);
    good &= passed(command.args(["--steps", stop]))?;
    good &= passed(over(3, &mpi).arg("resume").arg(&out))? && are_same_runs(&alone, &out)?;
    Ok(good)
}

fn packs_are_same(programs: &Path, place: &Path) -> Result<bool> {
    let alone = place.join("pack");
    let mut femdem = Command::new(programs.join("femdem"));
    femdem.arg("pack").args(PACK).arg("--out").arg(&alone);
    ensure!(passed(femdem.arg("--quiet"))?, "femdem pack has failed");
    let mpi = programs.join("femdem-mpi");
    let pack = |ranks: usize, steps: &[&str], out: &Path| {
        let mut command = over(ranks, &mpi);
        command.arg("pack").args(steps).args(PACK);
        passed(command.arg("--out").arg(out))
    };
    let mut good = true;
    for ranks in PACKS {
        println!("a pack on {ranks} ranks");
        let out = place.join(format!("pack-{ranks}"));
        good &= pack(ranks, &[], &out)? && same(&alone, &out, "")?;
    }
    let resume = |ranks: usize, out: &Path| {
        let mut command = over(ranks, &mpi);
        command.arg("resume").arg(out);
        command
    };
    let out = place.join("pack-restart");
    good &= pack(3, &["--steps", STOP_PACK], &out)?;
    good &= passed(&mut resume(2, &out))? && same(&alone, &out, "")?;

    let out = place.join("pack-in-parts");
    good &= pack(4, &["--steps", STOP_PACK], &out)?;
    good &= passed(resume(3, &out).args(["--steps", STOP_PACK]))?;
    let parts = fs::read_dir(out.join("parts")).context("there are no parts of the pack")?;
    good &= parts.count() == 2;
    let mut femdem = Command::new(programs.join("femdem"));
    femdem.arg("resume").arg(&out).arg("--quiet");
    good &= passed(&mut femdem)? && same(&alone, &out, "")?;
    Ok(good)
}

fn find_tools() -> Result<()> {
    let absent = || TOOLS.iter().filter(|(tool, _)| !runs(tool, &["--version"]));
    let packages: Vec<&str> = absent().flat_map(|(_, of)| of.iter().copied()).collect();
    if packages.is_empty() || (apt_get(&packages) && absent().next().is_none()) {
        return Ok(());
    }
    bail!("ranks need {}", packages.join(", "))
}

/// The program over ranks. Open MPI starts more of them than there are cores, and for root, where it is told so.
fn over(ranks: usize, program: &Path) -> Command {
    let mut command = Command::new("mpirun");
    command
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .args(["--oversubscribe", "-n", &ranks.to_string()])
        .arg(program);
    command
}

/// Whether two runs have the same frames, and the same tables if any.
fn are_same_runs(a: &Path, b: &Path) -> Result<bool> {
    let mut good = same(a, b, "frames")?;
    for name in TABLES {
        let [own, other] = [a, b].map(|run| fs::read(run.join(name)).ok());
        if own != other {
            println!("{name} differs in {}", b.display());
        }
        good &= own == other;
    }
    Ok(good)
}

/// Whether two runs or packs have the same files within a folder, to the last byte.
fn same(a: &Path, b: &Path, within: &str) -> Result<bool> {
    let mut folders = vec![PathBuf::from(within)];
    let (mut good, mut count) = (true, 0);
    while let Some(folder) = folders.pop() {
        let here = a.join(&folder);
        let entries = fs::read_dir(&here).with_context(|| here.display().to_string())?;
        for entry in entries {
            let entry = entry?;
            let name = folder.join(entry.file_name());
            if entry.file_type()?.is_dir() {
                folders.push(name);
                continue;
            }
            if HOW.iter().any(|how| name == Path::new(how)) {
                continue;
            }
            count += 1;
            let [own, other] = [a, b].map(|run| fs::read(run.join(&name)).ok());
            let equal = match &*name.to_string_lossy() {
                "summary.json" => {
                    own.map(|text| results(&text)) == other.map(|text| results(&text))
                }
                _ => own == other,
            };
            if !equal {
                println!("{} differs in {}", name.display(), b.display());
            }
            good &= equal;
        }
    }
    Ok(good && count > 0)
}

/// The lines of a summary that tell of results.
fn results(summary: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(summary);
    let tells = |line: &&str| {
        let key = line.trim().split('"').nth(1).unwrap_or_default();
        !COSTS_AND_BOOKS.contains(&key)
    };
    text.lines().filter(tells).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_differ_or_are_not_there_are_noticed() {
        let folder = std::env::temp_dir().join(format!("femdem-ranks-{}", std::process::id()));
        let [a, b] = ["a", "b"].map(|name| folder.join(name));
        let summary = |seconds: u32, settled: bool| {
            format!("{{\n  \"wall_seconds\": {seconds},\n  \"settled\": {settled}\n}}\n")
        };
        for (run, text) in [(&a, "1"), (&b, "2")] {
            fs::create_dir_all(run.join("frames/0")).unwrap();
            fs::write(run.join("frames/0/x"), text).unwrap();
        }
        assert!(same(&a, &a, "frames").unwrap() && !same(&a, &b, "frames").unwrap());
        assert!(are_same_runs(&a, &a).unwrap() && !are_same_runs(&a, &b).unwrap());
        fs::remove_file(b.join("frames/0/x")).unwrap();
        assert!(!same(&a, &b, "frames").unwrap());
        fs::write(b.join("frames/0/x"), "1").unwrap();
        assert!(are_same_runs(&a, &b).unwrap());
        fs::write(a.join(TABLES[0]), "cracks").unwrap();
        assert!(!are_same_runs(&a, &b).unwrap());
        fs::remove_file(a.join(TABLES[0])).unwrap();
        fs::write(a.join("summary.json"), summary(1, true)).unwrap();
        fs::write(b.join("summary.json"), summary(2, true)).unwrap();
        assert!(same(&a, &b, "").unwrap());
        fs::write(b.join("summary.json"), summary(1, false)).unwrap();
        assert!(!same(&a, &b, "").unwrap());
        fs::remove_dir_all(&folder).unwrap();
    }
}
