//! Time of the tables of forces for 11,000 bodies and 32,000 contacts. Not part of the ordinary run:
//! `cargo test --release -p femdem-analysis --test all cost_forces:: -- --ignored --nocapture`

use std::time::Instant;

use crate::common::Random;
use crate::common::forces::{between, body, on_wall};
use femdem_analysis::*;
use femdem_mesh::{Point3, Vector3};

/// Bodies near the nodes of a cubic lattice that touch their neighbours with exponential forces.
fn lattice(sides: [u32; 3]) -> (Vec<ForceBody>, Vec<ForceContact>) {
    let mut random = Random(31);
    let [nx, ny, nz] = sides;
    let node = |i: u32| [i % nx, i / nx % ny, i / (nx * ny)];
    let bodies: Vec<ForceBody> = (0..nx * ny * nz)
        .map(|i| {
            let [x, y, z] = node(i).map(|k| f64::from(k) + random.uniform(-0.1, 0.1));
            body(x, y, z)
        })
        .collect();
    let mut contacts = Vec::new();
    for i in 0..nx * ny * nz {
        let [x, y, z] = node(i);
        let right = (x + 1 < nx).then_some(i + 1);
        let behind = (y + 1 < ny).then_some(i + nx);
        let above = (z + 1 < nz).then_some(i + nx * ny);
        for j in [right, behind, above].into_iter().flatten() {
            let force = -random.uniform(f64::MIN_POSITIVE, 1.0).ln() * f64::from(nz - z);
            let friction = Vector3::new(0.1, 0.2, 0.3) * force * random.uniform(-1.0, 1.0);
            contacts.push(ForceContact {
                tangential: friction,
                class: Some(ContactClass::EdgeFace),
                ..between(&bodies, i, j, force)
            });
        }
        if z == 0 {
            let foot = bodies[i as usize].centre - Vector3::z() * 0.5;
            contacts.push(on_wall(
                i,
                0,
                foot,
                -Vector3::z(),
                -Vector3::z() * f64::from(nz),
            ));
        }
    }
    (bodies, contacts)
}

#[test]
#[ignore = "seconds: cargo test --release -p femdem-analysis --test all cost_forces:: -- --ignored --nocapture"]
fn forces_of_eleven_thousand_bodies() {
    let (bodies, contacts) = lattice([22, 22, 23]);
    let region = Region::Box {
        min: Point3::from([-0.5; 3]),
        max: Point3::new(21.5, 21.5, 22.5),
    };
    let start = Instant::now();
    let mut last = start;
    let mut lap = |what: &str, shown: String| {
        println!("{:7.3} s  {what}: {shown}", last.elapsed().as_secs_f64());
        last = Instant::now();
    };
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let (count, pairs) = (contacts.len(), network.pairs().len());
    lap("network", format!("{count} contacts, {pairs} pairs"));
    let found = rattlers(&network, SupportRule::default()).unwrap();
    let classes = contact_classes(&network);
    lap(
        "rattlers and classes",
        format!("{}, {:?}", found.bodies.len(), classes.bodies[1]),
    );
    let p = force_distribution(&network, &ForceDistributionOptions::default()).unwrap();
    lap("P(f)", format!("{:?}", p.unwrap().tail.unwrap()));
    let by_weight = chains_by_weight(&network, WeightRule::default(), &ChainOptions::default());
    let by_weight = by_weight.unwrap();
    lap(
        "chains by weight",
        format!(
            "{} of {} links",
            by_weight.chains.len(),
            by_weight.links.len()
        ),
    );
    let options = ChainOptions::default();
    let wide = chains_by_weight(&network, WeightRule { factor: 0.3 }, &options).unwrap();
    lap("one large chain", format!("{:?}", wide.chains[0]));
    let by_stress = chains_by_stress(&network, StressRule::default(), &options).unwrap();
    lap(
        "chains by stress",
        format!(
            "{} of {} links",
            by_stress.chains.len(),
            by_stress.links.len()
        ),
    );
    let curve = threshold_curve(&network, &ThresholdOptions::default()).unwrap();
    lap("threshold curve", format!("{:?}", curve.points[10]));
    let stresses = body_stresses(&network);
    lap(
        "body stresses",
        format!("{:?}", stresses.bodies[0].stress.pressure),
    );
    let core = region_stress(&network, &region, BlockBootstrap::default()).unwrap();
    let profile = stress_profile(&network, &region, 23).unwrap();
    lap(
        "region and profile",
        format!("{} {}", core.stress.pressure, profile.slabs.len()),
    );
    let heights: Vec<f64> = (0..20).map(f64::from).collect();
    let balance = vertical_balance(&network, &heights).unwrap();
    lap("vertical balance", format!("{:.2}", balance.worst));
    let (fabric, walls) = (contact_fabric(&network), wall_forces(&network));
    lap(
        "fabric and walls",
        format!("{:.3} {}", fabric.normals.anisotropy, walls.walls.len()),
    );
    let rows: usize = [by_weight.to_csv(), stresses.to_csv(), curve.to_csv()]
        .iter()
        .map(|text| text.lines().count())
        .sum();
    lap("CSV", format!("{rows} lines"));
    println!(
        "{:7.3} s  in all; {} threads",
        start.elapsed().as_secs_f64(),
        rayon::current_num_threads()
    );
}
