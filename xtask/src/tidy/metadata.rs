//! The packages of the workspace, as cargo sees them.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// Data of one package that the checkers need.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Package {
    pub(crate) name: String,
    /// Path of `Cargo.toml` from the workspace root.
    pub(crate) manifest: String,
    /// Whether commands of cargo are for it when no package is named.
    pub(crate) is_default: bool,
    pub(crate) has_license: bool,
    pub(crate) has_features: bool,
    /// Root files of the library and program targets, from the workspace root.
    pub(crate) roots: Vec<TargetRoot>,
    /// Normal (not dev, not build) dependencies that are workspace packages.
    pub(crate) dependencies: BTreeSet<String>,
}

/// The root file of a library or a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TargetRoot {
    pub(crate) path: String,
    pub(crate) is_library: bool,
}

/// Asks `cargo metadata` for the packages of the workspace at `root`, sorted by name.
pub(crate) fn packages(root: &Path) -> Result<Vec<Package>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .current_dir(root)
        .output()
        .context("cannot start `cargo metadata`")?;
    if !output.status.success() {
        bail!(
            "`cargo metadata` failed: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        );
    }
    let json = String::from_utf8(output.stdout).context("`cargo metadata` is not UTF-8")?;
    parse(&json)
}

/// Reads the answer of `cargo metadata --no-deps --format-version 1`.
fn parse(json: &str) -> Result<Vec<Package>> {
    let document: Value = serde_json::from_str(json).context("`cargo metadata` is not JSON")?;
    let root = text(&document, "workspace_root")?;
    let entries = list(&document, "packages")?;
    let names = entries
        .iter()
        .map(|entry| text(entry, "name"))
        .collect::<Result<BTreeSet<_>>>()?;
    let defaults = list(&document, "workspace_default_members")?;
    let mut packages = entries
        .iter()
        .map(|entry| package(entry, root, &names, defaults))
        .collect::<Result<Vec<_>>>()?;
    packages.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(packages)
}

fn package(
    entry: &Value,
    root: &str,
    names: &BTreeSet<&str>,
    defaults: &[Value],
) -> Result<Package> {
    let mut dependencies = BTreeSet::new();
    for dependency in list(entry, "dependencies")? {
        let name = text(dependency, "name")?;
        // Cargo writes no kind for a normal dependency.
        if dependency["kind"].is_null() && names.contains(name) {
            dependencies.insert(name.to_owned());
        }
    }
    let mut roots = Vec::new();
    for target in list(entry, "targets")? {
        let kinds: Vec<_> = list(target, "kind")?
            .iter()
            .filter_map(Value::as_str)
            .collect();
        if kinds.contains(&"lib") || kinds.contains(&"bin") {
            roots.push(TargetRoot {
                path: relative(text(target, "src_path")?, root),
                is_library: kinds.contains(&"lib"),
            });
        }
    }
    Ok(Package {
        name: text(entry, "name")?.to_owned(),
        manifest: relative(text(entry, "manifest_path")?, root),
        is_default: defaults.contains(&entry["id"]),
        has_license: entry["license"].is_string(),
        has_features: entry["features"]
            .as_object()
            .is_some_and(|features| !features.is_empty()),
        roots,
        dependencies,
    })
}

fn relative(path: &str, root: &str) -> String {
    path.strip_prefix(root)
        .unwrap_or(path)
        .replace('\\', "/")
        .trim_start_matches('/')
        .to_owned()
}

fn text<'a>(value: &'a Value, key: &str) -> Result<&'a str> {
    value[key]
        .as_str()
        .with_context(|| format!("`cargo metadata` has no text `{key}`"))
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>> {
    value[key]
        .as_array()
        .with_context(|| format!("`cargo metadata` has no list `{key}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANSWER: &str = r#"{
        "workspace_root": "/w",
        "workspace_default_members": ["path+file:///w/crates/upper#1.0.0"],
        "packages": [
            {"name": "upper", "id": "path+file:///w/crates/upper#1.0.0", "license": null, "manifest_path": "/w/crates/upper/Cargo.toml",
             "features": {"fast": []},
             "dependencies": [
                {"name": "lower", "kind": null},
                {"name": "serde", "kind": null},
                {"name": "tester", "kind": "dev"}],
             "targets": [
                {"kind": ["lib"], "src_path": "/w/crates/upper/src/lib.rs"},
                {"kind": ["bin"], "src_path": "/w/crates/upper/src/main.rs"},
                {"kind": ["test"], "src_path": "/w/crates/upper/tests/all.rs"}]},
            {"name": "lower", "id": "path+file:///w/lower#1.0.0", "license": "MIT", "manifest_path": "/w/lower/Cargo.toml",
             "features": {}, "dependencies": [], "targets": []},
            {"name": "tester", "id": "path+file:///w/tester#1.0.0", "license": "MIT", "manifest_path": "/w/tester/Cargo.toml",
             "features": {}, "dependencies": [], "targets": []}
        ]}"#;

    #[test]
    fn only_normal_dependencies_inside_the_workspace_are_kept() {
        let packages = parse(ANSWER).unwrap();
        let names: Vec<_> = packages.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(names, ["lower", "tester", "upper"]);
        let upper = &packages[2];
        assert_eq!(
            upper.dependencies,
            BTreeSet::from(["lower".to_owned()]),
            "serde is foreign and tester is a dev-dependency"
        );
        assert_eq!(upper.manifest, "crates/upper/Cargo.toml");
        assert!(upper.is_default && !upper.has_license && upper.has_features);
        let lower = &packages[0];
        assert!(!lower.is_default && lower.has_license && !lower.has_features);
    }

    #[test]
    fn roots_are_libraries_and_programs_only() {
        let packages = parse(ANSWER).unwrap();
        let roots: Vec<_> = packages[2]
            .roots
            .iter()
            .map(|root| (root.path.as_str(), root.is_library))
            .collect();
        assert_eq!(
            roots,
            [
                ("crates/upper/src/lib.rs", true),
                ("crates/upper/src/main.rs", false)
            ]
        );
    }

    #[test]
    fn a_strange_answer_is_an_error() {
        assert!(parse("{}").is_err());
        assert!(parse("no json").is_err());
    }
}
