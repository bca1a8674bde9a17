//! Closed surfaces of periodic packs: equal on opposite sides.

use crate::common::pores::{cuboid, region, space};
use crate::common::{Random, at, solid, turned_lattice};
use femdem_analysis::pores::*;
use femdem_analysis::*;
use femdem_mesh::shapes::{Dolos, Shape};
use femdem_mesh::{Point3, Vector3};

/// Triangles of a part, moved, by corners that are sorted.
fn sorted(surface: &Surface, part: SurfacePatch, way: Vector3) -> Vec<[[i64; 3]; 3]> {
    let key = |p: Point3| [0, 1, 2].map(|k| ((p[k] + way[k]) * 1e9).round() as i64);
    let mut found: Vec<_> = surface
        .part(part)
        .map(|triangle| {
            let mut corners = triangle.map(key);
            corners.sort_unstable();
            corners
        })
        .collect();
    found.sort_unstable();
    found
}

/// Bodies in a corner and over edges of the cell, with a bridge through a face: the surface of the void is closed, has the volume
/// of the image, and equal triangles on opposite sides.
#[test]
fn opposite_sides_of_the_void_have_the_same_triangles() {
    let shapes = [solid("A10", 0.8)];
    let mut bodies = turned_lattice(&mut Random(5), 1, 2, 0.8);
    bodies.truncate(5);
    for sides in [
        [Some(1.987); 3],
        [Some(1.987), Some(1.987), None],
        [Some(1.987), None, None],
    ] {
        let cell = region([-0.313, -0.207, -0.911], [1.674, 1.78, 1.076]);
        let around = PeriodicSpace {
            lower: cell.corners().0,
            ..space(sides)
        };
        let images = WithImages::new(&shapes, &bodies, &around, &cell, 1.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        let solids = Solids::new(&pack);
        let image = voxel_image(&solids, &cell, 0.04).unwrap();
        let distances = signed_distance(&solids, &image, Sides::Open);
        let bridge = Bridge {
            point: Point3::new(-0.29, 0.9, 0.1),
            normal: Vector3::x(),
            radius: 0.1,
        };
        let surface = void_surface(&image, &distances, &[bridge]).unwrap();
        let check = surface.check();
        assert!(check.is_closed() && check.degenerate == 0, "{check:?}");
        let exact = cell.volume() * (1.0 - exact_density(&pack, &cell).unwrap().density);
        assert!(
            (check.volume / exact - 1.0).abs() < 3e-3,
            "{} {exact}",
            check.volume
        );
        let (low, high) = surface_region(&image).corners();
        for (k, [near, far]) in [
            [SurfacePatch::XLow, SurfacePatch::XHigh],
            [SurfacePatch::YLow, SurfacePatch::YHigh],
            [SurfacePatch::Low, SurfacePatch::High],
        ]
        .into_iter()
        .enumerate()
        {
            let mut way = Vector3::zeros();
            way[k] = high[k] - low[k];
            let [a, b] =
                [(near, way), (far, Vector3::zeros())].map(|(p, w)| sorted(&surface, p, w));
            if sides[k].is_some() {
                assert!(
                    a.len() > 100 && a == b,
                    "{sides:?} {k}: {} {}",
                    a.len(),
                    b.len()
                );
            } else {
                assert_eq!(a.is_empty(), k < 2);
            }
        }
    }
}

/// Caps of bodies at a face are those of their images at the other face, also where the partner lies wholly beyond it.
#[test]
fn bodies_at_opposite_faces_are_cut_alike() {
    let shapes = [cuboid([-0.5; 3], [0.5; 3])];
    // Face to face at x = 0, the face of the cell.
    let bodies = at([Vector3::new(0.4995, 0.5, 0.5), Vector3::new(2.5, 0.5, 0.5)]);
    let cell = region([0.0; 3], [3.0; 3]);
    let around = space([Some(3.0); 3]);
    let images = WithImages::new(&shapes, &bodies, &around, &cell, 0.5).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let found = facet_surface(&pack, &cell, Sides::Wall, Treatment::Cap(0.01)).unwrap();
    // The gap lies about x = -0.00025 and 2.99975, and there are no walls.
    for middle in [-0.00025, 2.99975] {
        let off = |p: &Point3| p.x - middle;
        let near = found
            .surface
            .vertices
            .iter()
            .map(off)
            .filter(|x| x.abs() < 0.1);
        let nearest = near.map(f64::abs).fold(f64::INFINITY, f64::min);
        assert!((nearest - 0.005).abs() < 1e-9, "{nearest}");
    }
    assert!((found.surface.check().volume / found.volume - 1.0).abs() < 1e-6);
    // Their images are no other bodies; those lie beyond the faces.
    assert_eq!((found.bodies, found.changed, found.beyond), (2, 2, 2));
}

/// A bridge is joined to the void of every region that an image of it lies in: narrower than the cell, across its faces, and
/// periods off.
#[test]
fn bridges_have_images_as_bodies_have() {
    let shapes = [cuboid([0.45, -9.0, -9.0], [0.55, 9.0, 9.0])];
    let around = space([Some(1.0), None, None]);
    let bridge = Bridge {
        point: Point3::new(0.9, 0.25, 0.25),
        normal: Vector3::y(),
        radius: 0.08,
    };
    let exact = 2.0 * std::f64::consts::PI * bridge.radius.powi(3);
    for [low, high] in [
        [0.0, 1.0],
        [-0.3, 0.3],
        [0.7, 1.3],
        [-0.1, 0.9],
        [2.0, 3.0],
        [-3.5, -2.5],
    ] {
        let part = region([low, 0.0, 0.0], [high, 0.5, 0.5]);
        let images =
            WithImages::new(&shapes, &at([Vector3::zeros()]), &around, &part, 1.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        let image = voxel_image(&Solids::new(&pack), &part, 0.02).unwrap();
        let distances = signed_distance(&Solids::new(&pack), &image, Sides::Open);
        let [without, with] = [vec![], bridge.images(&around, &image)].map(|bridges| {
            let check = void_surface(&image, &distances, &bridges).unwrap().check();
            assert!(check.is_closed(), "{check:?}");
            check.volume
        });
        let volume = without - with;
        assert!((volume / exact - 1.0).abs() < 0.1, "{low} {volume} {exact}");
    }
}

/// The ends of an upright cylinder that is a period long.
#[test]
fn opposite_ends_of_a_cylinder_have_the_same_triangles() {
    let shapes = [solid("A10", 0.8)];
    let bodies = at([Vector3::new(0.2, 0.1, 0.05), Vector3::new(-0.1, 0.5, 1.0)]);
    let drum = Region::Cylinder {
        centre: [0.0; 2],
        radius: 0.7,
        z_min: 0.0,
        z_max: 1.987,
    };
    let around = space([None, None, Some(1.987)]);
    let images = WithImages::new(&shapes, &bodies, &around, &drum, 1.0).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let solids = Solids::new(&pack);
    let image = voxel_image(&solids, &drum, 0.03).unwrap();
    let distances = signed_distance(&solids, &image, Sides::Open);
    let surface = void_surface(&image, &distances, &[]).unwrap();
    let check = surface.check();
    assert!(check.is_closed() && check.degenerate == 0, "{check:?}");
    let exact = drum.volume() * (1.0 - exact_density(&pack, &drum).unwrap().density);
    assert!(
        (check.volume / exact - 1.0).abs() < 3e-3,
        "{} {exact}",
        check.volume
    );
    let way = Vector3::new(0.0, 0.0, 1.987);
    let [low, high] = [
        (SurfacePatch::Low, way),
        (SurfacePatch::High, Vector3::zeros()),
    ]
    .map(|(part, way)| sorted(&surface, part, way));
    assert!(
        low.len() > 100 && low == high,
        "{} {}",
        low.len(),
        high.len()
    );
}

/// Two large cubes a little less than the gap apart, beyond the faces of the cell, and many small ones.
#[test]
fn large_bodies_among_small_ones_are_scaled_alike_at_both_faces() {
    let shapes = [cuboid([-0.5; 3], [0.5; 3]), cuboid([-0.04; 3], [0.04; 3])];
    let mut bodies = at([
        Vector3::new(-0.4, 0.0, 0.05),
        Vector3::new(1.595, 0.0, 0.05),
    ]);
    let within = (0..9_u8).map(|i| Vector3::new(0.16 + 0.105 * f64::from(i), 0.05, 0.05));
    let elsewhere = (0..40_u8).map(|i| Vector3::new(0.5, 5.0 + f64::from(i), 0.05));
    let mut small = at(within.chain(elsewhere));
    small.iter_mut().for_each(|body| body.shape = 1);
    bodies.append(&mut small);
    let cell = region([0.0; 3], [3.0, 0.1, 0.1]);
    let around = space([Some(3.0), None, None]);
    let mean = Pack::new(&shapes, &bodies)
        .unwrap()
        .mean_diameter()
        .unwrap();
    let near = WithImages::new(&shapes, &bodies, &around, &cell, mean).unwrap();
    let near = near.pack(&shapes).unwrap();
    let reach = images_reach(&Solids::new(&near), &cell, 0.5 * mean, 0.01).unwrap();
    let images = WithImages::new(&shapes, &bodies, &around, &cell, reach).unwrap();
    let pack = images.pack(&shapes).unwrap();
    let found = facet_surface(&pack, &cell, Sides::Open, Treatment::Gap(0.01)).unwrap();
    let along = || found.surface.vertices.iter().map(|p| p.x);
    let (low, high) = (along().fold(3.0, f64::min), along().fold(0.0, f64::max));
    // The first one, and its image: centroids are 1.005 m apart, faces 0.005 m.
    let half = 0.5 * (1.005 - 0.01) / (1.005 - 0.005);
    assert!((low - (-0.4 - half)).abs() < 1e-9, "{low}");
    assert!((high - (2.6 + half)).abs() < 1e-9, "{high}");
    assert_eq!((found.bodies, found.changed, found.beyond), (11, 2, 2));
}

/// A body that is farther off than the walls of the region shrinks for none of them, and errors name the body, not its image.
#[test]
fn bodies_beyond_the_region_are_not_refused() {
    let shapes = [
        cuboid([-0.4; 3], [0.4; 3]),
        Shape::from(Dolos::default()).polyhedron(0.5).unwrap(),
    ];
    let bodies = at([Vector3::new(0.0, 5.0, 0.5), Vector3::new(1.0, 0.5, 0.5)]);
    // The bodies themselves lie beyond it.
    let part = region([2.0, 0.0, 0.0], [4.0, 1.0, 1.0]);
    let around = space([Some(2.0), None, None]);
    let treat = |bodies: &[PosedBody], gap: f64| {
        let images = WithImages::new(&shapes, bodies, &around, &part, 1.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        facet_surface(&pack, &part, Sides::Wall, Treatment::Gap(gap))
    };
    let found = treat(&bodies, 0.01).unwrap();
    assert_eq!((found.bodies, found.changed, found.beyond), (1, 0, 0));
    let refused = |bodies: &[PosedBody], gap: f64| treat(bodies, gap).unwrap_err().to_string();
    assert!(refused(&bodies, 0.4).contains("body 1"));
    let mut dolos = bodies.clone();
    dolos[1].shape = 1;
    assert!(refused(&dolos, 0.01).contains("body 1"));
    dolos.swap(0, 1);
    assert!(refused(&dolos, 0.01).contains("body 0"));
}
