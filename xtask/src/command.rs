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
    let user = Command::new("id").arg("-u").output();
    let is_root = user.is_ok_and(|user| user.stdout.trim_ascii() == b"0");
    let apt_get = |arguments: &[&str]| {
        let command = ["DEBIAN_FRONTEND=noninteractive", "apt-get"];
        if is_root {
            runs("env", &[&command, arguments].concat())
        } else {
            runs("sudo", &[&["-n", "env"], &command, arguments].concat())
        }
    };
    apt_get(&["update", "-qq"]) && apt_get(&[&["install", "-qq", "-y"], packages].concat())
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
