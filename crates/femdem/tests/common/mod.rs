//! Shared by the tests of the program.

#![allow(dead_code, reason = "every test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Scene;
use femdem::pack::Packing;
use std::path::Path;
use std::process::{Child, Command, Output};

/// A pack that settles within a second: few bodies, soft contacts.
pub const TINY: [&str; 12] = [
    "--shape",
    "P5",
    "--count",
    "8",
    "--box",
    "3x3",
    "--penetration",
    "0.02",
    "--seed",
    "3",
    "--threads",
    "2",
];

/// A wedge: convex, closed, 0.2 m long.
pub const WEDGE: &str = "\
v 0 0 0\nv 0.1 0 0\nv 0.1 0.2 0\nv 0 0.2 0\nv 0 0 0.1\nv 0 0.2 0.1\n\
f 1 4 3 2\nf 1 2 5\nf 4 6 3\nf 2 3 6 5\nf 1 5 6 4\n";

/// A few bodies at rest.
pub fn pack(shape: &str, count: u32) -> Packing {
    let scene = Scene {
        shape: vec![shape.to_owned()],
        count,
        ..Scene::default()
    };
    let mut packing = Packing::new(scene.spec().unwrap()).unwrap();
    packing.run().unwrap();
    packing
}

/// A call of the program.
pub fn femdem(subcommand: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_femdem"));
    command.arg(subcommand);
    command
}

/// Runs to the end.
pub fn run(command: &mut Command) -> Output {
    command.output().unwrap()
}

pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Runs a command that must fail with these words in its message. Returns the message.
pub fn fails(command: &mut Command, words: &[&str]) -> String {
    let output = run(command);
    let message = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(
        matches!(output.status.code(), Some(1 | 2)),
        "{command:?}: {:?}",
        output.status
    );
    assert!(!message.contains("panicked"), "{message}");
    for word in words {
        assert!(
            message.contains(word),
            "{command:?}: {word:?} is not in: {message}"
        );
    }
    message
}

pub fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

/// Ctrl-C.
#[cfg(unix)]
pub fn interrupt(child: &Child) {
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}
