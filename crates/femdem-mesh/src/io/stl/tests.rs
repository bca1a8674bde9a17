use super::*;
use crate::catalogue::{CatalogueShape, Solid};
use crate::strategies::{catalogue_shapes, convex_polyhedra, poses};
use proptest::prelude::*;

fn cube() -> Polyhedron {
    CatalogueShape::from(Solid::P5).polyhedron(0.02).unwrap()
}

fn binary(body: &Polyhedron) -> Vec<u8> {
    let mut file = Vec::new();
    write_binary(body, &mut file).unwrap();
    file
}

fn ascii(body: &Polyhedron) -> String {
    let mut file = Vec::new();
    write_ascii(body, &mut file).unwrap();
    String::from_utf8(file).unwrap()
}

#[test]
fn a_cube_has_six_faces_from_either_format() {
    let bytes = binary(&cube());
    assert_eq!(bytes.len(), 84 + 12 * 50);
    for file in [bytes, ascii(&cube()).into_bytes()] {
        let body = read(&file[..]).unwrap();
        assert_eq!((body.vertices().len(), body.face_count()), (8, 6));
        let volume = cube().mass_properties().volume;
        assert!((body.mass_properties().volume / volume - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_binary_file_that_starts_with_solid_is_still_binary() {
    let mut bytes = binary(&cube());
    bytes[..5].copy_from_slice(b"solid");
    assert_eq!(parse(&bytes).unwrap().face_count(), 6);
}

/// Texts with the mark of their byte order, in capitals, or both.
#[test]
fn a_text_is_read_with_a_byte_order_mark_and_in_capitals() {
    let plain = ascii(&cube());
    let expected = parse(plain.as_bytes()).unwrap();
    let loud = plain.to_ascii_uppercase();
    for text in [
        format!("\u{feff}{plain}"),
        format!("\u{feff}\n {loud}"),
        loud,
    ] {
        assert_eq!(parse(text.as_bytes()).unwrap(), expected);
    }
}

#[test]
fn lengths_that_do_not_fit_are_refused_without_reserving_memory() {
    let mut bytes = binary(&cube());
    bytes[80..84].copy_from_slice(&1_000_000_000_u32.to_le_bytes());
    match parse(&bytes) {
        Err(MeshError::StlLength {
            promised: 1_000_000_000,
            expected,
            found: 684,
        }) => {
            assert_eq!(expected, 50_000_000_084);
        }
        other => panic!("{other:?}"),
    }
    let whole = binary(&cube());
    for length in 0..whole.len() {
        assert!(parse(&whole[..length]).is_err(), "cut to {length} bytes");
    }
    let longer = [whole, vec![0]].concat();
    assert!(matches!(
        parse(&longer),
        Err(MeshError::StlLength { found: 685, .. })
    ));
}

#[test]
fn empty_and_cut_off_files_are_named() {
    assert!(matches!(parse(b""), Err(MeshError::Empty { .. })));
    assert!(matches!(
        parse(&[0; 84]),
        Err(MeshError::Empty { what: "triangles" })
    ));
    assert!(matches!(
        parse(b"solid a\nendsolid a\n"),
        Err(MeshError::Empty { what: "triangles" })
    ));
    let text = ascii(&cube());
    let cut = text.replace("endsolid femdem\n", "");
    assert!(matches!(
        parse(cut.as_bytes()),
        Err(MeshError::Parse { .. })
    ));
    let (start, _) = text.split_at(text.len() / 2);
    assert!(matches!(
        parse(start.as_bytes()),
        Err(MeshError::Parse { .. })
    ));
    let word = text.replacen("facet", "fecat", 1);
    assert!(matches!(
        parse(word.as_bytes()),
        Err(MeshError::Parse { line: 2, .. })
    ));
    let four = text.replacen("    endloop", "      vertex 0 0 0\n    endloop", 1);
    assert!(matches!(
        parse(four.as_bytes()),
        Err(MeshError::Parse { .. })
    ));
}

#[test]
fn coordinates_that_are_not_numbers_are_refused() {
    let mut bytes = binary(&cube());
    bytes[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(matches!(
        parse(&bytes),
        Err(MeshError::NotFinite { vertex: 0, .. })
    ));
    let text = ascii(&cube()).replacen("vertex 0", "vertex inf 0", 1);
    let text = text.replacen("vertex -0", "vertex nan", 1);
    assert!(matches!(
        parse(text.as_bytes()),
        Err(MeshError::Parse { .. })
    ));
    let huge = cube().scaled(1e29).unwrap();
    let far = Pose::translation(1e39, 0.0, 0.0);
    let written = write_binary_posed([(&huge, &far)], Vec::new());
    assert!(matches!(written, Err(MeshError::OutOfRange { .. })));
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.0);
    let written = write_ascii_posed([(&huge, &nowhere)], Vec::new());
    let refused = written.unwrap_err().to_string();
    assert!(refused.contains("pose.translation"), "{refused}");
}

#[test]
fn a_hole_is_found() {
    let mut bytes = binary(&cube());
    bytes.truncate(bytes.len() - 50);
    bytes[80..84].copy_from_slice(&11_u32.to_le_bytes());
    match parse(&bytes) {
        Err(MeshError::OpenSurface { edges: 3, facets }) => assert_eq!(facets.count, 3),
        other => panic!("{other:?}"),
    }
}

#[test]
fn triangles_without_area_are_named_and_dropped_on_request() {
    let text = ascii(&cube());
    let p = text.lines().find(|l| l.contains("vertex")).unwrap();
    let needle = format!("facet normal 0 0 0\nouter loop\n{p}\n{p}\n{p}\nendloop\nendfacet\n");
    let with_needle = text.replace("endsolid", &format!("{needle}endsolid"));
    match parse(with_needle.as_bytes()) {
        Err(MeshError::DegenerateFacets { facets }) => assert_eq!(facets.first, [12]),
        other => panic!("{other:?}"),
    }
    let repaired = crate::io::parse(with_needle.as_bytes(), Format::Stl, &Options::REPAIR);
    let (body, report) = repaired.unwrap();
    assert_eq!((body.face_count(), report.facets_without_area), (6, 1));
}

#[test]
fn many_bodies_are_one_file() {
    let (a, b) = (Pose::identity(), Pose::translation(1.0, 0.0, 0.0));
    let mut file = Vec::new();
    write_binary_posed([(&cube(), &a), (&cube(), &b)], &mut file).unwrap();
    assert_eq!(file.len(), 84 + 24 * 50);
    assert!(matches!(
        parse(&file),
        Err(MeshError::Disconnected { components: 2 })
    ));
}

proptest! {
    #[test]
    fn single_precision_keeps_the_faces(shape in catalogue_shapes(), pose in poses(1.0)) {
        let body = shape.polyhedron(1.0).unwrap().transformed(&pose).unwrap();
        let read = parse(&binary(&body)).unwrap();
        prop_assert_eq!(read.vertices().len(), body.vertices().len());
        prop_assert_eq!(read.face_count(), body.face_count());
        prop_assert!(read.is_convex());
        let ratio = read.mass_properties().volume / body.mass_properties().volume;
        prop_assert!((ratio - 1.0).abs() < 1e-5);
    }

    #[test]
    fn ascii_keeps_all_digits(body in convex_polyhedra()) {
        let read = parse(ascii(&body).as_bytes()).unwrap();
        // Faces that are coplanar to the merging tolerance may have become one.
        prop_assert!(read.face_count() <= body.face_count());
        let ratio = read.mass_properties().volume / body.mass_properties().volume;
        prop_assert!((ratio - 1.0).abs() < 1e-4);
        for v in read.vertices() {
            prop_assert!(body.vertices().contains(v));
        }
    }

    #[test]
    fn no_bytes_panic(start in "(solid|)", bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let file = [start.as_bytes(), &bytes].concat();
        prop_assert!(parse(&file).is_err());
    }

    #[test]
    fn no_flipped_bit_panics(position in 0..684_usize, bit in 0..8_u32) {
        let mut bytes = binary(&cube());
        bytes[position] ^= 1 << bit;
        if let Ok(body) = parse(&bytes) {
            prop_assert!(body.mass_properties().volume > 0.0);
        }
    }
}
