//! Densities in spheres, and regions cut from regions.

use crate::common::{Random, at, cube, solid, turned_lattice};
use femdem_analysis::{
    AnalysisError, CoreOptions, Pack, Region, choose_core, exact_density, grid_density,
    volume_inside,
};
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Vector3};

fn sphere(centre: [f64; 3], radius: f64) -> Region {
    Region::Sphere {
        centre: Point3::from(centre),
        radius,
    }
}

/// Cubes that fill space fill every sphere in it; a grid agrees within its stated error.
#[test]
fn stacked_cubes_fill_a_sphere() {
    let node = f64::from;
    let bodies = at((0..729).map(|i| Vector3::new(node(i % 9), node(i / 9 % 9), node(i / 81))));
    let shapes = [cube(1.0)];
    let pack = Pack::new(&shapes, &bodies).unwrap();
    for (centre, radius) in [([4.0; 3], 4.0), ([3.7, 4.1, 4.3], 2.9), ([4.5; 3], 0.2)] {
        let found = exact_density(&pack, &sphere(centre, radius)).unwrap();
        assert!((found.density - 1.0).abs() < 1e-9, "{found:?}");
    }
}

/// The grid counts cells one by one and is thus independent of the closed form.
#[test]
fn the_grid_agrees_in_a_sphere() {
    let mut random = Random(11);
    let dolos = Shape::from(Dolos::default()).polyhedron(1.0).unwrap();
    for shapes in [[solid("A10", 1.0)], [dolos]] {
        // Bodies overlap in places, so that pairs on the sphere matter.
        let bodies = turned_lattice(&mut random, 1, 8, 0.85);
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let mut squares = 0.0;
        for k in 0..6 {
            let region = sphere(
                [3.0, 2.9, 2.8 + 0.1 * f64::from(k)],
                1.3 + 0.2 * f64::from(k),
            );
            let exact = exact_density(&pack, &region).unwrap();
            let grid = grid_density(&pack, &region, 0.03).unwrap();
            squares += ((exact.density - grid.density) / grid.error).powi(2);
        }
        assert!(
            squares / 6.0 < 4.0,
            "mean square {} of the stated",
            squares / 6.0
        );
    }
}

#[test]
fn a_body_is_inside_a_sphere_in_part() {
    let half = volume_inside(
        &cube(2.0),
        &femdem_mesh::Pose::translation(1.0, 0.0, 0.0),
        &sphere([0.0; 3], 0.5),
    );
    let expected = std::f64::consts::PI / 12.0;
    assert!((half.unwrap() - expected).abs() < 1e-12);
}

#[test]
fn insets_and_slabs() {
    let tank = Region::Box {
        min: Point3::origin(),
        max: Point3::new(4.0, 5.0, 6.0),
    };
    let core = tank.inset(1.5).unwrap();
    assert_eq!(
        core.corners(),
        (Point3::new(1.5, 1.5, 1.5), Point3::new(2.5, 3.5, 4.5))
    );
    assert!(matches!(
        tank.inset(2.0),
        Err(AnalysisError::Region {
            name: "max.x - min.x",
            ..
        })
    ));
    assert_eq!(
        sphere([1.0; 3], 3.0).inset(1.0).unwrap(),
        sphere([1.0; 3], 2.0)
    );
    // A slab does not reach beyond its region.
    assert_eq!(tank.slab(-1.0, 2.0).unwrap().volume(), 40.0);
    assert!(tank.slab(2.0, 2.0).is_err() && tank.slab(f64::NAN, 2.0).is_err());
    assert!(matches!(
        sphere([0.0; 3], 1.0).slab(0.0, 0.5),
        Err(AnalysisError::RegionKind { .. })
    ));
}

#[test]
fn a_sphere_is_no_container() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::zeros()]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let refused = choose_core(&pack, &sphere([0.0; 3], 2.0), &CoreOptions::default());
    assert!(matches!(refused, Err(AnalysisError::RegionKind { .. })));
}
