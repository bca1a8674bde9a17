//! `cargo xtask python`: the tests, types and examples of the Python bindings, from what the tests of the workspace have built;
//! with `--wheel` from the wheel, built and installed as a user would.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::command::{cargo, passed};

/// The bindings, from the workspace root.
const BINDINGS: &str = "crates/femdem-python";

/// Builds the compiled half and the program. An example among the targets makes cargo choose the features that it chooses for the
/// tests, so that after these little is left to build.
const BUILD: &str =
    "build --workspace --all-features --lib --bin femdem --example embed_kernel --locked";

/// Builds the program with the features that its libraries have in the wheel, so that after that little is left to build.
const BUILD_BESIDE_WHEEL: &str =
    "build --package femdem --package femdem-python --bin femdem --locked";

/// What the tests need from the index of Python packages. PyVista is left out: it is large.
const PACKAGES: [&str; 6] = ["mypy", "numpy", "pytest", "trimesh", "meshio", "pandas"];

/// What only one example needs, which is left out where it cannot be had.
const ENGINE: &str = "mujoco";
const OF_ENGINE: &str = "mujoco_host";

/// Runs the tests with the library of the dev profile, checks the types, and runs the examples; returns whether all passed.
///
/// # Errors
/// When there is no Python, the packages cannot be had or the library cannot be built.
pub(crate) fn run(root: &Path) -> Result<bool> {
    let target = xtask::target_folder(root);
    let place = target.join("python");
    let environment = Environment::prepare(&place)?;
    let program = program(root, &target, BUILD)?;
    let package = package(root, &target, &place)?;
    check(root, &place, &environment, &program, Some(&package))
}

/// The same with a wheel, which is built with the profile of the tests.
///
/// # Errors
/// As [`run`], and when the wheel cannot be built.
pub(crate) fn wheel(root: &Path) -> Result<bool> {
    let target = xtask::target_folder(root);
    let place = target.join("python");
    let environment = Environment::prepare(&place)?;
    environment.install(&build(root, &target, &environment)?)?;
    let program = program(root, &target, BUILD_BESIDE_WHEEL)?;
    let good = check(root, &place, &environment, &program, None)?;
    environment.uninstall()?;
    Ok(good)
}

/// Tests, types and examples, with the package in a folder, or the installed one.
fn check(
    root: &Path,
    place: &Path,
    environment: &Environment,
    program: &Path,
    package: Option<&Path>,
) -> Result<bool> {
    let bindings = root.join(BINDINGS);
    // From another folder, so that the package is not that of the sources.
    let python = || {
        let mut python = environment.python();
        if let Some(package) = package {
            python.env("PYTHONPATH", package).env("MYPYPATH", package);
        }
        python.current_dir(place);
        python
    };
    let mut tests = python();
    tests.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]);
    tests.arg(bindings.join("tests")).env("FEMDEM", program);
    let mut good = passed(&mut tests)?;
    for types in [
        &["mypy", "--strict", "-p", "femdem"][..],
        &["mypy.stubtest", "femdem._femdem"],
    ] {
        good &= passed(python().arg("-m").args(types))?;
    }
    let has_engine = environment.has_engine()?;
    for example in files(&bindings.join("examples"), "py")? {
        let needs_engine = example.file_stem().is_some_and(|stem| stem == OF_ENGINE);
        if needs_engine && !has_engine {
            println!(
                "left out, as pip cannot install {ENGINE}: {}",
                example.display()
            );
            continue;
        }
        println!("{}", example.display());
        let mut run = python();
        run.arg(&example);
        if needs_engine {
            // Fewer bodies than by default.
            run.arg("90");
        }
        good &= passed(&mut run)?;
    }
    Ok(good)
}

/// The sources of the package and its compiled half in one folder; returns that above it.
fn package(root: &Path, target: &Path, place: &Path) -> Result<PathBuf> {
    let sources = root.join(BINDINGS).join("python").join("femdem");
    let above = place.join("package");
    let package = above.join("femdem");
    if above.is_dir() {
        fs::remove_dir_all(&above).context("cannot remove an earlier package")?;
    }
    fs::create_dir_all(&package).context("cannot make the folder of the package")?;
    let mut copied = files(&sources, "py")?;
    copied.extend(files(&sources, "pyi")?);
    copied.extend(files(&sources, "typed")?);
    for path in copied {
        copy(&path, &package.join(path.file_name().unwrap_or_default()))?;
    }
    let (made, wanted) = match env::consts::OS {
        "windows" => ("_femdem.dll", "_femdem.pyd"),
        "macos" => ("lib_femdem.dylib", "_femdem.abi3.so"),
        _ => ("lib_femdem.so", "_femdem.abi3.so"),
    };
    copy(&target.join("debug").join(made), &package.join(wanted))?;
    Ok(above)
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let copied = fs::copy(from, to).with_context(|| format!("cannot copy {}", from.display()));
    copied.map(|_| ())
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
        prepared.need(&PACKAGES)?;
        Ok(prepared)
    }

    fn program(&self, name: &str) -> PathBuf {
        let name = format!("{name}{}", env::consts::EXE_SUFFIX);
        self.programs.join(name)
    }

    fn python(&self) -> Command {
        Command::new(self.program("python"))
    }

    fn pip(&self, command: &str) -> Command {
        let mut pip = self.python();
        pip.args(["-m", "pip", command, "--quiet"]);
        pip.arg("--disable-pip-version-check");
        pip
    }

    fn need(&self, packages: &[&str]) -> Result<()> {
        let installed = passed(self.pip("install").args(packages))?;
        let packages = packages.join(", ");
        ensure!(
            installed,
            "pip could not install {packages}: check the network"
        );
        Ok(())
    }

    /// Whether the other engine is there, or can be had.
    fn has_engine(&self) -> Result<bool> {
        passed(self.pip("install").arg(ENGINE))
    }

    fn install(&self, wheel: &Path) -> Result<()> {
        let mut pip = self.pip("install");
        pip.args(["--force-reinstall", "--no-deps", "--no-index"]);
        ensure!(passed(pip.arg(wheel))?, "the wheel could not be installed");
        Ok(())
    }

    /// Takes the wheel out again, so that nothing but the package of the tests can be imported.
    fn uninstall(&self) -> Result<()> {
        let gone = passed(self.pip("uninstall").args(["--yes", "femdem"]))?;
        ensure!(gone, "the wheel could not be uninstalled");
        Ok(())
    }
}

/// Builds the wheel; returns its path.
fn build(root: &Path, target: &Path, environment: &Environment) -> Result<PathBuf> {
    environment.need(&["maturin>=1.9,<2"])?;
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

/// Builds the program, whose results are compared, and what else is asked for; returns its path.
fn program(root: &Path, target: &Path, arguments: &str) -> Result<PathBuf> {
    let mut build = cargo();
    build.args(arguments.split_whitespace()).current_dir(root);
    ensure!(passed(&mut build)?, "the program was not built");
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
