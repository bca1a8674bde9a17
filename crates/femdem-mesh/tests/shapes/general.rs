//! Properties of every shape; names, text and refusals.

use super::body;
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::shapes::{Boulder, Clump, ClumpSpheres, Cylinder, Dolos, Shape, Sphere, listing};
use femdem_mesh::{MeshError, Point3};

/// Family, whether convex, whether the centroid sees all of it, holes through it.
const FAMILIES: [(&str, bool, bool, i64); 14] = [
    ("sphere", true, true, 0),
    ("ellipsoid", true, true, 0),
    ("superquadric", true, true, 0),
    ("box", true, true, 0),
    ("rounded_cube", true, true, 0),
    ("cylinder", true, true, 0),
    ("hollow_cylinder", false, false, 1),
    ("pellet", false, false, 7),
    ("lobed", false, true, 0),
    ("boulder", true, true, 0),
    ("antifer", false, false, 0),
    ("dolos", false, false, 0),
    ("tetrapod", false, true, 0),
    ("clump", false, true, 0),
];

#[test]
fn default_shapes_are_as_they_are_said_to_be() {
    let shapes = Shape::all();
    assert_eq!(shapes.len(), FAMILIES.len());
    for (shape, (name, convex, star_shaped, holes)) in shapes.iter().zip(FAMILIES) {
        assert_eq!(shape.name(), name);
        let body = shape.polyhedron(1.0).unwrap();
        assert_eq!(body.is_convex(), convex, "{name}");
        // The centroid lies behind every face's plane.
        assert_eq!(body.inradius() > 0.0, star_shaped, "{name}");
        assert_eq!(body.euler_characteristic(), 2 - 2 * holes, "{name}");
        let centroid = body.mass_properties().centroid.coords.amax();
        assert!(centroid < 1e-15, "{name}: centroid at {centroid:e}");
        assert_eq!(body.self_intersections(1), [[0; 2]; 0], "{name}");
    }
}

#[test]
fn lobes_and_tetrapods_are_star_shaped_whatever_their_parameters() {
    for lobes in 2..=8 {
        for spacing in [0.3, 0.6, 0.85, 0.97] {
            for segments in [3, 12, 64] {
                let text = format!("lobed:lobes={lobes},spacing={spacing},segments={segments}");
                assert!(body(&text, 1.0).inradius() > 0.0, "{text}");
            }
        }
    }
    for (foot, root) in [(0.2, 0.37), (0.2, 0.6), (0.36, 0.37), (0.36, 0.6)] {
        let text = format!("tetrapod:foot={foot},root={root}");
        assert!(body(&text, 1.0).inradius() > 0.0, "{text}");
    }
}

#[test]
fn convex_families_are_convex_whatever_their_parameters() {
    for text in [
        "sphere:level=0",
        "ellipsoid:width=0.05,height=20",
        "superquadric:n1=2,n2=20",
        "superquadric:n1=20,n2=2,width=20,aspect=0.05",
        "superquadric:n1=11,n2=17,cells=2",
        "superquadric:n1=20,n2=5,cells=40",
        "box:width=100,height=0.01",
        "rounded_cube:radius=0.005,segments=16",
        "rounded_cube:radius=0.45,segments=1",
        "cylinder:sides=256,aspect=0.02",
        "boulder:angularity=1,elongation=0.4,flatness=0.4",
    ] {
        assert!(body(text, 1.0).is_convex(), "{text}");
    }
}

#[test]
fn genus_follows_the_holes() {
    for (text, holes) in [
        ("pellet:holes=4,hole=0.2,centre=false", 4),
        ("pellet:holes=4,hole=0.2", 5),
        ("pellet:holes=18,hole=0.08,pitch=0.8", 19),
        (
            "pellet:holes=2,hole=0.3,pitch=0.5,centre=false,hole_sides=5,sides=7",
            2,
        ),
        ("hollow_cylinder:sides=7,bore=0.9,aspect=5", 1),
    ] {
        assert_eq!(
            body(text, 1.0).euler_characteristic(),
            2 - 2 * holes,
            "{text}"
        );
    }
}

#[test]
fn sizes_are_the_lengths_they_are_said_to_be() {
    let extent = |text: &str, axis: usize| {
        let body = body(text, 0.03);
        let along = |v: &Point3| v[axis];
        let high = body.vertices().iter().map(along).fold(f64::MIN, f64::max);
        let low = body.vertices().iter().map(along).fold(f64::MAX, f64::min);
        high - low
    };
    for (text, axis, expected) in [
        ("superquadric:n1=3,n2=9,width=0.5,aspect=2", 0, 0.03),
        ("superquadric:n1=3,n2=9,width=0.5,aspect=2", 1, 0.015),
        ("superquadric:n1=3,n2=9,width=0.5,aspect=2", 2, 0.06),
        ("box:width=3,height=0.2", 0, 0.03),
        ("box:width=3,height=0.2", 1, 0.09),
        ("rounded_cube", 0, 0.03),
        ("cylinder:aspect=2", 0, 0.03),
        ("cylinder:aspect=2", 2, 0.06),
        ("hollow_cylinder", 1, 0.03),
        ("pellet:aspect=0.3", 2, 0.009),
        ("lobed:lobes=4", 0, 0.03),
        ("antifer", 2, 0.03),
        ("dolos", 0, 0.03),
        ("dolos", 1, 0.03),
        ("dolos:waist=0.4", 2, 0.03),
        ("tetrapod", 2, 0.03),
        ("tetrapod:foot=0.25,root=0.4,sides=24", 2, 0.03),
    ] {
        let found = extent(text, axis);
        assert!(
            (found - expected).abs() < 1e-12,
            "{text}, axis {axis}: {found} instead of {expected}"
        );
    }
    // The icosahedron has no vertices on the axes of x, y, z.
    let sphere = body("sphere", 0.03);
    for v in sphere.vertices() {
        assert!((v.coords.norm() - 0.015).abs() < 1e-16);
    }
}

#[test]
fn text_is_read_back() {
    let mut shapes = Shape::all();
    shapes.push(
        Cylinder {
            aspect: 2.0,
            sides: 24,
        }
        .into(),
    );
    shapes.push(Dolos { waist: 0.37 }.into());
    shapes.push(
        Boulder {
            seed: u64::MAX,
            angularity: 0.1 + 0.2,
            ..Boulder::default()
        }
        .into(),
    );
    shapes.push(CatalogueShape::from(Solid::A3).into());
    for shape in shapes {
        for text in [
            shape.to_string(),
            format!("{shape:#}"),
            shape.to_string().to_uppercase(),
        ] {
            if text.contains('=') && text.chars().all(|c| !c.is_lowercase()) {
                continue;
            }
            assert_eq!(text.parse::<Shape>().unwrap(), shape, "{text}");
        }
        let json = serde_json::to_string(&shape).unwrap();
        assert_eq!(json, format!("\"{shape:#}\""));
        assert_eq!(serde_json::from_str::<Shape>(&json).unwrap(), shape);
    }
    let short = Shape::from(Cylinder {
        aspect: 2.0,
        sides: 24,
    });
    assert_eq!(short.to_string(), "cylinder:aspect=2,sides=24");
    assert_eq!(Shape::from(Sphere::default()).to_string(), "sphere");
    assert_eq!(
        " Hollow-Cylinder : sides = 8 , bore = 0.25 "
            .parse::<Shape>()
            .unwrap(),
        "hollow_cylinder:bore=0.25,sides=8".parse().unwrap()
    );
    assert_eq!(
        "trilobe".parse::<Shape>().unwrap(),
        "lobed:lobes=3".parse().unwrap()
    );
    assert_eq!(
        "quadrilobe".parse::<Shape>().unwrap(),
        "lobed:lobes=4".parse().unwrap()
    );
    assert_eq!(
        "A10"
            .parse::<Shape>()
            .unwrap()
            .polyhedron(1.0)
            .unwrap()
            .face_count(),
        32
    );
}

#[test]
fn refusals_name_the_value_and_what_is_allowed() {
    for (text, parts) in [
        ("dolosse", vec!["dolosse", "dolos", "tetrapod", "P1"]),
        ("dolos:wasit=0.3", vec!["dolos", "wasit", "waist"]),
        ("cylinder:size=3", vec!["size", "aspect, sides"]),
        ("dolos:waist=0.6", vec!["waist", "0.6", "0.25 to 0.42"]),
        ("dolos:waist=NaN", vec!["waist", "NaN"]),
        ("dolos:waist", vec!["waist", "0.25 to 0.42"]),
        ("sphere:level=-1", vec!["level", "-1", "0 to 5"]),
        ("sphere:level=2,level=3", vec!["level", "second time"]),
        (
            "pellet:centre=maybe",
            vec!["centre", "maybe", "false to true"],
        ),
        ("clump:spheres=0 0 0", vec!["spheres", "0 0 0"]),
        ("P5:aspect=2", vec!["P5", "aspect", "none"]),
    ] {
        let message = text.parse::<Shape>().unwrap_err().to_string();
        for part in parts {
            assert!(message.contains(part), "{text}: {message}");
        }
    }
    for (text, part) in [
        (
            "pellet:hole=0.3,pitch=0.5",
            "wall between neighbouring holes",
        ),
        ("pellet:hole=0.3,holes=3,pitch=0.8", "outside"),
        ("pellet:hole=0.2,holes=2,pitch=0.3", "middle hole"),
        ("clump:spheres=0 0 0 1/3 0 0 1", "2 separate closed shells"),
        (
            "clump:spheres=0 0 0 0.01/99 0 0 100,cells=10",
            "cells of the lattice",
        ),
    ] {
        let shape: Shape = text.parse().unwrap();
        let message = shape.polyhedron(1.0).unwrap_err().to_string();
        assert!(message.contains(part), "{text}: {message}");
    }
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e21] {
        let error = Shape::from(Sphere::default()).polyhedron(size).unwrap_err();
        assert!(matches!(error, MeshError::OutOfRange { .. }), "{error}");
    }
    // Parameters set in the struct are checked as well.
    let error = Shape::from(Dolos { waist: f64::NAN })
        .polyhedron(1.0)
        .unwrap_err();
    assert!(matches!(error, MeshError::BadParameter { .. }), "{error}");
    let clump = Clump {
        spheres: ClumpSpheres(Vec::new()),
        ..Clump::default()
    };
    assert!(Shape::from(clump).polyhedron(1.0).is_err());
    assert!(Boulder::size_for_mass(-1.0, 2700.0).is_err());
    assert!(Boulder::size_for_mass(1.0, f64::NAN).is_err());
    assert!(Shape::from(Sphere::default()).size_for_volume(0.0).is_err());
}

#[test]
fn scaling_is_that_of_the_unit_body() {
    for shape in Shape::all() {
        let unit = shape.polyhedron(1.0).unwrap();
        for size in [1e-20, 1e-6, 3.0, 1e20] {
            let body = shape.polyhedron(size).unwrap();
            let ratio = body.mass_properties().volume / unit.mass_properties().volume;
            super::assert_near(&shape.to_string(), ratio, size.powi(3), 1e-12);
        }
        let size = shape.size_for_volume(2e-3).unwrap();
        let volume = shape.polyhedron(size).unwrap().mass_properties().volume;
        super::assert_near(&shape.to_string(), volume, 2e-3, 1e-12);
    }
}

#[test]
fn the_listing_names_every_parameter() {
    let text = listing();
    for shape in Shape::all() {
        assert!(text.contains(&format!("{}: {}", shape.name(), shape.summary())));
        assert!(text.contains(&format!("    size: {}", shape.size_meaning())));
        for p in shape.parameters() {
            let line = format!("    {} = {} ({})", p.name, p.default, p.range);
            assert!(text.contains(&line), "{line}");
            assert!(text.contains(&p.meaning) && !p.meaning.is_empty());
        }
    }
}
