//! Surface files in scenes and packs: mended on request and reported, or refused by name.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run, stdout};
use femdem::run::Scenario;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

/// Files with faults: cubes of 20 mm, and a bucket.
fn kept(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../femdem-mesh/tests/data")
        .join(name)
}

/// A scene of one step or so, with these entries.
fn scene(entries: &str) -> String {
    format!("duration = 1e-5\ngravity = [0, 0, 0]\n[material.stone]\ndensity = 2000\n{entries}")
}

/// An entry with a file and further keys.
type Entry = fn(&str, &str) -> String;

fn body(name: &str, rest: &str) -> String {
    let path = kept(name).display().to_string();
    format!("[[body]]\nshape = '{path}'\nmaterial = \"stone\"\n{rest}\n")
}

fn wall(name: &str, rest: &str) -> String {
    let path = kept(name).display().to_string();
    format!("[[wall]]\nname = \"block\"\nfile = '{path}'\n{rest}\n")
}

fn refusal(entries: &str) -> String {
    let scenario = Scenario::from_toml(&scene(entries)).unwrap();
    scenario.build().unwrap_err().to_string()
}

#[test]
fn a_scene_mends_files_only_if_it_asks_for_it_and_keeps_what_was_done() {
    let kinds: [(Entry, &str); 2] = [(body, "body 1"), (wall, "wall \"block\"")];
    let cube =
        "[[body]]\nshape = \"cube\"\nsize = 0.01\nposition = [1, 0, 0]\nmaterial = \"stone\"\n";
    for (name, done) in [
        ("inside_out.obj", "the surface was inside out"),
        ("facets_twice.obj", "2 facets given twice dropped"),
        ("loose_vertices.obj", "28 vertices joined to another"),
        ("seam.obj", "1 vertices on edges of other facets joined"),
    ] {
        for (entry, place) in kinds {
            let message = refusal(&(entry(name, "") + cube));
            for word in [place, name, "repair"] {
                assert!(message.contains(word), "{word}: {message}");
            }
            let text = scene(&(entry(name, "repair = true") + cube));
            let made = Scenario::from_toml(&text).unwrap().build().unwrap();
            assert_eq!(made.notes.len(), 1, "{:?}", made.notes);
            let note = made.notes[0].to_string();
            assert!(note.contains(name) && note.contains(done), "{note}");
        }
    }
}

/// Of entries that follow one another with the same geometry, that is made once and noted once.
#[test]
fn entries_with_and_without_repair_differ() {
    let mended = body("inside_out.obj", "repair = true");
    let moved = |name: &str| {
        body(
            "inside_out.obj",
            &format!("name = \"{name}\"\nposition = [1, 0, 0]\nrepair = true"),
        )
    };
    let text = scene(&(mended.clone() + &moved("second")));
    let made = Scenario::from_toml(&text).unwrap().build().unwrap();
    assert_eq!((made.members.len(), made.notes.len()), (2, 1));
    assert!((made.bodies()[1].mass - 0.016).abs() < 1e-9);
    let message = refusal(&(mended + &body("inside_out.obj", "name = \"second\"")));
    for word in ["body \"second\"", "inside_out.obj", "repair"] {
        assert!(message.contains(word), "{word}: {message}");
    }
}

#[test]
fn nothing_but_surface_files_is_mended() {
    let of_body = "material = \"stone\"\nrepair = true\n";
    for entries in [
        format!("[[body]]\nshape = \"cube\"\nsize = 0.01\n{of_body}"),
        format!("[[body]]\nblock = [1, 1, 1]\nsides = [1, 1, 1]\n{of_body}"),
        format!("[[body]]\nmesh = \"some.msh\"\n{of_body}"),
        "[[wall]]\nplane = { normal = [0, 0, 1] }\nrepair = true\n".to_owned(),
    ] {
        let message = refusal(&entries);
        assert!(message.contains("repair = true"), "{message}");
        assert!(message.contains("file only"), "{message}");
    }
}

#[test]
fn the_program_says_what_was_done_to_files() {
    let folder = tempdir().unwrap();
    let (file, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    let floor = wall(
        "seam.obj",
        "repair = true\nmotion = { linear = { velocity = [0, 0, 1] } }",
    );
    let stone = body("facets_twice.obj", "position = [0.1, 0, 0]\nrepair = true");
    fs::write(&file, scene(&(floor + &stone))).unwrap();
    let command = |options: &[&str]| {
        let mut command = femdem("run");
        command.arg(&file).args(options).arg("--out").arg(&out);
        run(&mut command)
    };
    for options in [&["--check"][..], &[]] {
        let result = command(options);
        assert_eq!(code(&result), 0, "{result:?}");
        let said = stdout(&result);
        for words in [
            "seam.obj in metres",
            "1 vertices on edges of other facets joined",
            "facets_twice.obj in metres",
            "2 facets given twice dropped",
        ] {
            assert_eq!(said.matches(words).count(), 1, "{words}: {said}");
        }
    }
    let quiet = command(&["--quiet", "--force"]);
    assert_eq!((code(&quiet), stdout(&quiet)), (0, String::new()));
}

/// What no repair can make one solid body is refused by the file's name, in scenes and packs, with advice.
#[test]
fn hollow_bodies_several_shells_and_thin_bodies_are_refused_by_name() {
    let folder = tempdir().unwrap();
    for (name, words) in [
        ("hollow.obj", ["hollow", "leave the inner shells out"]),
        (
            "shared_face.obj",
            ["2 closed shells", "as a body of its own"],
        ),
        (
            "two_cubes.obj",
            ["2 separate closed shells", "as a body of its own"],
        ),
        ("bucket.obj", ["too thin", "several bodies"]),
    ] {
        let mut pack = femdem("pack");
        pack.args(["--count", "1", "--repair", "--shape"])
            .arg(kept(name));
        pack.arg("--out").arg(folder.path().join("out"));
        let in_scene = [body(name, "repair = true"), wall(name, "repair = true")];
        let messages = in_scene.map(|entries| refusal(&entries));
        for message in messages.into_iter().chain([fails(&mut pack, &[])]) {
            for word in [name].iter().chain(&words) {
                assert!(message.contains(word), "{word}: {message}");
            }
        }
    }
}
