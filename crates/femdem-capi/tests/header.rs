//! The committed header is that of the sources, and the Fortran module has all that it has.

use std::fs;
use std::path::{Path, PathBuf};

/// The sources, in the order in which the header has them.
const SOURCES: [&str; 20] = [
    "lib.rs",
    "border.rs",
    "handles.rs",
    "plain.rs",
    "law.rs",
    "shape.rs",
    "pair.rs",
    "wall.rs",
    "batch/build.rs",
    "batch/update.rs",
    "batch/query.rs",
    "batch/mod.rs",
    "world/parameters.rs",
    "world/build.rs",
    "world/drive.rs",
    "world/hand.rs",
    "world/step.rs",
    "world/query.rs",
    "world/files.rs",
    "world/mod.rs",
];

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn header() -> String {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).unwrap();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(folder().join("src").join(source));
    }
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

/// With WRITE_DOCS set it is written.
#[test]
fn the_header_is_that_of_the_sources() {
    let path: PathBuf = folder().join("include").join("femdem.h");
    let wanted = header();
    if std::env::var_os("WRITE_DOCS").is_some() {
        fs::write(&path, &wanted).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == wanted,
        "include/femdem.h is stale: WRITE_DOCS=1 cargo test -p femdem-capi --test all header"
    );
}
