use super::*;
use crate::strategies::convex_polyhedra;
use proptest::prelude::*;

const TETRAHEDRON: &str = "\
OFF # by hand
# four of each
4 4 6

0 0 0
1 0 0
0 1e0 0 # y
0 0 +1
3 0 2 1
3 0 1 3 255 0 0
3 0 3 2
3 1 2 3
";

fn error_of(from: &str, to: &str) -> MeshError {
    let text = TETRAHEDRON.replacen(from, to, 1);
    assert_ne!(text, TETRAHEDRON);
    parse(&text).unwrap_err()
}

#[test]
fn reads_every_form_of_header() {
    let body = parse(TETRAHEDRON).unwrap();
    assert_eq!((body.vertices().len(), body.face_count()), (4, 4));
    assert!((body.mass_properties().volume - 1.0 / 6.0).abs() < 1e-15);
    for header in ["", "COFF\n", "STCNOFF\n", "OFF 4 4 0\n"] {
        let (_, rest) = TETRAHEDRON.split_once('\n').unwrap();
        let rest = if header.contains('4') {
            rest.replacen("4 4 6", "", 1)
        } else {
            rest.to_owned()
        };
        assert_eq!(parse(format!("{header}{rest}")).unwrap(), body, "{header}");
    }
    assert_eq!(parse(TETRAHEDRON.replace('\n', "\r\n")).unwrap(), body);
    let colours = TETRAHEDRON.replace("1 0 0\n", "1 0 0 0.5 0.5 0.5 1\n");
    assert_eq!(parse(colours).unwrap(), body);
}

#[test]
fn what_cannot_be_read_is_named_with_its_line() {
    let line = |from: &str, to: &str| match error_of(from, to) {
        MeshError::Parse { line, .. } => line,
        other => panic!("{from}: {other}"),
    };
    assert_eq!(line("4 4 6", "4 -4 6"), 3);
    assert_eq!(line("4 4 6", "4"), 3);
    assert_eq!(line("OFF", "BUFF"), 1);
    assert_eq!(line("1 0 0", "1 0"), 6);
    assert_eq!(line("1e0", "inf"), 7);
    assert_eq!(line("3 0 2 1", "2 0 2"), 9);
    assert_eq!(line("3 0 2 1", "4 0 2 1"), 9);
    assert_eq!(line("3 0 2 1", "99999999999999 0 2 1"), 9);
    assert_eq!(line("3 0 2 1", "3 0 2 -1"), 9);
    assert_eq!(line("3 0 2 1", "3 0 2 99999999999"), 9);
    let error = error_of("3 0 2 1", "3 0 2 7");
    assert!(
        matches!(
            error,
            MeshError::IndexOutOfRange {
                face: 0,
                index: 7,
                count: 4
            }
        ),
        "{error}"
    );
}

#[test]
fn other_kinds_and_files_cut_off_are_named() {
    for (from, to) in [("OFF #", "OFF BINARY #"), ("OFF", "4OFF"), ("OFF", "nOFF")] {
        // A digit may start counts, so that 4OFF is taken for a number of vertices.
        let error = error_of(from, to);
        assert!(
            matches!(
                error,
                MeshError::Unsupported { .. } | MeshError::Parse { .. }
            ),
            "{error}"
        );
    }
    assert!(matches!(
        error_of("4 4 6", "10000000 4 6"),
        MeshError::Parse { .. }
            | MeshError::CutOff {
                promised: 10_000_000,
                ..
            }
    ));
    assert!(matches!(
        error_of("4 4 6", "4 10000000 6"),
        MeshError::CutOff {
            what: "faces",
            promised: 10_000_000,
            found: 4
        }
    ));
    assert!(matches!(parse(""), Err(MeshError::Empty { .. })));
    assert!(matches!(parse("OFF\n"), Err(MeshError::Empty { .. })));
    assert!(matches!(
        parse("OFF\n0 0 0\n"),
        Err(MeshError::Empty { .. })
    ));
    for length in 0..TETRAHEDRON.len() - 2 {
        assert!(parse(&TETRAHEDRON[..length]).is_err(), "{length}");
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_bit_for_bit(body in convex_polyhedra()) {
        let mut file = Vec::new();
        write(&body, &mut file).unwrap();
        prop_assert_eq!(read(&file[..]).unwrap(), body);
    }
}
