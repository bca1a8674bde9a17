//! Loads on bodies in scenes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Usage;
use femdem::mesh::{Point3, Vector3};
use femdem::run::{Run, Scenario, Simulation};
use tempfile::tempdir;

/// A box of 40 x 40 x 20 mm and 0.08 kg, and a ball.
const FREE: &str = r#"
duration = 0.5
gravity = [0, 0, 0]
sleeping = false
time-step.largest = 2e-4
[material.m]
density = 2500
[[body]]
name = "brick"
shape = "box:width=1,height=0.5"
size = 0.04
material = "m"
spin = [0, 0, 30]
[[body]]
name = "ball"
shape = "sphere"
diameter = 0.02
material = "m"
position = [1, 0, 0]
copies = { count = [1, 2, 1], spacing = [0, 0.5, 0] }
"#;
const MASS: f64 = 2500.0 * 0.04 * 0.04 * 0.02;

fn built(text: &str) -> Simulation {
    Scenario::from_toml(text).unwrap().build().unwrap()
}

fn to(simulation: &mut Simulation, time: f64) {
    while simulation.world.time() < time {
        simulation.step().unwrap();
    }
}

fn place(simulation: &Simulation, member: usize) -> Vector3 {
    let id = simulation.members[member].id;
    simulation.world.position(id).unwrap()
}

/// A constant force moves a body along a parabola, an acceleration bodies of any mass alike, and a force density by the mass
/// density; names of copies are those of a group, and forces add up.
#[test]
fn bodies_follow_parabolas() {
    let text = format!(
        "{FREE}[[load]]\nbodies = [\"ball\"]\nacceleration = [0, 0, -2]\n\
         [[load]]\nbodies = [\"ball 2\", \"brick\"]\nforce = [0.3, 0, 0]\n\
         [[load]]\nforce-density = [0, 500, 0]\n"
    );
    let mut simulation = built(&text);
    to(&mut simulation, 0.5);
    let time = simulation.world.time();
    let ball = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    let starts = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0]];
    let wanted = [
        [0.3 / MASS, 0.2, 0.0],
        [0.0, 0.2, -2.0],
        [0.3 / ball, 0.2, -2.0],
    ];
    for (k, (start, acceleration)) in starts.into_iter().zip(wanted).enumerate() {
        let way = place(&simulation, k) - Vector3::from(start);
        let free = Vector3::from(acceleration) * (0.5 * time * time);
        assert!((way - free).norm() < 1e-11, "{k}: {way} {free}");
    }
    let books = simulation.world.ledger();
    assert!(books.error().abs() < 1e-11 * books.load_work, "{books:?}");
}

/// Euler's equations of a spinning top under a torque that turns with it: its rates across the axis are
/// M/(I k) (sin k t, cos k t - 1), k = (I - I_3)/I times the spin.
#[test]
fn a_torque_in_body_axes_turns_a_top() {
    let text =
        format!("{FREE}[[load]]\nbodies = [\"brick\"]\ntorque = [2e-4, 0, 0]\naxes = \"body\"\n");
    // The error is of second order in the step.
    let mut simulation = built(&text.replace("2e-4\n", "5e-5\n"));
    let (across, along) = (
        MASS * (0.04_f64.powi(2) + 0.02_f64.powi(2)) / 12.0,
        MASS * 2.0 * 0.04_f64.powi(2) / 12.0,
    );
    let rate = (across - along) / across * 30.0;
    let scale = 2e-4 / (across * rate);
    let id = simulation.members[0].id;
    for k in 1..=5 {
        to(&mut simulation, 0.1 * f64::from(k));
        let (world, time) = (&simulation.world, simulation.world.time());
        let pose = world.pose(id).unwrap();
        let got = pose.inverse_transform_vector(&world.angular_velocity(id).unwrap());
        let (sin, cos) = (rate * time).sin_cos();
        let wanted = Vector3::new(scale * sin, scale * (cos - 1.0), 30.0);
        assert!((got - wanted).norm() < 1e-4 * scale.abs(), "{got} {wanted}");
        assert!(world.ledger().error().abs() < 1e-5 * world.ledger().kinetic);
    }
}

/// A force at a point of a body does the work force times way of that point, in either axes the torque of its arm.
#[test]
fn a_force_at_a_point_has_an_arm() {
    let text = format!(
        "{FREE}[[load]]\nbodies = [\"brick\"]\nforce = [0, 0, 0.5]\npoint = [0.02, 0.01, 0]\n"
    );
    let mut simulation = built(&text.replace("spin = [0, 0, 30]", ""));
    let id = simulation.members[0].id;
    let point = Point3::new(0.02, 0.01, 0.0);
    to(&mut simulation, 0.2);
    let lifted = (simulation.world.pose(id).unwrap() * point).z;
    let kinetic = simulation.world.ledger().kinetic;
    assert!(
        (kinetic / (0.5 * lifted) - 1.0).abs() < 1e-4,
        "{kinetic} {lifted}"
    );
    // Along the force the centroid moves as if it acted there.
    let time = simulation.world.time();
    let free = 0.5 * 0.5 / MASS * time * time;
    assert!((place(&simulation, 0).z / free - 1.0).abs() < 1e-10);

    // In the axes of the body it becomes ever faster about an axis that stays.
    let mut simulation = built(&text.replace("spin = [0, 0, 30]", "").replace(
        "point = [0.02, 0.01, 0]",
        "point = [0.01, 0, 0]\naxes = \"body\"",
    ));
    to(&mut simulation, 0.2);
    let inertia = MASS * (0.04_f64.powi(2) + 0.02_f64.powi(2)) / 12.0;
    let spin = simulation.world.angular_velocity(id).unwrap();
    let wanted = Vector3::y() * (-0.005 / inertia * simulation.world.time());
    assert!(
        (spin - wanted).norm() < 1e-9 * wanted.norm(),
        "{spin} {wanted}"
    );
}

/// A block on a floor under a force that grows with time stays until the force is the friction coefficient times its weight,
/// and is accelerated by what is above that.
#[test]
fn a_growing_force_slides_a_block_at_friction() {
    let text = "duration = 1
        sleeping = false
        contact = { friction = 0.4, penalty = 1e7 }
        [material.m]
        density = 2500
        [[wall]]
        plane = { normal = [0, 0, 1] }
        [[body]]
        shape = \"box:width=1,height=0.5\"
        size = 0.04
        material = \"m\"
        position = [0, 0, 0.009999]
        [[load]]
        force = [1, 0, 0]
        point = [0, 0, -0.01]
        table = [[0, 0], [0.5, 0], [1.5, 0.6278400]]";
    let mut simulation = built(text);
    // 0.4 m g is half of what the table goes to.
    let friction = 0.4 * MASS * 9.81;
    let slides = 0.5 + friction / 0.62784;
    assert!((slides - 1.0).abs() < 1e-12);
    to(&mut simulation, 0.99);
    let before = place(&simulation, 0).x;
    assert!((0.0..1e-5).contains(&before), "{before}");
    to(&mut simulation, 1.3);
    let since = simulation.world.time() - slides;
    let speed = simulation
        .world
        .velocity(simulation.members[0].id)
        .unwrap()
        .x;
    let wanted = 0.5 * 0.62784 / MASS * since * since;
    assert!((speed / wanted - 1.0).abs() < 0.01, "{speed} {wanted}");
    let books = simulation.world.ledger();
    assert!(books.error_relative().abs() < 1e-2, "{books:?}");
    let rest = simulation.rest();
    assert!(!rest.at_rest);
}

/// A force on a body that rests is borne by the floor: the balance of forces counts it.
#[test]
fn loads_count_in_the_balance_of_forces() {
    let text = "duration = 2
        rest = { energy = 1e-9, time = 0.05 }
        contact.penalty = 1e7
        [material.m]
        density = 2500
        [[wall]]
        plane = { normal = [0, 0, 1] }
        [[body]]
        shape = \"cube\"
        size = 0.04
        material = \"m\"
        position = [0, 0, 0.0115]
        [[load]]
        force = [0, 0, -5]
        rise = 0.2";
    let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    run.advance(tempdir().unwrap().path(), u64::MAX).unwrap();
    let rest = run.simulation().rest();
    assert!(rest.at_rest && rest.force_balance < 1e-3, "{rest:?}");
    let time = run.simulation().world.time();
    assert!((0.2..1.0).contains(&time), "{time}");
}

/// A run goes on from a checkpoint with the same bits while its loads change.
#[test]
fn the_same_bits_through_a_checkpoint() {
    let text = format!(
        "{FREE}[[load]]\nforce = [0.1, 0.2, 0.5]\npoint = [0.001, 0.002, 0]\nrise = 0.4\n\
         [[load]]\nbodies = [\"ball\"]\ntorque = [1e-6, 0, 1e-6]\naxes = \"body\"\n\
         table = [[0, 1], [0.2, -1]]\n"
    );
    let folder = tempdir().unwrap();
    let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    run.advance(folder.path(), 400).unwrap();
    run.flush(folder.path()).unwrap();
    run.save(folder.path(), &Usage::default()).unwrap();
    let mut again = Run::read(folder.path()).unwrap().0;
    let other = tempdir().unwrap();
    run.advance(folder.path(), 400).unwrap();
    again.advance(other.path(), 400).unwrap();
    let hash = |run: &Run| run.simulation().world.state_hash().unwrap();
    assert_eq!(hash(&run), hash(&again));
}

/// A run that goes on, or starts from a state, has the loads of its scene and no others.
#[test]
fn a_scene_changes_its_loads() {
    let with = |force: f64| {
        let text = format!("{FREE}[[load]]\nbodies = [\"brick\"]\nforce = [{force}, 0, 0]\n");
        Scenario::from_toml(&text).unwrap()
    };
    let mut run = Run::new(with(0.1)).unwrap();
    let folder = tempdir().unwrap();
    run.advance(folder.path(), 100).unwrap();
    let load = |run: &Run| {
        let world = &run.simulation().world;
        let id = run.simulation().members[0].id;
        world.applied_load(id).unwrap().force.x
    };
    assert_eq!(load(&run), 0.1);
    assert_eq!(run.apply(with(0.2)).unwrap(), ["[[load]] number 1 (force)"]);
    assert_eq!(load(&run), 0.2);
    assert_eq!(
        run.apply(Scenario::from_toml(FREE).unwrap()).unwrap().len(),
        1
    );
    assert_eq!(load(&run), 0.0);
    run.advance(folder.path(), 1).unwrap();
    run.save(folder.path(), &Usage::default()).unwrap();
    let mut started = with(0.3);
    started.from = Some(folder.path().to_owned());
    for body in &mut started.body {
        body.spin = [0.0; 3];
    }
    assert_eq!(load(&Run::new(started).unwrap()), 0.3);
}

/// Bodies of a source have the loads of its name as they come.
#[test]
fn bodies_of_a_source_are_loaded_as_they_come() {
    let text = r#"
        duration = 1
        gravity = 0
        [material.m]
        density = 1000
        [[source]]
        name = "feed"
        shape = "cube"
        diameter = 0.01
        material = "m"
        lower = [0, 0, 0]
        upper = [0.1, 0.1, 0.1]
        rate = 20
        number = 3
        [[load]]
        bodies = ["feed"]
        acceleration = [0, 3, 0]"#;
    let mut simulation = built(text);
    to(&mut simulation, 0.4);
    assert_eq!(simulation.members.len(), 3);
    for (member, began) in simulation.members.iter().zip([0.05, 0.1, 0.15]) {
        let speed = simulation.world.velocity(member.id).unwrap();
        let wanted = 3.0 * (simulation.world.time() - began);
        assert!((speed.y - wanted).abs() < 0.02 * wanted, "{speed} {wanted}");
    }
}

#[test]
fn loads_that_mean_nothing_are_refused() {
    for (text, words) in [
        ("rise = 1", "exactly one of force"),
        (
            "force = [1, 0, 0]\ntorque = [1, 0, 0]",
            "exactly one of force",
        ),
        ("force = [inf, 0, 0]", "finite"),
        ("torque = [1, 0, 0]\npoint = [0, 0, 0]", "for a force only"),
        (
            "force = [1, 0, 0]\nrise = 1\ntable = [[0, 1]]",
            "rise and table",
        ),
        ("force = [1, 0, 0]\nrise = -1", "rise = -1"),
        ("force = [1, 0, 0]\nbodies = [\"bal\"]", "bodies = \"bal\""),
        ("force = [1, 0, 0]\nbodies = [\"ball 3\"]", "ball 3"),
    ] {
        let scene = Scenario::from_toml(&format!("{FREE}[[load]]\n{text}\n")).unwrap();
        let message = scene.build().unwrap_err().to_string();
        assert!(message.contains(words), "{text}: {message}");
        assert!(message.contains("load 1"), "{text}: {message}");
    }
    let soft = "[material.m]\ndensity = 1000\nlaw = \"hencky\"\nyoung = 1e6\npoisson = 0.3\n\
                [[body]]\nblock = [1, 1, 1]\nsides = [1, 1, 1]\nmaterial = \"m\"\n\
                behaviour = \"deformable\"\n[[load]]\n";
    let scene = Scenario::from_toml(&format!("{soft}torque = [1, 0, 0]\n")).unwrap();
    let message = scene.build().unwrap_err().to_string();
    assert!(message.contains("deformable"), "{message}");
    let mut simulation = built(&format!("gravity = 0\n{soft}acceleration = [1, 0, 0]\n"));
    to(&mut simulation, 0.1);
    let time = simulation.world.time();
    assert!((place(&simulation, 0).x - 0.5 * time * time).abs() < 1e-9);
}
