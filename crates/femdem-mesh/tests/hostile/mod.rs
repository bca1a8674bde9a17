//! Surfaces that are not bodies, in every format: each gives a named error, in time and memory bounded by the
//! length of the file.

mod scan;

use femdem_mesh::io::{self, Format, Options};
use femdem_mesh::{MeshError, Point3, Polyhedron};
use proptest::prelude::*;
use std::time::{Duration, Instant};

type Loops = Vec<Vec<u32>>;

/// A cube of 12 triangles.
fn cube() -> (Vec<Point3>, Loops) {
    let corners = (0..8).map(|m| Point3::from([m & 1, m >> 1 & 1, m >> 2].map(f64::from)));
    let squares = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = squares
        .iter()
        .flat_map(|&[a, b, c, d]| [vec![a, b, c], vec![a, c, d]]);
    (corners.collect(), triangles.collect())
}

fn number(x: f64) -> String {
    if x.is_nan() {
        "nan".to_owned()
    } else {
        x.to_string()
    }
}

/// Facets, good or not, as a file of a format.
fn file(format: Format, points: &[Point3], loops: &Loops) -> Vec<u8> {
    let row = |p: &Point3| [p.x, p.y, p.z].map(number).join(" ");
    let list = |l: &Vec<u32>, add: u32| {
        l.iter()
            .map(|v| (v + add).to_string())
            .collect::<Vec<_>>()
            .join(" ")
    };
    let (n, m) = (points.len(), loops.len());
    let mut text = String::new();
    match format {
        Format::Obj => {
            points
                .iter()
                .for_each(|p| text += &format!("v {}\n", row(p)));
            loops
                .iter()
                .for_each(|l| text += &format!("f {}\n", list(l, 1)));
        }
        Format::Off => {
            text += &format!("OFF\n{n} {m} 0\n");
            points.iter().for_each(|p| text += &format!("{}\n", row(p)));
            loops
                .iter()
                .for_each(|l| text += &format!("{} {}\n", l.len(), list(l, 0)));
        }
        Format::Ply => {
            text += &format!("ply\nformat ascii 1.0\nelement vertex {n}\nproperty double x\n");
            text += &format!("property double y\nproperty double z\nelement face {m}\n");
            text += "property list uchar int vertex_indices\nend_header\n";
            points.iter().for_each(|p| text += &format!("{}\n", row(p)));
            loops
                .iter()
                .for_each(|l| text += &format!("{} {}\n", l.len(), list(l, 0)));
        }
        Format::Stl => {
            text += "solid hostile\n";
            for l in loops {
                text += "facet normal 0 0 0\nouter loop\n";
                l.iter()
                    .for_each(|&v| text += &format!("vertex {}\n", row(&points[v as usize])));
                text += "endloop\nendfacet\n";
            }
            text += "endsolid hostile\n";
        }
    }
    text.into_bytes()
}

fn default(bytes: &[u8], format: Format) -> Result<Polyhedron, MeshError> {
    io::parse(bytes, format, &Options::default()).map(|(body, _)| body)
}

/// The same fault in every format.
fn each(points: &[Point3], loops: &Loops, expected: impl Fn(&MeshError) -> bool) {
    for format in Format::ALL {
        let Err(error) = default(&file(format, points, loops), format) else {
            panic!("{format:?}: accepted");
        };
        assert!(expected(&error), "{format:?}: {error}");
        assert!(error.to_string().len() < 300, "{error}");
    }
}

#[test]
fn a_good_cube_is_read_from_every_format() {
    let (points, loops) = cube();
    for format in Format::ALL {
        let body = default(&file(format, &points, &loops), format).unwrap();
        assert!((body.mass_properties().volume - 1.0).abs() < 1e-15);
    }
}

#[test]
fn empty_files() {
    for format in Format::ALL {
        for bytes in [&b""[..], b" \n\n", b"\0\0\0\0"] {
            let error = default(bytes, format).unwrap_err();
            let named = matches!(error, MeshError::Empty { .. } | MeshError::Parse { .. });
            assert!(named, "{format:?}: {error}");
        }
    }
}

#[test]
fn tiny_files_that_promise_ten_million_facets() {
    let stl = [&[0_u8; 80][..], &10_000_000_u32.to_le_bytes()].concat();
    let ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 10000000\nproperty float x\n\
        property float y\nproperty float z\nelement face 10000000\n\
        property list uchar int vertex_indices\nend_header\n\0\0\0\0";
    let start = Instant::now();
    assert!(matches!(
        default(&stl, Format::Stl),
        Err(MeshError::StlLength {
            promised: 10_000_000,
            found: 84,
            ..
        })
    ));
    assert!(matches!(
        default(ply, Format::Ply),
        Err(MeshError::CutOff {
            promised: 10_000_000,
            found: 0,
            ..
        })
    ));
    assert!(matches!(
        default(b"OFF\n10000000 10000000 0\n0 0 0\n", Format::Off),
        Err(MeshError::CutOff {
            promised: 10_000_000,
            found: 1,
            ..
        })
    ));
    let endless = "ply\nformat ascii 1.0\nelement a 18446744073709551615\nelement b 18446744073709551615\n\
        property list uint uint c\nend_header\n4294967295 1 2";
    assert!(matches!(
        default(endless.as_bytes(), Format::Ply),
        Err(MeshError::CutOff { .. })
    ));
    assert!(
        start.elapsed() < Duration::from_millis(200),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn coordinates_that_are_no_numbers() {
    for bad in [f64::NAN, f64::INFINITY] {
        let (mut points, loops) = cube();
        points[3].y = bad;
        each(&points, &loops, |e| {
            matches!(
                e,
                MeshError::Parse { .. } | MeshError::NotFinite { vertex: 3, .. }
            )
        });
    }
    let (mut points, loops) = cube();
    points[3].y = 1e200;
    each(&points, &loops, |e| matches!(e, MeshError::Size { .. }));
}

#[test]
fn facets_given_twice() {
    let (points, mut loops) = cube();
    loops.push(vec![2, 3, 0]);
    each(
        &points,
        &loops,
        |e| matches!(e, MeshError::DuplicateFacets { facets } if facets.first == [12]),
    );
}

#[test]
fn inside_out() {
    let (points, mut loops) = cube();
    loops.iter_mut().for_each(|l| l.reverse());
    each(&points, &loops, |e| {
        matches!(e, MeshError::InsideOut { .. })
    });
}

#[test]
fn open() {
    let (points, mut loops) = cube();
    loops.remove(5);
    each(
        &points,
        &loops,
        |e| matches!(e, MeshError::OpenSurface { edges: 3, facets } if facets.count == 3),
    );
}

#[test]
fn not_manifold() {
    let (points, mut loops) = cube();
    loops.extend([vec![0, 1, 7], vec![0, 7, 6]]);
    each(
        &points,
        &loops,
        |e| matches!(e, MeshError::NonManifoldFacets { facets, .. } if facets.first.contains(&1)),
    );
}

#[test]
fn self_intersecting() {
    // One corner of the cube drawn through the opposite one.
    let (mut points, loops) = cube();
    points[7] = Point3::new(-0.5, -0.6, -0.4);
    each(&points, &loops, |e| {
        matches!(e, MeshError::SelfIntersecting { pairs } if !pairs.is_empty())
            || matches!(e, MeshError::InsideOut { .. })
    });
    // Two facets that hardly cross: a dent that pierces the far side.
    let (mut points, mut loops) = cube();
    points.push(Point3::new(0.4, 0.3, -0.01));
    loops.splice(
        2..4,
        [vec![4, 5, 8], vec![5, 7, 8], vec![7, 6, 8], vec![6, 4, 8]],
    );
    each(&points, &loops, |e| match e {
        MeshError::SelfIntersecting { pairs } => {
            pairs.iter().all(|&[i, j]| i < 2 && (2..6).contains(&j))
        }
        _ => false,
    });
}

#[test]
fn zero_area() {
    let (mut points, mut loops) = cube();
    points.push(Point3::new(0.5, 0.5, 0.0));
    loops.push(vec![0, 8, 3]);
    each(
        &points,
        &loops,
        |e| matches!(e, MeshError::DegenerateFacets { facets } if facets.first == [12]),
    );
    let (mut points, loops) = cube();
    points.iter_mut().for_each(|p| p.z = 0.0);
    each(&points, &loops, |e| {
        matches!(
            e,
            MeshError::DegenerateFacets { .. } | MeshError::DuplicateFacets { .. }
        )
    });
    points
        .iter_mut()
        .for_each(|p| *p = Point3::new(1.0, 2.0, 3.0));
    each(&points, &loops, |e| matches!(e, MeshError::Size { .. }));
}

#[test]
fn vertex_numbers_that_do_not_exist() {
    let (points, mut loops) = cube();
    loops[4][1] = 4_000_000_000;
    for format in [Format::Obj, Format::Off, Format::Ply] {
        let error = default(&file(format, &points, &loops), format).unwrap_err();
        let named = matches!(
            error,
            MeshError::Parse { .. }
                | MeshError::IndexOutOfRange { face: 4, .. }
                | MeshError::OutOfRange { .. }
        );
        assert!(named, "{format:?}: {error}");
    }
}

#[test]
fn text_that_is_no_text_and_lines_without_end() {
    for format in Format::ALL {
        let (points, loops) = cube();
        let good = String::from_utf8(file(format, &points, &loops)).unwrap();
        let bad = good.replacen("1 0 0", "1 \u{fffd} 0", 1).into_bytes();
        let bad: Vec<u8> = bad
            .into_iter()
            .map(|b| if b > 127 { 0xff } else { b })
            .collect();
        let error = default(&bad, format).unwrap_err();
        assert!(
            matches!(error, MeshError::Parse { .. }),
            "{format:?}: {error}"
        );
        // Brackets in brackets, and a megabyte in one word, after a good start.
        for filler in ["(", "9", " 1", "\\ \n", "/"] {
            let long = good.replacen("1 0 0", &filler.repeat(1 << 20), 1);
            let start = Instant::now();
            if let Err(error) = default(long.as_bytes(), format) {
                assert!(error.to_string().len() < 300, "{error}");
            }
            assert!(
                start.elapsed() < Duration::from_secs(5),
                "{format:?} {filler}"
            );
        }
    }
}

#[test]
fn polygons_of_very_many_corners_are_refused() {
    let n = 2000;
    let ring = |z: f64| {
        (0..n).map(move |i| {
            let a = f64::from(i) * std::f64::consts::TAU / f64::from(n);
            let r = if i % 2 == 0 { 1.0 } else { 0.9 };
            Point3::new(r * a.cos(), r * a.sin(), z)
        })
    };
    let points: Vec<Point3> = ring(0.0).chain(ring(1.0)).collect();
    let n = n as u32;
    let mut loops: Loops = (0..n)
        .map(|i| vec![i, (i + 1) % n, (i + 1) % n + n, i + n])
        .collect();
    loops.extend([(0..n).rev().collect(), (n..2 * n).collect()]);
    for format in [Format::Obj, Format::Off] {
        let error = default(&file(format, &points, &loops), format).unwrap_err();
        assert!(
            matches!(error, MeshError::TooMany { count: 2000, .. }),
            "{error}"
        );
    }
}

#[test]
fn a_scan_of_two_thousand_triangles() {
    let (points, triangles) = scan::stone(4);
    let bytes = scan::binary_stl(&points, &triangles);
    let (body, report) = io::parse(&bytes, Format::Stl, &Options::default()).unwrap();
    assert_eq!(
        (report.facets, report.vertices_welded, report.is_changed()),
        (2048, 3 * 2048 - 1026, false)
    );
    // As a scanner leaves it: facets turned round, lost in seams, given twice, without area.
    let mut spoilt = triangles.clone();
    spoilt.iter_mut().step_by(7).for_each(|t| t.swap(0, 1));
    spoilt.push(triangles[11]);
    spoilt.push([triangles[3][0], triangles[3][0], triangles[3][1]]);
    let bytes = scan::binary_stl(&points, &spoilt);
    assert!(default(&bytes, Format::Stl).is_err());
    let (mended, report) = io::parse(&bytes, Format::Stl, &Options::REPAIR).unwrap();
    // Loops that were turned back start at another vertex: sums round differently.
    let ratio = mended.mass_properties().volume / body.mass_properties().volume;
    assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
    assert_eq!(report.facets_given_twice + report.facets_without_area, 2);
    assert_eq!(report.facets_flipped, 2048_usize.div_ceil(7));
}

proptest! {
    #[test]
    fn no_changed_byte_panics(
        format in prop::sample::select(Format::ALL.to_vec()),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5),
        cut in any::<prop::sample::Index>(),
        repair in any::<bool>(),
    ) {
        let (points, loops) = cube();
        let mut bytes = file(format, &points, &loops);
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        let options = Options { repair, ..Options::default() };
        for end in [bytes.len(), cut.index(bytes.len())] {
            if let Ok((body, _)) = io::parse(&bytes[..end], format, &options) {
                prop_assert!(body.mass_properties().volume > 0.0);
            }
        }
    }

    #[test]
    fn no_bytes_panic(
        format in prop::sample::select(Format::ALL.to_vec()),
        start in prop::sample::select(vec!["", "OFF\n", "solid a\n", "v 0 0 0\nf ",
            "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty char x\nproperty char y\nproperty char z\nelement face 4\nproperty list char char vertex_index\nend_header\n"]),
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let bytes = [start.as_bytes(), &bytes].concat();
        if let Ok((body, _)) = io::parse(&bytes, format, &Options::REPAIR) {
            prop_assert!(body.mass_properties().volume > 0.0);
        }
    }
}
