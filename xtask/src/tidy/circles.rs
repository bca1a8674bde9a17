//! Files of a crate that import each other in a circle.
//!
//! An import is a `use` of an item that another file of the same crate defines, or a path to one that starts with
//! `crate`, `super` or `self`. A name that a file only hands on with `pub use` counts for the file that defines it.
//! Tests count as no part of their file. A module and a part of it may use each other, since the two are read together:
//! circles are looked for without what parts take from their module, and without what modules take from their parts.

use std::collections::{BTreeMap, BTreeSet};

use syn::visit::{self, Visit};

use super::Problem;
use super::files::SourceFile;

/// Names from the root of the crate.
type Path = Vec<String>;

/// Re-exports are followed through at most this many.
const DEEPEST: usize = 16;

/// What a file defines, what it imports, and what it hands on.
#[derive(Debug, Default)]
struct Module {
    file: String,
    defined: BTreeSet<String>,
    /// By the name in this module, the path as written.
    named: BTreeMap<String, Path>,
    /// Paths of which all names are taken.
    globs: Vec<Path>,
    /// Paths that the file's own code uses, as written.
    used: Vec<Path>,
}

/// The modules of a crate by their paths.
type Crate = BTreeMap<Path, Module>;

/// Finds the circles in every crate.
pub(crate) fn check(files: &[SourceFile]) -> Vec<Problem> {
    let mut crates: BTreeMap<&str, Crate> = BTreeMap::new();
    let mut problems = Vec::new();
    for file in files.iter().filter(|file| file.extension() == "rs") {
        let Some((root, path)) = module_path(&file.path) else {
            continue;
        };
        match syn::parse_file(&file.text) {
            Ok(parsed) => {
                let module = read(&file.path, parsed);
                crates.entry(root).or_default().insert(path, module);
            }
            Err(error) => problems.push(Problem::new(
                &file.path,
                1,
                format!("cannot be read as Rust: {error}"),
            )),
        }
    }
    for modules in crates.values() {
        for without in [Without::Up, Without::Down] {
            problems.extend(circles(&imports(modules, without)));
        }
    }
    problems.sort();
    problems.dedup();
    problems
}

/// The crate's folder and the path of the module, for a file in a crate's `src`.
fn module_path(path: &str) -> Option<(&str, Path)> {
    let (root, inside) = path.split_once("/src/")?;
    let mut names: Path = inside
        .strip_suffix(".rs")?
        .split('/')
        .map(str::to_owned)
        .collect();
    match names.last().map(String::as_str) {
        Some("mod") => drop(names.pop()),
        Some("lib" | "main") if names.len() == 1 => names.clear(),
        _ => {}
    }
    Some((root, names))
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Ident>()
                .is_ok_and(|condition| condition == "test")
    })
}

fn read(file: &str, parsed: syn::File) -> Module {
    let mut module = Module {
        file: file.to_owned(),
        ..Module::default()
    };
    for item in &parsed.items {
        let (attributes, name) = match item {
            syn::Item::Const(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Enum(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
            syn::Item::Static(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Struct(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Trait(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Type(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Union(item) => (&item.attrs, Some(&item.ident)),
            syn::Item::Impl(item) => (&item.attrs, None),
            syn::Item::Mod(item) => (&item.attrs, None),
            syn::Item::Use(item) => (&item.attrs, None),
            _ => continue,
        };
        if is_test(attributes) {
            continue;
        }
        module.defined.extend(name.map(ToString::to_string));
        if let syn::Item::Use(item) = item {
            module.add_use(
                &item.tree,
                &Vec::new(),
                !matches!(item.vis, syn::Visibility::Inherited),
            );
        } else {
            module.visit_item(item);
        }
    }
    module
}

impl Module {
    /// Adds what a `use` names; `handed_on`: to others, too.
    fn add_use(&mut self, tree: &syn::UseTree, before: &Path, handed_on: bool) {
        let with = |name: &syn::Ident| {
            let mut path = before.clone();
            // `use a::{self}` names a.
            if before.is_empty() || name != "self" {
                path.push(name.to_string());
            }
            path
        };
        match tree {
            syn::UseTree::Path(tree) => self.add_use(&tree.tree, &with(&tree.ident), handed_on),
            syn::UseTree::Group(group) => {
                for tree in &group.items {
                    self.add_use(tree, before, handed_on);
                }
            }
            syn::UseTree::Glob(_) => {
                self.globs.push(before.clone());
                if !handed_on {
                    self.used.push(before.clone());
                }
            }
            syn::UseTree::Name(name) => {
                let path = with(&name.ident);
                if let Some(last) = path.last() {
                    self.named.insert(last.clone(), path.clone());
                }
                if !handed_on {
                    self.used.push(path);
                }
            }
            syn::UseTree::Rename(renamed) => {
                let path = with(&renamed.ident);
                self.named.insert(renamed.rename.to_string(), path.clone());
                if !handed_on {
                    self.used.push(path);
                }
            }
        }
    }
}

impl<'ast> Visit<'ast> for Module {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Path = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if matches!(names[0].as_str(), "crate" | "super" | "self") && names.len() > 1 {
            self.used.push(names);
        }
        visit::visit_path(self, path);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.add_use(&item.tree, &Vec::new(), false);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }
}

/// The module, and its file, that defines what a path of a module leads to.
fn resolve<'a>(
    modules: &'a Crate,
    from: &Path,
    path: &[String],
    depth: usize,
) -> Option<(Path, &'a str)> {
    if depth > DEEPEST {
        return None;
    }
    let mut at = from.clone();
    for (k, name) in path.iter().enumerate() {
        match name.as_str() {
            "crate" => at.clear(),
            "self" => {}
            "super" => drop(at.pop()?),
            _ => {
                let mut child = at.clone();
                child.push(name.clone());
                if modules.contains_key(&child) {
                    at = child;
                    continue;
                }
                let module = modules.get(&at)?;
                if module.defined.contains(name) {
                    return Some((at, &module.file));
                }
                let rest = &path[k + 1..];
                if let Some(target) = module.named.get(name) {
                    let whole: Path = target.iter().chain(rest).cloned().collect();
                    // `use name;` of another crate names itself.
                    let leads_on = whole != path[k..];
                    return leads_on
                        .then(|| resolve(modules, &at, &whole, depth + 1))
                        .flatten();
                }
                return module.globs.iter().find_map(|glob| {
                    let whole: Path = glob.iter().chain(&path[k..]).cloned().collect();
                    resolve(modules, &at, &whole, depth + 1)
                });
            }
        }
    }
    let module = modules.get(&at)?;
    Some((at, &module.file))
}

/// By file, the files that it imports, each with a name that it takes from there.
type Imports<'a> = BTreeMap<&'a str, BTreeMap<&'a str, &'a str>>;

/// Imports between a module and its parts that are left out.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Without {
    /// What a part takes from a module that it is in.
    Up,
    /// What a module takes from its parts.
    Down,
}

fn imports(modules: &Crate, without: Without) -> Imports<'_> {
    let mut imports = Imports::new();
    for (path, module) in modules {
        let of_file = imports.entry(&module.file).or_default();
        for used in &module.used {
            let (Some(other), Some(name)) = (resolve(modules, path, used, 0), used.last()) else {
                continue;
            };
            let left_out = match without {
                Without::Up => path.starts_with(&other.0),
                Without::Down => other.0.starts_with(path),
            };
            if !left_out && other.1 != module.file {
                of_file.entry(other.1).or_insert(name);
            }
        }
    }
    imports
}

/// One problem for every shortest circle that starts at the first of its files.
fn circles(imports: &Imports) -> Vec<Problem> {
    let mut told: BTreeSet<&str> = BTreeSet::new();
    let mut problems = Vec::new();
    for &start in imports.keys() {
        if told.contains(start) {
            continue;
        }
        let Some(way) = shortest_way_back(imports, start) else {
            continue;
        };
        told.extend(&way);
        let mut text = start.to_owned();
        for (from, to) in way.iter().zip(way.iter().cycle().skip(1)) {
            text += &format!(" -> {to} ({})", imports[from][to]);
        }
        problems.push(Problem::new(
            start,
            1,
            format!("files import each other in a circle: {text}: move what they share into a file below them"),
        ));
    }
    problems
}

/// The files of a shortest circle through `start`, in order.
fn shortest_way_back<'a>(imports: &Imports<'a>, start: &'a str) -> Option<Vec<&'a str>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut front = vec![start];
    while !front.is_empty() {
        let mut next = Vec::new();
        for from in front {
            for &to in imports.get(from)?.keys() {
                if to == start {
                    let mut way = vec![from];
                    while way[way.len() - 1] != start {
                        way.push(before[way[way.len() - 1]]);
                    }
                    way.reverse();
                    return Some(way);
                }
                if !before.contains_key(to) {
                    before.insert(to, from);
                    next.push(to);
                }
            }
        }
        front = next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let files: Vec<SourceFile> = files
            .iter()
            .map(|(path, text)| SourceFile {
                path: format!("crates/c/src/{path}"),
                text: (*text).to_owned(),
            })
            .collect();
        check(&files).into_iter().map(|p| p.message).collect()
    }

    #[test]
    fn two_files_that_use_each_other_are_found() {
        let circle = [
            ("lib.rs", "mod a;\nmod b;"),
            ("a.rs", "use crate::b::B;\npub struct A(B);"),
            ("b.rs", "pub struct B;\nfn f(_: &super::a::A) {}"),
        ];
        let problems = found(&circle);
        assert_eq!(problems.len(), 1);
        assert!(problems[0].contains("a.rs -> crates/c/src/b.rs (B) -> crates/c/src/a.rs (A)"));
    }

    #[test]
    fn names_are_followed_to_the_file_that_defines_them() {
        let down = [
            ("lib.rs", "mod a;\npub use a::{B, helper};"),
            ("a/mod.rs", "mod b;\nmod c;\npub use b::B;\npub use c::*;"),
            ("a/b.rs", "use super::helper;\nuse std::fmt;\npub struct B;"),
            ("a/c.rs", "pub fn helper() {}"),
        ];
        assert_eq!(found(&down), Vec::<String>::new());
        let mut back = down;
        back[3].1 = "use crate::B as Other;\npub fn helper() -> Other { Other }";
        assert_eq!(found(&back).len(), 1);
    }

    #[test]
    fn a_part_may_use_what_its_module_defines() {
        let files = [
            ("lib.rs", "mod a;"),
            (
                "a/mod.rs",
                "mod b;\nuse b::B;\npub const N: usize = 1;\nfn f(_: B) {}",
            ),
            ("a/b.rs", "pub struct B([u8; super::N]);"),
        ];
        assert_eq!(found(&files), Vec::<String>::new());
    }

    #[test]
    fn a_circle_through_a_part_and_its_module_is_found() {
        let files = [
            ("lib.rs", "mod a;\nmod c;"),
            (
                "a/mod.rs",
                "mod b;\npub use b::B;\nuse crate::c::C;\npub const N: usize = 1;\nfn f(_: C) {}",
            ),
            ("a/b.rs", "pub struct B([u8; super::N]);"),
            ("c.rs", "use crate::a::B;\npub struct C(B);"),
        ];
        assert_eq!(found(&files).len(), 1);
    }

    #[test]
    fn tests_may_use_what_they_like() {
        let files = [
            ("lib.rs", "mod a;\nmod b;"),
            (
                "a.rs",
                "pub struct A;\n#[cfg(test)]\nmod tests { use crate::b::B; }",
            ),
            ("b.rs", "use crate::a::A;\npub struct B(A);"),
        ];
        assert_eq!(found(&files), Vec::<String>::new());
    }
}
