use super::*;
use crate::catalogue::{CatalogueShape, Solid};
use crate::strategies::convex_polyhedra;
use proptest::prelude::*;

/// Two tetrahedra with tags out of order, the second inverted, beside a node, a point, a line and
/// a triangle that are not wanted.
const V41: &str = "\
$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 \"rock\"
$EndPhysicalNames
$Entities
0 0 0 1
1 0 0 0 1 1 1 1 1 0
$EndEntities
$Nodes
2 6 5 90
0 1 0 1
90
7 7 7
2 1 1 5
5
8
6
20
21
0 0 0 0.5 0.5
1 0 0 0.5 0.5
0 1 0 0.5 0.5
0 0 1 0.5 0.5
1 1 1 0.5 0.5
$EndNodes
$Elements
4 5 1 5
0 1 15 1
1 90
1 1 1 1
2 5 8
2 1 2 1
3 5 8 6
3 1 4 2
4 5 8 6 20
5 8 6 20 21
$EndElements
";

const V22: &str = "\
$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
6
90 7 7 7
5 0 0 0
8 1 0 0
6 0 1 0
20 0 0 1
21 1 1 1
$EndNodes
$Elements
4
1 15 2 0 1 90
2 2 2 0 1 5 8 6
3 4 2 0 1 5 8 6 20
4 4 3 0 1 9 8 6 20 21
$EndElements
";

/// [`V41`] in binary: sections that are not wanted left out.
fn binary(big_endian: bool) -> Vec<u8> {
    fn put<const N: usize>(file: &mut Vec<u8>, mut bytes: [u8; N], big_endian: bool) {
        if big_endian {
            bytes.reverse();
        }
        file.extend(bytes);
    }
    let mut file = b"$MeshFormat\n4.1 1 8\n".to_vec();
    put(&mut file, 1_i32.to_le_bytes(), big_endian);
    file.extend(b"\n$EndMeshFormat\n$Nodes\n");
    let ints = |file: &mut Vec<u8>, all: &[i32]| {
        all.iter()
            .for_each(|x| put(file, x.to_le_bytes(), big_endian))
    };
    let sizes = |file: &mut Vec<u8>, all: &[u64]| {
        all.iter()
            .for_each(|x| put(file, x.to_le_bytes(), big_endian))
    };
    let reals = |file: &mut Vec<u8>, all: &[f64]| {
        all.iter()
            .for_each(|x| put(file, x.to_le_bytes(), big_endian))
    };
    sizes(&mut file, &[1, 5, 5, 21]);
    ints(&mut file, &[3, 1, 0]);
    sizes(&mut file, &[5, 5, 8, 6, 20, 21]);
    reals(
        &mut file,
        &[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 1., 1., 1.],
    );
    file.extend(b"\n$EndNodes\n$Elements\n");
    sizes(&mut file, &[2, 3, 3, 5]);
    ints(&mut file, &[2, 1, 2]);
    sizes(&mut file, &[1, 3, 5, 8, 6]);
    ints(&mut file, &[3, 1, 4]);
    sizes(&mut file, &[2, 4, 5, 8, 6, 20, 5, 8, 6, 20, 21]);
    file.extend(b"\n$EndElements\n");
    file
}

#[test]
fn all_forms_give_the_same_mesh() {
    let mesh = parse(V41.as_bytes()).unwrap();
    assert_eq!((mesh.points().len(), mesh.tets().len()), (5, 2));
    // The corner tetrahedron, and one of base (8, 6, 20) with its top at (1, 1, 1).
    assert!((mesh.volume() - (1.0 / 6.0 + 1.0 / 3.0)).abs() < 1e-15);
    assert_eq!(parse(V22.as_bytes()).unwrap(), mesh);
    assert_eq!(parse(V41.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    assert_eq!(parse(&binary(false)).unwrap(), mesh);
    assert_eq!(parse(&binary(true)).unwrap(), mesh);
}

#[test]
fn a_node_missing_or_given_twice_is_named() {
    let missing = V41.replace("4 5 8 6 20", "4 5 8 6 22");
    let twice = V41.replace("\n90\n", "\n21\n");
    for (text, expected) in [(missing, 22), (twice, 21)] {
        match parse(text.as_bytes()) {
            Err(MeshError::NodeTag { tag, .. }) => assert_eq!(tag, expected),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn other_volume_elements_and_formats_are_refused_by_name() {
    let says = |from: &str, to: &str| {
        let text = V41.replacen(from, to, 1);
        assert_ne!(text, V41);
        let error = parse(text.as_bytes()).unwrap_err();
        assert!(matches!(error, MeshError::Unsupported { .. }), "{error}");
        error.to_string()
    };
    assert!(says("3 1 4 2", "3 1 11 2").contains("second-order tetrahedra (Gmsh type 11)"));
    assert!(says("3 1 4 2", "3 1 5 2").contains("hexahedra"));
    assert!(says("3 1 4 2", "3 1 -5 2").contains("type that is not known"));
    assert!(says("4.1 0", "4.0 0").contains("4.0"));
    let v2_binary = V22.replacen("2.2 0", "2.2 1", 1);
    assert!(matches!(
        parse(v2_binary.as_bytes()),
        Err(MeshError::Unsupported { .. })
    ));
}

#[test]
fn damaged_files_are_named() {
    assert!(matches!(parse(b""), Err(MeshError::Empty { .. })));
    assert!(matches!(parse(b"solid"), Err(MeshError::Empty { .. })));
    assert!(matches!(
        parse(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
        Err(MeshError::Empty { what: "tetrahedra" })
    ));
    for (from, to) in [
        ("2 1 1 5", "2 1 1 5000000000000"),
        ("2 1 1 5", "2 1 1 -5"),
        ("1 1 1 0.5", "1 NaN 1 0.5"),
        ("3 1 4 2", "3 1 4 99999999999999"),
        ("$EndElements", ""),
        ("$EndEntities", "$EndOfEntities"),
        ("5 8 6 20 21\n", "5 8 6 20\n"),
        ("4 5 1 5", "18446744073709551615 5 1 5"),
        ("$Entities", "Entities"),
    ] {
        let text = V41.replacen(from, to, 1);
        assert_ne!(text, V41);
        let error = parse(text.as_bytes()).unwrap_err();
        assert!(matches!(error, MeshError::Parse { .. }), "{from}: {error}");
    }
    let flat = V41.replacen("0 0 1 0.5", "1 1 0 0.5", 1);
    assert!(parse(flat.as_bytes()).is_err());
}

#[test]
fn every_truncation_is_an_error() {
    let end = V41.len() - "$EndElements\n".len();
    for length in 0..end {
        assert!(parse(&V41.as_bytes()[..length]).is_err(), "{length}");
    }
    let file = binary(false);
    for length in 0..file.len() - 1 {
        assert!(parse(&file[..length]).is_err(), "{length}");
    }
}

#[test]
fn a_cube_survives_both_formats() {
    let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02).unwrap();
    let mesh = TetMesh::centroid_fan(&cube).unwrap();
    let (mut new, mut old) = (Vec::new(), Vec::new());
    write(&mesh, &mut new).unwrap();
    write_v2(&mesh, &mut old).unwrap();
    assert_eq!(read(&new[..]).unwrap(), mesh);
    assert_eq!(read(&old[..]).unwrap(), mesh);
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_bit_for_bit(body in convex_polyhedra()) {
        let mesh = TetMesh::centroid_fan(&body).unwrap();
        let mut file = Vec::new();
        write(&mesh, &mut file).unwrap();
        prop_assert_eq!(parse(&file).unwrap(), mesh);
    }

    #[test]
    fn no_changed_byte_panics(
        file in prop::sample::select(vec![V41.as_bytes().to_vec(), V22.as_bytes().to_vec(), binary(false)]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut file = file;
        for (at, byte) in changes {
            let at = at.index(file.len());
            file[at] = byte;
        }
        if let Ok(mesh) = parse(&file) {
            prop_assert!(mesh.volume() > 0.0);
        }
    }
}
