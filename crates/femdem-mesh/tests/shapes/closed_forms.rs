//! Volumes, areas, inertia and errors of approximation against closed forms and published numbers.

use super::{assert_near, body};
use std::f64::consts::{PI, TAU};

/// Volume of the sphere of diameter 1.
const BALL: f64 = PI / 6.0;

#[test]
fn box_is_exact() {
    let b = body("box:width=0.7,height=0.3", 2.0);
    let (x, y, z) = (2.0, 1.4, 0.6);
    let mass = b.mass_properties();
    assert_near("volume", mass.volume, x * y * z, 1e-14);
    assert_near("area", b.area(), 2.0 * (x * y + y * z + z * x), 1e-14);
    for (i, other) in [(0, y * y + z * z), (1, z * z + x * x), (2, x * x + y * y)] {
        assert_near(
            "inertia",
            mass.inertia[(i, i)],
            mass.volume * other / 12.0,
            1e-14,
        );
    }
}

/// Area and polar moment of area of a regular polygon on a circle of radius r.
fn polygon(r: f64, sides: f64) -> (f64, f64) {
    let t = TAU / sides;
    let area = 0.5 * sides * r * r * t.sin();
    (area, area * r * r * (2.0 + t.cos()) / 6.0)
}

#[test]
fn prisms_on_circles_are_exact_and_converge_to_cylinders() {
    for (bore, sides) in [(0.0, 6), (0.0, 64), (0.5, 32), (0.8, 7)] {
        let text = if bore == 0.0 {
            format!("cylinder:sides={sides},aspect=1.5")
        } else {
            format!("hollow_cylinder:bore={bore},sides={sides},aspect=1.5")
        };
        let b = body(&text, 2.0);
        let n = f64::from(sides);
        let ((outer, polar_outer), (inner, polar_inner)) = (polygon(1.0, n), polygon(bore, n));
        let (area, polar, height) = (outer - inner, polar_outer - polar_inner, 3.0);
        let mass = b.mass_properties();
        assert_near(&text, mass.volume, area * height, 1e-13);
        let side = 2.0 * n * (PI / n).sin() * (1.0 + bore) * height;
        assert_near(&text, b.area(), 2.0 * area + side, 1e-13);
        assert_near(&text, mass.inertia[(2, 2)], polar * height, 1e-13);
        let across = 0.5 * polar * height + mass.volume * height * height / 12.0;
        assert_near(&text, mass.inertia[(0, 0)], across, 1e-13);
        assert_near(&text, mass.inertia[(1, 1)], across, 1e-13);
    }
    // The circle: second order in the number of sides, with the constant that the polygon gives.
    for (text, smooth, polar) in [
        ("cylinder:sides=128", PI / 4.0, PI / 32.0),
        (
            "hollow_cylinder:bore=0.5,sides=128",
            0.75 * PI / 4.0,
            PI / 32.0 * (1.0 - 0.0625),
        ),
    ] {
        let mass = *body(text, 1.0).mass_properties();
        let deficit = 2.0 / 3.0 * (PI / 128.0).powi(2);
        assert_near(text, mass.volume, smooth * (1.0 - deficit), 1e-6);
        assert_near(
            text,
            mass.inertia[(2, 2)],
            polar * (1.0 - 2.0 * deficit),
            2e-6,
        );
    }
}

#[test]
fn pellet_is_the_polygon_less_its_holes() {
    let b = body("pellet", 1.0);
    let (outer, polar) = polygon(0.5, 36.0);
    let (hole, hole_polar) = polygon(0.09, 12.0);
    let mass = b.mass_properties();
    assert_near("volume", mass.volume, outer - 7.0 * hole, 1e-13);
    let expected = polar - 7.0 * hole_polar - 6.0 * hole * 0.3 * 0.3;
    assert_near("inertia", mass.inertia[(2, 2)], expected, 1e-13);
    let side = 36.0 * (PI / 36.0).sin() + 7.0 * 12.0 * 0.18 * (PI / 12.0).sin();
    assert_near("area", b.area(), 2.0 * mass.volume + side, 1e-13);
}

#[test]
fn sphere_and_ellipsoid_err_as_stated_and_converge_with_second_order() {
    // Parts of the volume and of the radius, as in the table of the documentation.
    let stated = [
        (0, 0.395, 0.206),
        (1, 0.127, 0.066),
        (2, 0.034, 0.018),
        (3, 0.0087, 0.0046),
        (4, 0.0022, 0.0012),
        (5, 0.00055, 0.00029),
    ];
    let mut last: Option<f64> = None;
    for (level, volume, distance) in stated {
        let b = body(&format!("sphere:level={level}"), 1.0);
        assert_eq!(b.face_count(), 20 * 4_usize.pow(level));
        let error = 1.0 - b.mass_properties().volume / BALL;
        assert!(
            error <= volume && error > 0.97 * volume,
            "level {level}: volume {error}"
        );
        let off = 1.0 - b.inradius() / 0.5;
        assert!(
            off <= distance && off > 0.94 * distance,
            "level {level}: distance {off}"
        );
        let inertia = b.mass_properties().inertia[(0, 0)] / (BALL / 10.0);
        if let Some(last) = last.filter(|_| level > 2) {
            assert_near(
                "order of the inertia",
                (last / (1.0 - inertia)).log2(),
                2.0,
                0.05,
            );
        }
        last = Some(1.0 - inertia);
        assert_near("area", b.area(), PI, 1.2 * volume);
    }
    for level in 2..=4 {
        let text = format!("ellipsoid:width=0.5,height=2,level={level}");
        let mass = *body(&text, 2.0).mass_properties();
        let sphere = body(&format!("sphere:level={level}"), 2.0);
        // Stretching changes volume and second moments by known factors.
        assert_near(&text, mass.volume, sphere.mass_properties().volume, 1e-13);
        let moment = 0.5 * sphere.mass_properties().inertia[(0, 0)];
        assert_near(&text, mass.inertia[(0, 0)], moment * (0.25 + 4.0), 1e-13);
        assert_near(&text, mass.inertia[(1, 1)], moment * (1.0 + 4.0), 1e-13);
        assert_near(&text, mass.inertia[(2, 2)], moment * (1.0 + 0.25), 1e-13);
    }
}

/// Volume of the superquadric of semi-axes 1/2 by quadrature over slices.
fn superquadric_volume(n1: f64, n2: f64) -> f64 {
    let n = 4000;
    // Squares of the abscissa's distance from the end smooth the integrand there.
    let sum = |f: &dyn Fn(f64) -> f64| -> f64 {
        (0..n)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / f64::from(n);
                f(1.0 - u * u * u * u) * 4.0 * u * u * u / f64::from(n)
            })
            .sum()
    };
    let quarter = sum(&|x| (1.0 - x.powf(n2)).powf(1.0 / n2));
    let slices = sum(&|z| (1.0 - z.powf(n1)).powf(2.0 / n1));
    quarter * slices
}

#[test]
fn superquadric_has_the_exponents_of_the_equation() {
    assert_near("ball", superquadric_volume(2.0, 2.0), BALL, 1e-5);
    for (n1, n2) in [
        (2.0, 2.0),
        (2.0, 6.0),
        (6.0, 2.0),
        (3.0, 13.0),
        (8.0, 8.0),
        (20.0, 20.0),
    ] {
        let expected = superquadric_volume(n1, n2);
        let mut errors = Vec::new();
        for cells in [16, 32] {
            let text = format!("superquadric:n1={n1},n2={n2},cells={cells}");
            let error = 1.0 - body(&text, 1.0).mass_properties().volume / expected;
            errors.push(error);
        }
        assert!(
            errors[0] > 0.0 && errors[0] < 0.012,
            "{n1}, {n2}: {errors:?}"
        );
        assert!(errors[1] < 0.5 * errors[0], "{n1}, {n2}: {errors:?}");
    }
    // Vertices satisfy the equation.
    let b = body("superquadric:n1=5,n2=3,width=0.6,aspect=1.5", 2.0);
    for v in b.vertices() {
        let across = v.x.abs().powi(3) + (v.y.abs() / 0.6).powi(3);
        let value = across.powf(5.0 / 3.0) + (v.z.abs() / 1.5).powi(5);
        assert_near("left side", value, 1.0, 3e-5);
    }
}

#[test]
fn rounded_cube_lies_just_inside_the_smooth_one() {
    for (radius, segments) in [(0.1_f64, 4_u32), (0.4, 1), (0.45, 16)] {
        let text = format!("rounded_cube:radius={radius},segments={segments}");
        let b = body(&text, 1.0);
        let edge = 1.0 - 2.0 * radius;
        let smooth = edge.powi(3)
            + 6.0 * edge * edge * radius
            + 3.0 * PI * edge * radius * radius
            + 4.0 / 3.0 * PI * radius.powi(3);
        let allowed = radius / f64::from(segments).powi(2);
        for i in 0..b.face_count() {
            let normal = b.face_normal(i);
            let support = 0.5 * edge * normal.lp_norm(1) + radius;
            let gap = support - b.face_offset(i);
            assert!(gap > -1e-12 && gap < allowed, "{text}: {gap}");
        }
        assert!(b.mass_properties().volume <= smooth);
        assert!(smooth - b.mass_properties().volume < allowed * b.area());
        assert!(b.is_convex());
    }
}

#[test]
fn lobes_have_the_area_of_their_arcs() {
    for (lobes, spacing) in [(2, 0.7_f64), (3, 0.85), (4, 0.9), (8, 0.3)] {
        let half = PI / f64::from(lobes);
        let radius = 0.5 / (1.0 + spacing / half.sin());
        let centre = spacing * radius / half.sin();
        // Each lobe: the polygon between its neighbours' axes, half a lens at either side, and the
        // part of its circle outside the polygon of the axes.
        let polygon = f64::from(lobes) * centre * centre * half.sin() * half.cos();
        let corner = PI - 2.0 * half;
        let outside = 0.5 * radius * radius * (TAU - corner);
        let half_angle = spacing.acos();
        let half_lens = 0.5 * radius * radius * (2.0 * half_angle - (2.0 * half_angle).sin());
        // With two lobes the polygon is a segment; circles overlap on both of its sides.
        let expected = polygon + f64::from(lobes) * (outside - half_lens);
        let error = |segments: u32| {
            let text =
                format!("lobed:lobes={lobes},spacing={spacing},segments={segments},aspect=1");
            1.0 - body(&text, 1.0).mass_properties().volume / expected
        };
        // The arcs are polygons: of second order.
        let (coarse, fine) = (error(32), error(64));
        assert!(fine > 0.0 && fine < 1e-3, "{lobes} lobes: {fine}");
        assert_near("order of the area", (coarse / fine).log2(), 2.0, 2e-3);
    }
}

#[test]
fn armour_units_have_their_published_volumes() {
    // Shore Protection Manual (1984): 0.16 and 0.280 cubic heights; Frens (2007): 1.0247.
    assert_near(
        "dolos",
        body("dolos", 1.0).mass_properties().volume,
        0.16,
        0.01,
    );
    let tetrapod = body("tetrapod:sides=96", 1.0);
    assert_near("tetrapod", tetrapod.mass_properties().volume, 0.280, 0.005);
    assert_near(
        "antifer",
        body("antifer", 1.0).mass_properties().volume,
        1.0247,
        1e-4,
    );
    // Burcharth and Liu (1992).
    for waist in [0.32_f64, 0.37, 0.42] {
        let volume = body(&format!("dolos:waist={waist}"), 1.0)
            .mass_properties()
            .volume;
        assert_near("dolos", volume, 0.675 * waist.powf(1.285), 0.04);
    }
    // A tetrapod's inertia is isotropic; that of a dolos is the same about x and y.
    let inertia = tetrapod.mass_properties().inertia;
    for (i, j) in [(0, 1), (1, 2)] {
        assert_near("tetrapod", inertia[(i, i)], inertia[(j, j)], 1e-12);
    }
    let dolos = body("dolos", 1.0).mass_properties().inertia;
    assert_near("dolos", dolos[(0, 0)], dolos[(1, 1)], 1e-13);
}

#[test]
fn clumps_converge_to_the_union_of_their_spheres() {
    // Two spheres of radius 1/2, a distance d apart, less the lens in which they overlap.
    for d in [0.5, 0.9] {
        let lens = PI * (2.0 + d) * (1.0 - d) * (1.0 - d) / 12.0;
        let expected = 2.0 * BALL - lens;
        let error = |cells: f64| {
            let half = 0.5 * d;
            let text = format!("clump:spheres=-{half} 0 0 0.5/{half} 0 0 0.5,cells={cells}");
            1.0 - body(&text, 1.0).mass_properties().volume / expected
        };
        let (coarse, fine) = (error(2.5), error(5.0));
        assert!(coarse > 0.0 && coarse < 0.012, "{d}: {coarse}");
        assert!(fine < 0.35 * coarse, "{d}: {coarse}, {fine}");
    }
}
