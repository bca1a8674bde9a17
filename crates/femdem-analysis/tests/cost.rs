//! Time and memory of the tables for 11,000 truncated dodecahedra. Not part of the ordinary run:
//! `cargo test --release -p femdem-analysis --test all cost:: -- --ignored --nocapture`

use std::time::Instant;

use crate::common::{Random, body, solid};
use femdem_analysis::*;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Point3, Pose};

/// A jittered lattice of the density of a loose pack, with overlaps of neighbours that touch.
fn jittered(nodes: [u32; 3], spacing: f64) -> Vec<PosedBody> {
    let mut random = Random(99);
    let [nx, ny, nz] = nodes;
    let mut bodies = Vec::new();
    for i in 0..nx * ny * nz {
        let mut along = |i: u32| (f64::from(i) + 0.5) * spacing + random.uniform(-0.08, 0.08);
        let place = Translation3::new(along(i % nx), along(i / nx % ny), along(i / (nx * ny)));
        bodies.push(body(0, Pose::from_parts(place, random.rotation())));
    }
    bodies
}

fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM"));
    line.unwrap_or("VmHWM: not known here").to_owned()
}

#[test]
#[ignore = "seconds: cargo test --release -p femdem-analysis --test all cost:: -- --ignored --nocapture"]
fn tables_of_eleven_thousand_bodies() {
    let shapes = [solid("A10", 1.0)];
    let bodies = jittered([22, 22, 23], 0.9);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let container = Region::Box {
        min: Point3::origin(),
        max: Point3::new(19.8, 19.8, 20.7),
    };
    let core = container.inset(2.0).unwrap();
    let start = Instant::now();
    let mut last = start;
    let mut lap = |what: &str, shown: String| {
        println!("{:7.3} s  {what}: {shown}", last.elapsed().as_secs_f64());
        last = Instant::now();
    };
    let overlaps = pair_overlaps(&pack);
    lap("overlaps", format!("{} pairs", overlaps.pairs.len()));
    let density = packing_density(&pack, &core, &DensityOptions::default()).unwrap();
    lap(
        "density",
        format!(
            "{:.4} +- {:.4}",
            density.exact,
            density.standard_error.unwrap()
        ),
    );
    let profile = height_profile(&pack, &container, &ProfileOptions::default()).unwrap();
    lap("height profile", format!("{} bins", profile.bins.len()));
    let profile = wall_profile(&pack, &container, &ProfileOptions::default()).unwrap();
    lap("wall profile", format!("{} bins", profile.bins.len()));
    let drum = Region::Cylinder {
        centre: [9.9, 9.9],
        radius: 9.9,
        z_min: 0.0,
        z_max: 20.7,
    };
    let profile = wall_profile(&pack, &drum, &ProfileOptions::default()).unwrap();
    lap(
        "wall profile of a drum, not in the sum",
        format!("{} bins", profile.bins.len()),
    );
    let map = density_map(&pack, &container, &DensityMapOptions::default()).unwrap();
    lap("density map", format!("{} cells", map.densities.len()));
    let cells = set_voronoi(&pack, &container, &SetVoronoiOptions::default()).unwrap();
    lap(
        "Set-Voronoi",
        format!(
            "mean {:.4} +- {:.4}",
            cells.mean.mean,
            cells.mean.standard_error.unwrap()
        ),
    );
    let axes = BodyAxes::FaceNormals { sides: Some(10) };
    let directions = body_directions(&pack, &axes, None).unwrap();
    let vectors: Vec<[f64; 3]> = directions.iter().map(|d| d.direction).collect();
    let net = stereonet(&vectors, &StereonetOptions::default()).unwrap();
    lap(
        "stereonet",
        format!("{} directions, {} nodes", net.directions, net.nodes.len()),
    );
    let triad = BodyAxes::Fixed(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let order = orientation_order(&pack, &triad, None, &OrientationOptions::default()).unwrap();
    lap(
        "order",
        format!(
            "cubatic {:.4}, random {:.4}",
            order.cubatic.value, order.cubatic.random_mean
        ),
    );
    let radial = radial_distribution(&pack, &core, &RadialOptions::default()).unwrap();
    lap("radial distribution", format!("{} bins", radial.bins.len()));
    println!(
        "{:7.3} s  in all; {} threads; {}",
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads(),
        peak_memory()
    );
}
