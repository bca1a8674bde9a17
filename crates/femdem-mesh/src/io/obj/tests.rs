use super::*;
use crate::strategies::{convex_polyhedra, poses};
use proptest::prelude::*;

const TETRAHEDRON: &str = "\
# a comment
mtllib some.mtl
o corner
v 0 0 0
v 1.0 0 0 1.0
v 0 1e0 0 # y
v 0 0 +1 0.5 0.5 0.5
vt 0 0
vn 0 0 1
g sides
usemtl red
s off
f 1/1 3/1 2/1
f 1//1 2//1 4//1
f 1/1/1 4/1/1 3/1/1
f -3 -2 -1
";

fn error_of(text: &str) -> MeshError {
    parse(text).unwrap_err()
}

#[test]
fn reads_every_form_of_face_corner() {
    let body = parse(TETRAHEDRON).unwrap();
    assert_eq!((body.vertices().len(), body.face_count()), (4, 4));
    assert!((body.mass_properties().volume - 1.0 / 6.0).abs() < 1e-15);
    let windows = TETRAHEDRON.replace('\n', "\r\n");
    assert_eq!(parse(&windows).unwrap(), body);
    let continued = TETRAHEDRON.replace("f -3 -2 -1", "f -3 \\\n-2 \\\n-1");
    assert_eq!(parse(&continued).unwrap(), body);
    assert_eq!(read(TETRAHEDRON.as_bytes()).unwrap(), body);
}

#[test]
fn vertices_without_a_face_are_dropped() {
    let text = TETRAHEDRON.replace("v 0 0 0\n", "v 9 9 9\nv 0 0 0\n");
    let text = text.replace("f 1/1 3/1 2/1", "f 2 4 3");
    let text = text
        .replace("f 1//1 2//1 4//1", "f 2 3 5")
        .replace("f 1/1/1 4/1/1 3/1/1", "f 2 5 4");
    assert_eq!(parse(&text).unwrap(), parse(TETRAHEDRON).unwrap());
}

#[test]
fn what_cannot_be_read_is_named_with_its_line() {
    let problem = |from: &str, to: &str| {
        let text = TETRAHEDRON.replacen(from, to, 1);
        assert_ne!(text, TETRAHEDRON);
        match error_of(&text) {
            MeshError::Parse { line, problem } => (line, problem),
            other => panic!("{other}"),
        }
    };
    assert_eq!(problem("v 0 0 0", "v 0 0").0, 4);
    assert_eq!(
        problem("1e0", "one"),
        (6, "\"one\" is not a finite number".to_owned())
    );
    assert_eq!(problem("1e0", "NaN").0, 6);
    assert_eq!(problem("1e0", "1e999").0, 6);
    assert_eq!(problem("f 1/1 3/1", "f 0 3/1").0, 13);
    assert_eq!(problem("f -3 -2 -1", "f -5 -2 -1").0, 16);
    assert_eq!(problem("f -3 -2 -1", "f x -2 -1").0, 16);
    assert_eq!(problem("f -3", "f 99999999999999999999").0, 16);
    assert_eq!(problem("f -3", "f -9223372036854775808").0, 16);
}

#[test]
fn surfaces_that_are_no_body_are_named() {
    assert!(matches!(error_of(""), MeshError::Empty { .. }));
    assert!(matches!(
        error_of("\0\u{1}garbage\n"),
        MeshError::Empty { .. }
    ));
    assert!(matches!(error_of("v 0 0 0\n"), MeshError::Empty { .. }));
    let open = TETRAHEDRON.replace("f -3 -2 -1\n", "v 1 1 1\nf 2 3 5\n");
    assert!(matches!(error_of(&open), MeshError::OpenSurface { .. }));
    let beyond = TETRAHEDRON.replace("f -3", "f 5");
    assert!(matches!(
        error_of(&beyond),
        MeshError::Parse { line: 16, .. }
    ));
    let inside_out: String = TETRAHEDRON
        .lines()
        .map(|line| match line.strip_prefix("f ") {
            Some(corners) => {
                let reversed: Vec<&str> = corners.split(' ').rev().collect();
                format!("f {}\n", reversed.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect();
    assert!(matches!(error_of(&inside_out), MeshError::InsideOut { .. }));
    let second = TETRAHEDRON
        .replace("v 0 0 0\n", "v 5 5 5\n")
        .replace("v 1.0", "v 6.0");
    let second = second
        .replace("1e0 0", "6 5")
        .replace("f 1/1 3/1 2/1", "f -4 -2 -3");
    let second = second
        .replace("f 1//1 2//1 4//1", "f -4 -3 -1")
        .replace("f 1/1/1 4/1/1 3/1/1", "f -4 -1 -2");
    let error = error_of(&format!("{TETRAHEDRON}{second}"));
    assert!(
        matches!(error, MeshError::Disconnected { components: 2 }),
        "{error}"
    );
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_bit_for_bit(body in convex_polyhedra()) {
        let mut file = Vec::new();
        write(&body, &mut file).unwrap();
        prop_assert_eq!(read(&file[..]).unwrap(), body);
    }

    #[test]
    fn bodies_in_poses_are_objects_that_count_vertices_on(
        body in convex_polyhedra(),
        first in poses(1.0),
        second in poses(1.0),
    ) {
        let mut file = Vec::new();
        write_posed([(&body, &first), (&body, &second)], &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        let both = parse(&text);
        prop_assert!(matches!(both, Err(MeshError::Disconnected { components: 2 })), "{:?}", both);
        let (one, other) = text.split_once("o body_1\n").unwrap();
        prop_assert_eq!(parse(one).unwrap(), body.transformed(&first).unwrap());
        let vertices: String = one.lines().filter(|l| l.starts_with('v')).map(|l| format!("{l}\n")).collect();
        prop_assert_eq!(parse(&(vertices + other)).unwrap(), body.transformed(&second).unwrap());
    }

    #[test]
    fn no_text_panics(text in "([vf] [-0-9/. e]{0,12}\n|\\PC{0,8}\n|v 1 2 3\n|f 1 2 3\n){0,12}") {
        prop_assert!(parse(&text).is_err());
    }
}

/// Some editors begin a text with the mark of its byte order.
#[test]
fn a_byte_order_mark_is_passed_over() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    let body = parse(format!("\u{feff}{text}")).unwrap();
    assert_eq!(body, parse(text).unwrap());
    assert_eq!(body.vertices().len(), 4);
}
