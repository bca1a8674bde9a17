//! `cargo xtask python`: the wheel of the Python bindings, built and installed as a user would, its tests, its types and
//! examples.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::command::{cargo, passed};

/// The bindings, from the workspace root.
const BINDINGS: &str = "crates/femdem-python";

/// What the tests need from the index of Python packages. PyVista is left out: it is large.
const PACKAGES: [&str; 7] = [
    "maturin>=1.9,<2",
    "mypy",
    "numpy",
    "pytest",
    "trimesh",
    "meshio",
    "pandas",
];

/// Builds the wheel with the profile of the tests, installs it into an environment of its own, runs its tests, checks its
/// types and runs its examples; returns whether all passed.
///
/// # Errors
/// When there is no Python, the packages cannot be had or the wheel cannot be built.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let target = xtask::target_folder(root);
    let place = target.join("python");
    let environment = Environment::prepare(&place)?;
    environment.install(&build(root, &target, &environment)?)?;
    let bindings = root.join(BINDINGS);
    // From another folder, so that it is the installed package that is tested.
    let program = program(root, &target)?;
    let mut tests = environment.python();
    tests.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]);
    tests.arg(bindings.join("tests")).env("FEMDEM", program);
    let mut good = passed(tests.current_dir(&place))?;
    for types in [
        &["mypy", "--strict", "-p", "femdem"][..],
        &["mypy.stubtest", "femdem._femdem"],
    ] {
        let mut check = environment.python();
        good &= passed(check.arg("-m").args(types).current_dir(&place))?;
    }
    for example in files(&bindings.join("examples"), "py")? {
        println!("{}", example.display());
        good &= passed(environment.python().arg(&example).current_dir(&place))?;
    }
    Ok(good)
}

/// A virtual environment of Python.
struct Environment {
    folder: PathBuf,
    programs: PathBuf,
}

impl Environment {
    fn prepare(place: &Path) -> Result<Self> {
        let folder = place.join("environment");
        let programs = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
        let prepared = Self { folder, programs };
        if !prepared.program("pip").exists() {
            let mut make = Command::new("python3");
            make.args(["-m", "venv"]).arg(&prepared.folder);
            let hint = "install Python 3.10 or later with its module venv (python3-venv)";
            ensure!(passed(&mut make).context(hint)?, hint);
        }
        let mut pip = prepared.pip();
        ensure!(
            passed(pip.args(PACKAGES))?,
            "pip could not install {}: check the network",
            PACKAGES.join(", ")
        );
        Ok(prepared)
    }

    fn program(&self, name: &str) -> PathBuf {
        let name = format!("{name}{}", env::consts::EXE_SUFFIX);
        self.programs.join(name)
    }

    fn python(&self) -> Command {
        Command::new(self.program("python"))
    }

    fn pip(&self) -> Command {
        let mut pip = self.python();
        pip.args(["-m", "pip", "install", "--quiet"]);
        pip.arg("--disable-pip-version-check");
        pip
    }

    fn install(&self, wheel: &Path) -> Result<()> {
        let mut pip = self.pip();
        pip.args(["--force-reinstall", "--no-deps", "--no-index"]);
        ensure!(passed(pip.arg(wheel))?, "the wheel could not be installed");
        Ok(())
    }
}

/// Builds the wheel; returns its path.
fn build(root: &Path, target: &Path, environment: &Environment) -> Result<PathBuf> {
    let wheels = target.join("python").join("wheels");
    if wheels.is_dir() {
        fs::remove_dir_all(&wheels).context("cannot remove earlier wheels")?;
    }
    let mut maturin = Command::new(environment.program("maturin"));
    maturin.args(["build", "--profile", "dev", "--locked", "--quiet"]);
    maturin
        .arg("--interpreter")
        .arg(environment.program("python"));
    maturin.arg("--out").arg(&wheels);
    // It runs in another folder, from which a relative one would be another.
    maturin.env("CARGO_TARGET_DIR", target);
    ensure!(
        passed(maturin.current_dir(root.join(BINDINGS)))?,
        "the wheel was not built"
    );
    let mut found = files(&wheels, "whl")?;
    match (found.pop(), found.pop()) {
        (Some(wheel), None) => Ok(wheel),
        _ => bail!("there is not one wheel in {}", wheels.display()),
    }
}

/// The Rust program, whose results are compared.
fn program(root: &Path, target: &Path) -> Result<PathBuf> {
    let mut build = cargo();
    build.args(["build", "--locked", "--package", "femdem"]);
    let built = passed(build.current_dir(root))?;
    ensure!(built, "the program was not built");
    let name = format!("femdem{}", env::consts::EXE_SUFFIX);
    Ok(target.join("debug").join(name))
}

/// The files of a folder with an ending, sorted.
fn files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let shown = folder.display();
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| format!("cannot read {shown}"))? {
        let path = entry?.path();
        if path.extension().is_some_and(|own| own == ending) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}
