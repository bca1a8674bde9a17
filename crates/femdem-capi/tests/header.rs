//! The committed header is that of the sources.

use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn header() -> String {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).unwrap();
    let sources = folder().join("src").join("lib.rs");
    let builder = cbindgen::Builder::new().with_config(config);
    let mut text = Vec::new();
    builder
        .with_src(sources)
        .generate()
        .unwrap()
        .write(&mut text);
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
        "include/femdem.h is stale: WRITE_DOCS=1 cargo test -p femdem-capi --test all"
    );
}
