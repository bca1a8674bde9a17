use super::*;
use crate::catalogue::{CatalogueShape, Solid};
use crate::strategies::convex_polyhedra;
use proptest::prelude::*;

type Soup = (Vec<Point3>, Vec<Vec<u32>>);

fn points(coordinates: &[[f64; 3]]) -> Vec<Point3> {
    coordinates.iter().map(|&c| c.into()).collect()
}

/// A unit cube of six squares.
fn cube() -> Soup {
    let vertices = (0..8).map(|m| [m & 1, m >> 1 & 1, m >> 2].map(f64::from).into());
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    (vertices.collect(), faces.map(|f| f.to_vec()).to_vec())
}

/// Every facet with vertices of its own, as in STL, moved by up to `gap`.
fn loose((points, facets): Soup, gap: f64) -> Soup {
    let (mut own, mut loops) = (Vec::new(), Vec::new());
    for corners in facets {
        loops.push((own.len() as u32..(own.len() + corners.len()) as u32).collect());
        for v in corners {
            let shift = [0.1, 0.7, 0.4].map(|x| gap * (x + 0.3 * own.len() as f64).sin() / 3.0);
            own.push(points[v as usize] + crate::Vector3::from(shift));
        }
    }
    (own, loops)
}

fn close((points, facets): Soup, options: Options) -> Result<(Polyhedron, Report), MeshError> {
    solid(points, facets, &options)
}

fn refusal(soup: Soup) -> MeshError {
    close(soup, Options::default()).unwrap_err()
}

fn welded(weld: f64) -> Options {
    Options {
        weld: Some(weld),
        ..Options::default()
    }
}

#[test]
fn a_good_surface_is_left_as_it_is() {
    let (body, report) = close(cube(), Options::default()).unwrap();
    assert_eq!(body, Polyhedron::new(cube().0, cube().1).unwrap());
    assert!(!report.is_changed());
    assert_eq!(report.to_string(), "6 facets, 8 vertices read");
    let (repaired, report) = close(cube(), Options::REPAIR).unwrap();
    assert_eq!((repaired, report.is_changed()), (body, false));
}

#[test]
fn vertices_are_welded_within_the_distance_and_not_beyond() {
    let (body, report) = close(loose(cube(), 0.0), Options::default()).unwrap();
    assert_eq!((body.vertices().len(), report.vertices_welded), (8, 16));
    let (body, _) = close(loose(cube(), 1e-7), welded(1e-6)).unwrap();
    assert!((body.mass_properties().volume - 1.0).abs() < 1e-6);
    let error = refusal(loose(cube(), 1e-7));
    assert!(
        matches!(error, MeshError::OpenSurface { edges: 24, .. }),
        "{error}"
    );
    let triangles = triangulated(&Polyhedron::new(cube().0, cube().1).unwrap());
    assert!(close(loose(triangles.clone(), 1e-4), welded(1e-6)).is_err());
    let (body, _) = close(loose(triangles, 1e-4), welded(1e-3)).unwrap();
    assert_eq!((body.vertices().len(), body.face_count()), (8, 12));
    for bad in [-1.0, 1e-12, 0.5, f64::NAN] {
        let error = close(cube(), welded(bad)).unwrap_err();
        assert!(matches!(error, MeshError::OutOfRange { .. }), "{error}");
    }
}

#[test]
fn the_side_to_which_facets_look() {
    let mut mixed = cube();
    mixed.1[3].reverse();
    let (body, report) = close(mixed.clone(), Options::default()).unwrap();
    assert_eq!((report.facets_flipped, report.turned_outward), (1, false));
    assert!((body.mass_properties().volume - 1.0).abs() < 1e-15);
    let keep = Options {
        orient: Orient::Keep,
        ..Options::default()
    };
    let error = close(mixed, keep).unwrap_err();
    assert!(
        matches!(error, MeshError::InconsistentOrientation { .. }),
        "{error}"
    );

    let mut inside_out = cube();
    inside_out
        .1
        .iter_mut()
        .for_each(|corners| corners.reverse());
    for options in [keep, Options::default()] {
        let error = close(inside_out.clone(), options).unwrap_err();
        assert!(matches!(error, MeshError::InsideOut { .. }), "{error}");
    }
    let outward = Options {
        orient: Orient::Outward,
        ..Options::default()
    };
    for options in [outward, Options::REPAIR] {
        let (body, report) = close(inside_out.clone(), options).unwrap();
        assert!((body.mass_properties().volume - 1.0).abs() < 1e-15);
        assert!(report.turned_outward && report.is_changed());
    }
    // Most facets look inward, some do not: all are made to agree, then turned.
    inside_out.1[2].reverse();
    let (_, report) = close(inside_out, Options::default()).unwrap();
    assert_eq!((report.facets_flipped, report.turned_outward), (1, true));
}

#[test]
fn one_sided_surfaces_are_refused() {
    // The projective plane of six vertices and ten triangles.
    let facets = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 5],
        [0, 5, 1],
        [1, 2, 4],
        [2, 3, 5],
        [3, 4, 1],
        [4, 5, 2],
        [5, 1, 3],
    ];
    let vertices = points(&[
        [0., 0., 1.],
        [1., 0., 0.],
        [0.3, 1., 0.1],
        [-0.8, 0.6, 0.],
        [-0.8, -0.6, 0.2],
        [0.3, -1., 0.],
    ]);
    let error = refusal((vertices, facets.map(|f| f.to_vec()).to_vec()));
    assert!(matches!(error, MeshError::OneSided { .. }), "{error}");
}

#[test]
fn open_surfaces_are_refused_and_never_filled() {
    let mut open = cube();
    open.1.remove(4);
    for options in [Options::default(), Options::REPAIR] {
        match close(open.clone(), options) {
            Err(MeshError::OpenSurface { edges: 4, facets }) => {
                assert_eq!((facets.first, facets.count), (vec![0, 1, 2, 3], 4));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn facets_inside_the_body_and_parts_that_touch_are_named() {
    let mut wall = cube();
    wall.1.push(vec![0, 1, 7, 6]);
    match refusal(wall) {
        MeshError::NonManifoldFacets {
            what: "edge",
            facets,
            count: 2,
        } => {
            // Edges 0-1 and 6-7, each with the two squares of the cube there.
            assert_eq!(facets.first, [0, 1, 2, 3, 6]);
        }
        other => panic!("{other}"),
    }
    // Two cubes that share a corner.
    let (mut vertices, mut facets) = cube();
    vertices.extend(cube().0.iter().map(|p| p + crate::Vector3::repeat(1.0)));
    facets.extend(cube().1.iter().map(|f| f.iter().map(|v| v + 8).collect()));
    let error = refusal((vertices, facets));
    assert!(
        matches!(
            error,
            MeshError::Disconnected { components: 2 } | MeshError::NonManifoldFacets { .. }
        ),
        "{error}"
    );
}

/// A second unit cube, moved, with vertices of its own.
fn with_second(shift: [f64; 3]) -> Soup {
    let (mut vertices, mut facets) = cube();
    let shift = crate::Vector3::from(shift);
    vertices.extend(cube().0.iter().map(|p| p + shift));
    facets.extend(cube().1.iter().map(|f| f.iter().map(|v| v + 8).collect()));
    (vertices, facets)
}

#[test]
fn shells_that_share_faces_or_edges_are_counted() {
    for options in [Options::default(), Options::REPAIR] {
        for shift in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]] {
            let error = close(with_second(shift), options).unwrap_err();
            assert!(
                matches!(error, MeshError::Touching { shells: 2, .. }),
                "{error}"
            );
            assert!(
                error.to_string().contains("2 closed shells that touch"),
                "{error}"
            );
        }
    }
    // Vertices in common from the start: what touches is not known to be two shells.
    let (vertices, mut facets) = with_second([1.0, 1.0, 0.0]);
    for v in facets.iter_mut().flatten() {
        let same = |p: &Point3| *p == vertices[*v as usize];
        *v = vertices.iter().position(same).unwrap() as u32;
    }
    let error = refusal((vertices, facets));
    assert!(
        matches!(error, MeshError::NonManifoldFacets { .. }),
        "{error}"
    );
}

/// The same body twice, with vertices of its own, is no pair of shells that touch.
#[test]
fn a_whole_body_given_twice_is_one_body_on_request() {
    let twice = with_second([0.0; 3]);
    let error = refusal(twice.clone());
    assert!(
        matches!(error, MeshError::DuplicateFacets { .. }),
        "{error}"
    );
    let (body, report) = close(twice, Options::REPAIR).unwrap();
    assert_eq!((body.face_count(), report.facets_given_twice), (6, 6));
}

#[test]
fn degenerate_and_double_facets_are_named_and_dropped_on_request() {
    let (mut vertices, mut facets) = cube();
    vertices.push(Point3::new(0.5, 0.0, 0.0));
    facets.push(vec![0, 8, 1]);
    match refusal((vertices.clone(), facets.clone())) {
        MeshError::DegenerateFacets { facets } => assert_eq!(facets.first, [6]),
        other => panic!("{other}"),
    }
    let (body, report) = close((vertices, facets), Options::REPAIR).unwrap();
    assert_eq!((body.vertices().len(), report.facets_without_area), (8, 1));

    let mut double = cube();
    double.1.extend([vec![5, 4, 0, 1], vec![3, 1, 0, 2]]);
    match refusal(double.clone()) {
        MeshError::DuplicateFacets { facets } => assert_eq!(facets.first, [6, 7]),
        other => panic!("{other}"),
    }
    let (body, report) = close(double, Options::REPAIR).unwrap();
    assert_eq!((body.face_count(), report.facets_given_twice), (6, 2));
    assert!(report.to_string().ends_with("2 facets given twice dropped"));
}

#[test]
fn seams_are_joined_on_request() {
    // The top as four triangles about vertices on its sides, the sides left whole, off by a little.
    let (mut vertices, mut facets) = cube();
    vertices.extend(points(&[[0.5, 1e-6, 1.0], [1.0, 0.25, 1.0 - 1e-6]]));
    facets[1] = vec![4, 8, 5, 9, 7, 6];
    let error = refusal((vertices.clone(), facets.clone()));
    assert!(matches!(error, MeshError::OpenSurface { .. }), "{error}");
    let (body, report) = close((vertices, facets), Options::REPAIR).unwrap();
    assert_eq!((report.seams_joined, body.vertices().len()), (2, 10));
    assert!(report.is_changed() && report.facets_split >= 2);
    assert!((body.mass_properties().volume - 1.0).abs() < 1e-5);
    assert!(body.self_intersections(1).is_empty());
}

#[test]
fn a_zero_area_facet_in_a_seam_leaves_no_hole() {
    // Square 0 of the cube cut at the middle of a side, with a flat triangle filling the seam.
    let (mut vertices, mut facets) = cube();
    vertices.push(Point3::new(0.5, 0.0, 0.0));
    facets[0] = vec![8, 0, 2, 3, 1];
    facets.push(vec![0, 8, 1]);
    assert!(matches!(
        refusal((vertices.clone(), facets.clone())),
        MeshError::DegenerateFacets { .. }
    ));
    let (body, report) = close((vertices, facets), Options::REPAIR).unwrap();
    assert_eq!((report.facets_without_area, report.seams_joined), (1, 1));
    assert!((body.mass_properties().volume - 1.0).abs() < 1e-12);
}

#[test]
fn bent_polygons_are_cut_on_request() {
    let (mut vertices, facets) = cube();
    vertices[7] = Point3::new(1.2, 1.2, 1.3);
    assert!(matches!(
        refusal((vertices.clone(), facets.clone())),
        MeshError::NotPlanar { .. }
    ));
    let (body, report) = close((vertices, facets), Options::REPAIR).unwrap();
    assert_eq!((report.facets_split, body.face_count()), (3, 9));
}

#[test]
fn surfaces_that_cut_themselves_are_refused_by_name() {
    // A tetrahedron whose slanted side is drawn to a point below its base.
    let vertices = points(&[
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
        [0.4, 0.3, 1.0],
        [0.2, 0.2, -0.1],
    ]);
    let facets = [
        [0, 2, 1],
        [0, 1, 3],
        [0, 3, 2],
        [1, 2, 4],
        [2, 3, 4],
        [3, 1, 4],
    ];
    let soup = (vertices, facets.map(|f| f.to_vec()).to_vec());
    for options in [Options::default(), Options::REPAIR] {
        match close(soup.clone(), options) {
            Err(MeshError::SelfIntersecting { pairs }) => {
                assert!(
                    !pairs.is_empty() && pairs.iter().all(|pair| pair.contains(&0)),
                    "{pairs:?}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn messages_count_facets_as_given() {
    // A facet given twice in front: what is wrong behind it keeps its number.
    let (mut vertices, mut facets) = cube();
    vertices[7] = Point3::new(1.2, 1.2, 1.3);
    facets.swap(0, 1);
    facets.insert(0, vec![]);
    let error = refusal((vertices, facets));
    assert!(
        matches!(error, MeshError::DegenerateFacets { ref facets } if facets.first == [0]),
        "{error}"
    );
    let (vertices, mut facets) = cube();
    facets[2][1] = 99;
    let error = refusal((vertices, facets));
    assert!(
        matches!(
            error,
            MeshError::IndexOutOfRange {
                face: 2,
                index: 99,
                count: 8
            }
        ),
        "{error}"
    );
    let error = refusal((vec![], vec![]));
    assert!(
        matches!(error, MeshError::Size { .. } | MeshError::TooFew { .. }),
        "{error}"
    );
}

fn triangulated(body: &Polyhedron) -> Soup {
    let triangles = body.triangles().iter().map(|t| t.to_vec()).collect();
    (body.vertices().to_vec(), triangles)
}

proptest! {
    #[test]
    fn any_facets_turned_round_are_turned_back(
        body in convex_polyhedra(),
        turned in prop::collection::vec(any::<bool>(), 60),
        seed in any::<u64>(),
    ) {
        let mut soup = loose(triangulated(&body), 0.0);
        for (corners, turn) in soup.1.iter_mut().zip(turned.iter().cycle()) {
            if *turn {
                corners.reverse();
            }
        }
        let count = soup.1.len() as u64;
        soup.1.rotate_left((seed % count) as usize);
        let options = Options { orient: Orient::Outward, ..Options::default() };
        let (closed, report) = close(soup, options).unwrap();
        prop_assert!(2 * report.facets_flipped as u64 <= count);
        let ratio = closed.mass_properties().volume / body.mass_properties().volume;
        prop_assert!((ratio - 1.0).abs() < 1e-12);
        prop_assert!(closed.is_convex());
    }

    #[test]
    fn no_facets_panic(
        coordinates in prop::collection::vec(prop::array::uniform3(0..3_i32), 0..9),
        facets in prop::collection::vec(prop::collection::vec(0..9_u32, 0..5), 0..14),
        repair in any::<bool>(),
        weld in prop::sample::select(vec![None, Some(0.0), Some(1e-2)]),
    ) {
        let points: Vec<Point3> = coordinates.iter().map(|c| c.map(f64::from).into()).collect();
        let options = Options { weld, repair, ..Options::default() };
        if let Ok((body, _)) = solid(points, facets, &options) {
            prop_assert!(body.mass_properties().volume > 0.0);
            prop_assert!(body.self_intersections(1).is_empty());
        }
    }

    #[test]
    fn a_facet_lost_or_added_is_found(
        lost in any::<prop::sample::Index>(),
        solid in prop::sample::select(vec![Solid::P2, Solid::A4, Solid::A10]),
    ) {
        let body = CatalogueShape::from(solid).polyhedron(1.0).unwrap();
        let mut soup = triangulated(&body);
        let at = lost.index(soup.1.len());
        let removed = soup.1.remove(at);
        let open = close(soup.clone(), Options::REPAIR);
        prop_assert!(matches!(open, Err(MeshError::OpenSurface { edges: 3, .. })), "{:?}", open);
        soup.1.extend([removed.clone(), removed]);
        let double = close(soup.clone(), Options::default());
        prop_assert!(matches!(double, Err(MeshError::DuplicateFacets { .. })), "{:?}", double);
        prop_assert!(close(soup, Options::REPAIR).is_ok());
    }
}
