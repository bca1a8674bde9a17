//! The catalogue against reference numbers held in `tests/data/solids.json`, to 1e-12.

use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::{Matrix3, Point3, Polyhedron};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};

#[derive(Deserialize)]
struct Reference {
    name: String,
    volume: f64,
    area: f64,
    inertia_unit_density: f64,
    inradius: f64,
    n_edges: usize,
    vertices: Vec<Point3>,
    faces: Vec<Vec<usize>>,
}

fn references() -> Vec<(CatalogueShape, Reference)> {
    #[derive(Deserialize)]
    struct File {
        solids: BTreeMap<CatalogueShape, Reference>,
    }
    let file: Result<File, _> = serde_json::from_str(include_str!("data/solids.json"));
    let file = file.unwrap_or_else(|error| panic!("the reference is not as expected: {error}"));
    file.solids.into_iter().collect()
}

fn assert_close(what: &str, shape: CatalogueShape, value: f64, expected: f64) {
    let relative = (value / expected - 1.0).abs();
    assert!(
        relative < 1e-12,
        "{shape}: {what} {value} instead of {expected} ({relative:e})"
    );
}

/// Index in the reference of each vertex of the body.
fn matched(shape: CatalogueShape, body: &Polyhedron, reference: &[Point3]) -> Vec<usize> {
    let nearest = |v: &Point3| {
        let same = reference.iter().position(|r| (v - r).norm() < 1e-12);
        same.unwrap_or_else(|| panic!("{shape}: vertex {v} is not in the reference"))
    };
    body.vertices().iter().map(nearest).collect()
}

/// A loop turned so that it starts with its smallest entry.
fn canonical(mut face: Vec<usize>) -> Vec<usize> {
    let start = (0..face.len()).min_by_key(|&k| face[k]).unwrap_or(0);
    face.rotate_left(start);
    face
}

#[test]
fn holds_the_eighteen_solids_and_two_mirror_images() {
    let shapes: BTreeSet<_> = CatalogueShape::all_with_mirror_images().collect();
    let expected: BTreeSet<_> = references().into_iter().map(|(shape, _)| shape).collect();
    assert_eq!(shapes, expected);
    assert_eq!(CatalogueShape::all().len(), 18);
}

#[test]
fn vertices_and_faces_are_those_of_the_reference() {
    for (shape, reference) in references() {
        let body = shape.polyhedron(2.0).unwrap();
        let index = matched(shape, &body, &reference.vertices);
        let different: BTreeSet<_> = index.iter().collect();
        assert_eq!(different.len(), reference.vertices.len(), "{shape}");

        let faces: BTreeSet<_> = body
            .faces()
            .map(|face| canonical(face.iter().map(|&v| index[v as usize]).collect()))
            .collect();
        let expected: BTreeSet<_> = reference.faces.into_iter().map(canonical).collect();
        assert_eq!(faces, expected, "{shape}");
        assert_eq!(body.edges().len(), reference.n_edges, "{shape}");
        assert_eq!(body.euler_characteristic(), 2, "{shape}");
        assert!(body.is_convex(), "{shape}");
    }
}

#[test]
fn integrals_are_those_of_the_reference() {
    for (shape, reference) in references() {
        let body = shape.polyhedron(2.0).unwrap();
        let mass = body.mass_properties();
        assert_eq!(shape.name(), reference.name);
        assert_close("volume", shape, mass.volume, reference.volume);
        assert_close("area", shape, body.area(), reference.area);
        assert_close("inradius", shape, body.inradius(), reference.inradius);
        assert_close("circumradius", shape, body.bounding_radius(), 1.0);
        let inertia = Matrix3::identity() * reference.inertia_unit_density;
        let error = (mass.inertia - inertia).amax() / reference.inertia_unit_density;
        assert!(error < 1e-12, "{shape}: inertia off by {error:e}");
        assert!(
            mass.centroid.coords.amax() < 1e-15,
            "{shape}: {}",
            mass.centroid
        );
        assert_eq!(mass.principal().rotation.angle(), 0.0, "{shape}");
    }
}

#[test]
fn edges_are_all_of_one_length() {
    for shape in CatalogueShape::all_with_mirror_images() {
        let body = shape.polyhedron(0.013).unwrap();
        let v = body.vertices();
        let lengths: Vec<f64> = body
            .edges()
            .iter()
            .map(|&[a, b]| (v[a as usize] - v[b as usize]).norm())
            .collect();
        for length in &lengths {
            assert_close("edge", shape, *length, lengths[0]);
        }
    }
}

#[test]
fn diameters_from_tiny_to_huge_give_the_same_body_scaled() {
    for shape in CatalogueShape::all_with_mirror_images() {
        let unit = shape.polyhedron(1.0).unwrap();
        for diameter in [1e-20, 1e-9, 3.7e-3, 1e6, 1e20] {
            let body = shape.polyhedron(diameter).unwrap();
            assert_eq!(body.face_count(), unit.face_count());
            assert_close(
                "volume",
                shape,
                body.mass_properties().volume / diameter.powi(3),
                unit.mass_properties().volume,
            );
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-21, 1e21] {
            let message = shape.polyhedron(bad).unwrap_err().to_string();
            assert!(message.contains("diameter"), "{message}");
        }
    }
}

#[test]
fn names_and_identifiers_are_read_back() {
    for shape in CatalogueShape::all_with_mirror_images() {
        let hyphenated = shape.name().replace(' ', "-");
        let lower = shape.id().to_lowercase();
        for text in [shape.id(), lower, shape.name().to_owned(), hyphenated] {
            assert_eq!(text.parse::<CatalogueShape>().unwrap(), shape, "{text}");
        }
        let json = serde_json::to_string(&shape).unwrap();
        assert_eq!(json, format!("\"{shape}\""));
        assert_eq!(
            serde_json::from_str::<CatalogueShape>(&json).unwrap(),
            shape
        );
    }
    assert_eq!(serde_json::to_string(&Solid::A10).unwrap(), "\"A10\"");
    for wrong in ["", "A14", "P0", "P5m", "sphere", "A10 "] {
        match wrong.parse::<CatalogueShape>() {
            Ok(shape) => assert_eq!((wrong, shape.to_string()), ("A10 ", "A10".to_owned())),
            Err(error) => assert!(
                error.to_string().contains("truncated octahedron"),
                "{error}"
            ),
        }
    }
}

#[test]
fn a_chiral_solid_is_not_its_mirror_image_and_the_others_are() {
    for shape in CatalogueShape::all() {
        let body = shape.polyhedron(2.0).unwrap();
        let point_image = |v: &Point3| Point3::new(-v.x, v.y, v.z);
        // Solids of the tetrahedral family are their own image in the plane x = y instead.
        let diagonal_image = |v: &Point3| Point3::new(v.y, v.x, v.z);
        let same = |image: &dyn Fn(&Point3) -> Point3| {
            body.vertices().iter().all(|v| {
                let image = image(v);
                body.vertices().iter().any(|w| (w - image).norm() < 1e-12)
            })
        };
        let symmetric = same(&point_image) || same(&diagonal_image);
        assert_eq!(symmetric, !shape.solid.is_chiral(), "{shape}");
    }
}
