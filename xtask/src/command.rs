//! Programs that chores run.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

/// Runs a command without standard input; returns whether it ended well.
pub(crate) fn passed(command: &mut Command) -> Result<bool> {
    let name = command.get_program().to_string_lossy().into_owned();
    let status = command.stdin(Stdio::null()).status();
    let status = status.with_context(|| format!("cannot start {name}"))?;
    Ok(status.success())
}

/// Whether a program is there and ends well, whatever it prints.
pub(crate) fn runs(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Tries to install packages of Debian and its kin; returns whether it could.
pub(crate) fn apt_get(packages: &[&str]) -> bool {
    println!("trying to install with apt-get: {}", packages.join(" "));
    let install = [&["install", "-qq", "-y"], packages].concat();
    runs("apt-get", &["update", "-qq"]) && runs("apt-get", &install)
}

/// Cargo, as it was started.
pub(crate) fn cargo() -> Command {
    let cargo = std::env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from);
    Command::new(cargo)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_is_not_there_does_not_run() {
        assert!(!runs("no-such-program-of-any-kind", &[]));
        assert!(runs("cargo", &["--version"]));
    }
}
