use super::*;
use crate::strategies::convex_polyhedra;
use proptest::prelude::*;

/// A tetrahedron with colours, normals, another element before and another after.
const ASCII: &str = "\
ply
format ascii 1.0
comment by hand
obj_info none
element camera 1
property list uchar float view
property int number
element vertex 4
property uchar red
property double x
property float32 y
property float z
property float nx
element face 4
property uchar flags
property list uchar int vertex_indices
property list uint8 float texcoord
element edge 1
property int vertex1
property int vertex2
end_header
2 0.5 0.5 7
255 0 0 0 1
255 1 0 0 1
255 0 1 0 1
255 0 0 1 1
0 3 0 2 1 0
0 3 0 1 3 2 0.5 0.5
0 3 0 3 2
0 0 3 1 2 3
0
0 1
";

fn tetrahedron() -> Polyhedron {
    let vertices = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let faces = faces.map(|f| f.to_vec()).to_vec();
    Polyhedron::new(vertices.map(Point3::from).to_vec(), faces).unwrap()
}

/// The data of [`ASCII`] in binary.
fn binary(big_endian: bool) -> Vec<u8> {
    let name = if big_endian {
        "binary_big_endian"
    } else {
        "binary_little_endian"
    };
    let (header, _) = ASCII.split_once("end_header\n").unwrap();
    let mut file = header.replace("ascii", name).into_bytes();
    file.extend(b"end_header\n");
    let mut put = |mut bytes: Vec<u8>| {
        if big_endian {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    let float = |x: f32| x.to_le_bytes().to_vec();
    let int = |i: i32| i.to_le_bytes().to_vec();
    put(vec![2]);
    put(float(0.5));
    put(float(0.5));
    put(int(7));
    for vertex in tetrahedron().vertices() {
        put(vec![255]);
        put(vertex.x.to_le_bytes().to_vec());
        put(float(vertex.y as f32));
        put(float(vertex.z as f32));
        put(float(1.0));
    }
    for (i, face) in tetrahedron().faces().enumerate() {
        put(vec![0]);
        put(vec![3]);
        face.iter().for_each(|&v| put(int(v as i32)));
        let texture: &[f32] = if i == 1 { &[0.5, 0.5] } else { &[] };
        put(vec![texture.len() as u8]);
        texture.iter().for_each(|&x| put(float(x)));
    }
    put(int(0));
    put(int(1));
    file
}

#[test]
fn all_encodings_give_the_same_body() {
    assert_eq!(parse(ASCII.as_bytes()).unwrap(), tetrahedron());
    assert_eq!(
        parse(ASCII.replace('\n', "\r\n").as_bytes()).unwrap(),
        tetrahedron()
    );
    let index = ASCII.replace("vertex_indices", "vertex_index");
    assert_eq!(parse(index.as_bytes()).unwrap(), tetrahedron());
    assert_eq!(parse(&binary(false)).unwrap(), tetrahedron());
    assert_eq!(parse(&binary(true)).unwrap(), tetrahedron());
}

#[test]
fn headers_that_cannot_be_read_are_named() {
    let line_of = |from: &str, to: &str| match parse(ASCII.replacen(from, to, 1).as_bytes()) {
        Err(MeshError::Parse { line, .. }) => line,
        other => panic!("{from}: {other:?}"),
    };
    assert_eq!(line_of("ascii", "ebcdic"), 2);
    assert_eq!(line_of("camera 1", "camera -1"), 5);
    assert_eq!(line_of("uchar float view", "uchar quad view"), 6);
    assert_eq!(line_of("comment", "commend"), 3);
    assert_eq!(line_of("element camera 1\n", ""), 5);
    assert_eq!(line_of("format ascii 1.0\n", ""), 20);
    assert_eq!(line_of("end_header", "comment"), 22);
    let empty = |text: String| {
        assert!(
            matches!(parse(text.as_bytes()), Err(MeshError::Empty { .. })),
            "{text}"
        )
    };
    empty(String::new());
    empty("plywood".to_owned());
    empty(ASCII.replace("double x", "double u"));
    empty(ASCII.replace("vertex_indices", "corners"));
    empty("ply\nformat ascii 1.0\nend_header\n".to_owned());
    let strips = ASCII.replace("element edge", "element tristrips");
    assert!(matches!(
        parse(strips.as_bytes()),
        Err(MeshError::Unsupported { .. })
    ));
}

#[test]
fn data_that_do_not_fit_the_header_are_named() {
    let more = ASCII.replace("vertex 4", "vertex 10000000");
    let error = parse(more.as_bytes()).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::CutOff {
                what: "vertices",
                promised: 10_000_000,
                ..
            }
        ),
        "{error}"
    );
    for index in ["-1", "1.5", "1e99"] {
        let text = ASCII.replace("3 1 2 3", &format!("3 1 2 {index}"));
        assert!(
            matches!(parse(text.as_bytes()), Err(MeshError::OutOfRange { .. })),
            "{index}"
        );
    }
    let beyond = ASCII.replace("3 1 2 3", "3 1 2 4");
    let error = parse(beyond.as_bytes()).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::IndexOutOfRange {
                face: 3,
                index: 4,
                count: 4
            }
        ),
        "{error}"
    );
    let two = ASCII.replace("0 3 0 1 3 2", "0 2 0 1 2");
    assert!(matches!(
        parse(two.as_bytes()),
        Err(MeshError::FaceTooShort { face: 1, count: 2 })
    ));
    let nan = ASCII.replace("255 1 0 0 1", "255 nan 0 0 1");
    assert!(matches!(
        parse(nan.as_bytes()),
        Err(MeshError::Parse { line: 24, .. })
    ));
    let mut nan = binary(false);
    let at = nan
        .windows(8)
        .position(|b| b == 1.0_f64.to_le_bytes())
        .unwrap();
    nan[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(matches!(
        parse(&nan),
        Err(MeshError::NotFinite { vertex: 1, .. })
    ));
    let longer = [binary(true), vec![1]].concat();
    assert!(matches!(parse(&longer), Err(MeshError::Unsupported { .. })));
}

#[test]
fn every_truncation_is_an_error() {
    for (file, needed) in [
        (ASCII.as_bytes().to_vec(), ASCII.len() - 1),
        (binary(false), binary(false).len()),
    ] {
        for length in 0..needed {
            assert!(parse(&file[..length]).is_err(), "{length}");
        }
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
