//! `cargo xtask capi`: the C bindings, built and installed as a user would, and their examples in C, C++ and Fortran.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::command::{apt_get, cargo, passed, runs};

/// The bindings, from the workspace root.
const BINDINGS: &str = "crates/femdem-capi";

/// What is needed, as a program and as the package of Debian that has it.
const TOOLS: [(&str, &str); 5] = [
    ("c++", "g++"),
    ("cmake", "cmake"),
    ("gfortran", "gfortran"),
    ("pkg-config", "pkg-config"),
    ("valgrind", "valgrind"),
];

/// The headers, and the module of Fortran.
const HEADERS: [&str; 3] = ["femdem.h", "femdem.hpp", "femdem.f90"];

/// The examples, which end well if their numbers are right.
const EXAMPLES: [&str; 4] = ["smallest", "smallest_static", "host", "fall"];

/// What the static library needs of the system, as the compiler states it.
const SYSTEM: &str = "-lgcc_s -lutil -lrt -lpthread -lm -ldl -lc";

/// With a `prefix` builds the libraries for use and installs them there. Else builds them with the profile of the tests, and runs
/// the examples with them, one of them under valgrind, which must find nothing; returns whether all passed.
///
/// # Errors
/// When the libraries cannot be built, or a tool is missing and cannot be installed.
pub(crate) fn run(root: &Path, prefix: Option<&Path>) -> Result<bool> {
    ensure!(
        cfg!(target_os = "linux"),
        "the libraries are named as on Linux; elsewhere take those of `cargo rustc -p femdem-capi --crate-type cdylib`"
    );
    if let Some(prefix) = prefix {
        install(root, prefix, "release")?;
        println!("installed into {}", prefix.display());
        return Ok(true);
    }
    find_tools()?;
    let place = xtask::target_folder(root).join("capi");
    install(root, &place, "dev")?;
    let programs = build_examples(root, &place)?;
    let mut good = true;
    for example in EXAMPLES {
        println!("{example}");
        good &= passed(&mut Command::new(programs.join(example)))?;
    }
    println!("host, under valgrind");
    good &= passed(&mut valgrind(root, &programs.join("host")))?;
    Ok(good)
}

/// Installs what is missing, or says what it is.
fn find_tools() -> Result<()> {
    let missing = || {
        let absent = |(program, _): &&(&str, &str)| !runs(program, &["--version"]);
        let absent = TOOLS.iter().filter(absent);
        absent.map(|(_, package)| *package).collect::<Vec<_>>()
    };
    let packages = missing();
    if packages.is_empty() || (apt_get(&packages) && missing().is_empty()) {
        return Ok(());
    }
    anyhow::bail!(
        "the examples of the C bindings need {}",
        missing().join(", ")
    )
}

/// Builds the libraries with a profile, and puts them below `prefix` with their headers and `femdem.pc`.
fn install(root: &Path, prefix: &Path, profile: &str) -> Result<()> {
    let bindings = root.join(BINDINGS);
    let header = fs::read_to_string(bindings.join("include").join("femdem.h"))?;
    let soname = format!("libfemdem.so.{}", interface(&header)?);
    let mut build = cargo();
    build.args(["rustc", "--locked", "--package", "femdem-capi", "--lib"]);
    build.args([
        "--profile",
        profile,
        "--crate-type",
        "cdylib,staticlib",
        "--",
    ]);
    build
        .arg("-C")
        .arg(format!("link-arg=-Wl,-soname,{soname}"));
    ensure!(
        passed(build.current_dir(root))?,
        "the libraries were not built"
    );
    let folder = if profile == "dev" { "debug" } else { profile };
    let built = xtask::target_folder(root).join(folder);

    let (include, lib) = (prefix.join("include"), prefix.join("lib"));
    let package = lib.join("pkgconfig");
    for folder in [&include, &package] {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    for header in HEADERS {
        copy(
            &bindings.join("include").join(header),
            &include.join(header),
        )?;
    }
    copy(&built.join("libfemdem_capi.a"), &lib.join("libfemdem.a"))?;
    copy(&built.join("libfemdem_capi.so"), &lib.join(&soname))?;
    let link = lib.join("libfemdem.so");
    // A link that leads nowhere does not exist.
    if link.is_symlink() || link.exists() {
        fs::remove_file(&link)?;
    }
    #[cfg(unix)]
    std::os::unix::fs::symlink(&soname, &link)?;
    fs::write(package.join("femdem.pc"), description())?;
    Ok(())
}

/// The number of the interface, which is in the name of the shared library.
fn interface(header: &str) -> Result<&str> {
    let mut lines = header.lines();
    let number = lines.find_map(|line| line.strip_prefix("#define FEMDEM_ABI_VERSION "));
    number.context("femdem.h does not define FEMDEM_ABI_VERSION")
}

/// The file of pkg-config. It finds the folder that it is in, so that the whole can be moved.
fn description() -> String {
    format!(
        "prefix=${{pcfiledir}}/../..\nincludedir=${{prefix}}/include\nlibdir=${{prefix}}/lib\n\n\
         Name: femdem\nDescription: Contacts and motion of bodies of any shape\nVersion: {}\n\
         Cflags: -I${{includedir}}\nLibs: -L${{libdir}} -lfemdem\nLibs.private: {SYSTEM}\n",
        env!("CARGO_PKG_VERSION")
    )
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    // A program that runs keeps the library that it has.
    if to.exists() {
        fs::remove_file(to).with_context(|| format!("cannot replace {}", to.display()))?;
    }
    let copied = fs::copy(from, to);
    copied.with_context(|| format!("cannot copy {} to {}", from.display(), to.display()))?;
    Ok(())
}

/// Builds the examples with what is installed in `place`; returns the folder of the programs.
fn build_examples(root: &Path, place: &Path) -> Result<PathBuf> {
    let programs = place.join("examples");
    let mut configure = Command::new("cmake");
    configure
        .arg("-S")
        .arg(root.join(BINDINGS).join("examples"));
    configure.arg("-B").arg(&programs);
    configure.env("PKG_CONFIG_PATH", place.join("lib").join("pkgconfig"));
    let mut build = Command::new("cmake");
    build.arg("--build").arg(&programs);
    let built = passed(&mut configure)? && passed(&mut build)?;
    ensure!(built, "the examples were not built");
    Ok(programs)
}

/// Memory that is misused or lost is an error.
fn valgrind(root: &Path, program: &Path) -> Command {
    let mut command = Command::new("valgrind");
    command.args(["--quiet", "--error-exitcode=9", "--leak-check=full"]);
    command.arg("--errors-for-leak-kinds=definite,indirect,possible");
    let known = root.join(BINDINGS).join("examples").join("valgrind.supp");
    command.arg(format!("--suppressions={}", known.display()));
    command.arg(program);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interface_is_that_of_the_header() {
        assert_eq!(
            interface("#include <x.h>\n#define FEMDEM_ABI_VERSION 7\n").unwrap(),
            "7"
        );
        assert!(interface("#define FEMDEM_H\n").is_err());
    }

    #[test]
    fn the_description_names_no_folder_of_this_machine() {
        let text = description();
        assert!(text.starts_with("prefix=${pcfiledir}/../..\n"));
        assert!(text.contains("\nLibs: -L${libdir} -lfemdem\n"));
    }
}
