//! Liquid bridges between balls, and between balls and planes.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::shape;
use crate::common::tets::cube;
use femdem_contact::deform::{DeformableShape, Modulus};
use femdem_contact::{
    BodyShape, ContactBatch, ContactLaw, ContactParameters, Frame, LiquidBridge, MeshWall, Motion,
    Sphere, Wall,
};
use femdem_mesh::{Matrix3, Vector3};

const RADIUS: f64 = 2.381e-3;

/// Silicone oil: 74.2 nl, 20.6 mN/m, 10 degrees.
const OIL: LiquidBridge = LiquidBridge {
    volume: 74.2e-12,
    tension: 0.0206,
    contact_angle: 10.0 * std::f64::consts::PI / 180.0,
};

/// (1 + theta/2) V^(1/3)
const BREAKS: f64 = 4.568_819_077_401_293e-4;

fn law(bridge: Option<LiquidBridge>) -> ContactLaw {
    ContactLaw::new(ContactParameters {
        penalty: 1e5,
        friction: 0.0,
        damping_ratio: 0.0,
        liquid_bridge: bridge,
        ..ContactParameters::default()
    })
    .unwrap()
}

/// A ball along a line from another, or from a plane, that a host moves.
struct Host {
    batch: ContactBatch,
    bodies: Vec<Motion>,
    walls: Vec<Motion>,
    line: Vector3,
    /// Distance of the centres, or from the plane, at touch.
    reach: f64,
}

impl Host {
    /// Of balls with these radii, far apart; one alone is above a plane.
    fn new(bridge: LiquidBridge, radii: &[f64]) -> Self {
        let line = Vector3::new(0.48, -0.6, 0.64);
        let mut batch = ContactBatch::new(law(Some(bridge)));
        let mut walls = Vec::new();
        if radii.len() == 1 {
            batch.add_wall(Wall::half_space("plane", line, 0.0).unwrap());
            walls.push(Motion::fixed(Frame::identity()));
        }
        let mut bodies = Vec::new();
        for &radius in radii {
            let shape = batch.add_shape(Sphere::new(radius).unwrap());
            batch.add_body(shape).unwrap();
            bodies.push(Motion {
                inverse_mass: 1.0,
                inverse_inertia: Matrix3::identity(),
                inverse_inertia_max: 1.0,
                ..Motion::fixed(Frame::identity())
            });
        }
        let reach = radii.iter().sum();
        let mut host = Self {
            batch,
            bodies,
            walls,
            line,
            reach,
        };
        host.place(reach);
        host
    }

    fn place(&mut self, gap: f64) {
        let last = self.bodies.last_mut().unwrap();
        let place = self.line * (self.reach + gap);
        last.travelled += (place - last.frame.position).norm();
        last.frame.position = place;
    }

    /// Pull on the ball over a gap, after a step, N.
    fn pull(&mut self, gap: f64) -> f64 {
        self.place(gap);
        self.batch.update(&self.bodies, &self.walls, 1e-3).unwrap();
        let id = self.batch.body_ids().last().unwrap();
        -self.batch.load_of(id).total.force.dot(&self.line)
    }
}

/// The pull of equal balls and of a ball and a plane after Rabinovich et al. (2005), from their equations in d, computed
/// elsewhere; where they touch it is 2 pi R and 4 pi R times gamma cos(theta).
#[test]
fn the_pull_is_that_of_rabinovich_et_al() {
    for (radii, most, wanted) in [
        (
            vec![RADIUS; 2],
            3.034_99e-4,
            [
                (1e-5, 2.820_061_376_211_249e-4),
                (1e-4, 1.278_025_345_346_528_4e-4),
                (3e-4, 2.877_302_431_983_358_2e-5),
            ],
        ),
        (
            vec![RADIUS],
            6.069_99e-4,
            [
                (1e-5, 5.463_584_852_515_278e-4),
                (1e-4, 1.769_206_654_108_848_2e-4),
                (3e-4, 3.091_758_426_065_824e-5),
            ],
        ),
    ] {
        let mut host = Host::new(OIL, &radii);
        assert_eq!(host.pull(1e-5), 0.0, "before they touch");
        let touch = host.pull(-1e-12);
        assert!((touch / most - 1.0).abs() < 1e-5, "{touch}");
        for (gap, force) in wanted {
            let got = host.pull(gap);
            assert!((got / force - 1.0).abs() < 1e-9, "{gap}: {got} for {force}");
        }
    }
}

/// The force is minus the gradient of the energy, which begins at 0 at the touch; of balls of two sizes and of a plane, over a gap
/// and in overlap, and it goes through the centres.
#[test]
fn the_pull_is_the_gradient_of_the_energy() {
    for radii in [vec![0.7 * RADIUS, RADIUS], vec![RADIUS]] {
        let mut host = Host::new(OIL, &radii);
        host.pull(-1e-12);
        assert!(host.batch.totals().energy.abs() < 1e-14);
        for gap in [-1e-5, 2e-6, 1e-4, 4e-4] {
            let h = 1e-8;
            let mut energy = |gap: f64| {
                host.pull(gap);
                host.batch.totals().energy
            };
            let slope = (energy(gap + h) - energy(gap - h)) / (2.0 * h);
            let pull = host.pull(gap);
            assert!(
                (pull - slope).abs() < 1e-6 * slope.abs(),
                "{gap}: {pull} {slope}"
            );
            let id = host.batch.body_ids().last().unwrap();
            assert!(host.batch.load_of(id).total.torque.norm() < 1e-14 * RADIUS);
            let contact = host.batch.contacts()[0];
            assert_eq!(contact.area > 0.0, gap < 0.0);
        }
    }
}

/// A bridge forms on touching and not before, holds up to the distance of Lian et al. (1993), is gone then with what it held, and
/// forms anew on touching only.
#[test]
fn a_bridge_forms_on_touching_and_breaks() {
    for radii in [vec![RADIUS; 2], vec![RADIUS]] {
        let mut host = Host::new(OIL, &radii);
        for _ in 0..2 {
            assert_eq!(host.pull(0.5 * BREAKS), 0.0);
            host.pull(-1e-7);
            // Boole's rule.
            let n = 400;
            let step = BREAKS / f64::from(n);
            let weights = [7.0, 32.0, 12.0, 32.0];
            let mut work = 0.0;
            for k in 0..n {
                let twice = if k > 0 && k % 4 == 0 { 2.0 } else { 1.0 };
                work += twice * weights[k as usize % 4] * host.pull((f64::from(k) + 1e-9) * step);
            }
            let last = host.pull(BREAKS * (1.0 - 1e-9));
            assert!(last > 0.0);
            work = (work + 7.0 * last) * step * 2.0 / 45.0;
            assert_eq!(host.batch.totals().broken, 0.0);
            assert_eq!(host.pull(BREAKS * (1.0 + 1e-9)), 0.0);
            assert!(host.batch.contacts().is_empty());
            let lost = host.batch.totals().broken;
            assert!((lost / work - 1.0).abs() < 1e-6, "{lost} {work}");
            assert_eq!(host.pull(0.9 * BREAKS), 0.0);
            assert_eq!(host.batch.totals().broken, 0.0);
        }
    }
}

/// Bridges that reach far beyond the skins of the search hold, also those of a law that comes later, and where the ball leaves in
/// one step, what it held is told.
#[test]
fn the_search_reaches_as_far_as_bridges() {
    let water = LiquidBridge {
        volume: 0.2 * RADIUS.powi(3),
        tension: 0.07,
        contact_angle: 0.0,
    };
    let breaks = 0.2_f64.cbrt() * RADIUS;
    for radii in [vec![RADIUS; 2], vec![RADIUS]] {
        for late in [false, true] {
            let mut host = Host::new(water, &radii);
            if late {
                host.batch.set_laws(law(None));
            }
            host.pull(-1e-7);
            if late {
                host.batch.set_laws(law(Some(water)));
                host.pull(-1e-7);
            }
            for k in 0..99 {
                assert!(host.pull(0.01 * f64::from(k) * breaks) > 0.0, "{k}");
            }
            let held = host.batch.totals().energy;
            assert_eq!(host.pull(50.0 * RADIUS), 0.0);
            let lost = host.batch.totals().broken;
            assert!(lost > held && lost < 1.01 * held, "{lost} {held}");
        }
    }
}

/// What is not round, and numbers that cannot be, are refused by name.
#[test]
fn bridges_of_what_is_not_round_are_refused() {
    for (bad, words) in [
        (
            LiquidBridge { volume: 0.0, ..OIL },
            "liquid_bridge.volume = 0",
        ),
        (
            LiquidBridge {
                tension: -1.0,
                ..OIL
            },
            "liquid_bridge.tension = -1",
        ),
        (
            LiquidBridge {
                contact_angle: 1.6,
                ..OIL
            },
            "liquid_bridge.contact_angle = 1.6",
        ),
    ] {
        let parameters = ContactParameters {
            liquid_bridge: Some(bad),
            ..ContactParameters::default()
        };
        let message = ContactLaw::new(parameters).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
    let ball = || BodyShape::from(Sphere::new(1.0).unwrap());
    let refused = |body: BodyShape, add: fn(&mut ContactBatch)| {
        let mut batch = ContactBatch::new(law(Some(OIL)));
        let shape = batch.add_shape(body);
        batch.add_body(shape).unwrap();
        add(&mut batch);
        let [bodies, walls] = batch.slots();
        let still = Motion::fixed(Frame::identity());
        let done = batch.update(&vec![still; bodies], &vec![still; walls], 0.0);
        done.map_err(|error| error.to_string())
    };
    let cubic = refused(shape("P5", 1.0).into(), |_| ()).unwrap_err();
    assert!(
        cubic.contains("liquid_bridge") && cubic.contains("spheres"),
        "{cubic}"
    );
    let on_mesh = refused(ball(), |batch| {
        batch.add_wall(MeshWall::solid("solid", &cube(1)));
    });
    assert!(on_mesh.unwrap_err().contains("liquid_bridge"));
    let soft = refused(ball(), |batch| {
        let soft = DeformableShape::new(&cube(1)).unwrap();
        let soft = batch.add_deformable_shape(soft);
        batch.add_deformable(soft, Modulus::Penalty(1.0)).unwrap();
    });
    assert!(soft.unwrap_err().contains("deformable"));
    assert!(refused(ball(), |_| ()).is_ok());
}
