//! Two of the impacts of Y. C. Chung and J. Y. Ooi, Granular Matter 13 (2011) 643-656, and one of them at a
//! tenth of the speed.

use crate::ball::{Ball, Hertz};
use crate::law::Law;
use crate::setting::{self, Setting};
use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World};
use std::error::Error;
use std::f64::consts::PI;
use std::io::Write;
use std::time::Instant;

/// An impact of equal balls, or of a ball on a rigid plane.
struct Impact {
    table: &'static str,
    name: &'static str,
    material: Hertz,
    density: f64,
    /// Of each ball, m/s.
    speed: f64,
    two: bool,
    law: Law,
    /// Elements, edges at the contact over the radius, and kappa h/E.
    runs: &'static [(Element, f64, f64)],
}

const GLASS: Hertz = Hertz {
    young: 48e9,
    poisson: 0.2,
    radius: 0.01,
};

/// Names of the tables of impacts.
pub const TABLES: [&str; 4] = ["glass", "laws", "slow", "aluminium"];

const IMPACTS: [Impact; 5] = [
    Impact {
        table: "glass",
        name: "test 1, two glass balls",
        material: GLASS,
        density: 2800.0,
        speed: 10.0,
        two: true,
        law: Law::NeoHookean,
        runs: &[
            (Element::T10, 0.05, 1.0),
            (Element::T10, 0.035, 1.0),
            (Element::T10, 0.025, 1.0),
            (Element::T4, 0.05, 1.0),
            (Element::T4, 0.035, 1.0),
            (Element::T4, 0.035, 0.3),
            (Element::T4, 0.035, 3.0),
            (Element::T4, 0.025, 1.0),
        ],
    },
    Impact {
        table: "laws",
        name: "test 1, a glass ball on a plane, law of small strain",
        material: GLASS,
        density: 2800.0,
        speed: 10.0,
        two: false,
        law: Law::SmallStrain,
        runs: &[(Element::T4, 0.05, 1.0)],
    },
    Impact {
        table: "laws",
        name: "test 1, a glass ball on a plane, law of Hencky",
        material: GLASS,
        density: 2800.0,
        speed: 10.0,
        two: false,
        law: Law::Hencky,
        runs: &[(Element::T4, 0.05, 1.0)],
    },
    Impact {
        table: "slow",
        name: "test 1 at 1 m/s, a glass ball on a plane",
        material: GLASS,
        density: 2800.0,
        speed: 1.0,
        two: false,
        law: Law::NeoHookean,
        runs: &[
            (Element::T10, 0.014, 1.0),
            (Element::T4, 0.014, 1.0),
            (Element::T4, 0.014, 3.0),
        ],
    },
    Impact {
        table: "aluminium",
        name: "test 2, aluminium ball on a plane",
        material: Hertz {
            young: 70e9,
            poisson: 0.3,
            radius: 0.1,
        },
        density: 2699.0,
        speed: 0.2,
        two: false,
        law: Law::NeoHookean,
        runs: &[
            (Element::T10, 0.0105, 1.0),
            (Element::T4, 0.0105, 1.0),
            (Element::T4, 0.0074, 1.0),
            (Element::T4, 0.0074, 0.3),
            (Element::T4, 0.0074, 3.0),
        ],
    },
];

/// Number of points of a curve that are printed.
const POINTS: usize = 100;

/// The impacts of a table, on all meshes or on the first.
pub fn run(out: &mut impl Write, table: &str, quick: bool) -> Result<(), Box<dyn Error>> {
    for impact in IMPACTS.iter().filter(|impact| impact.table == table) {
        let runs = if quick {
            &impact.runs[..1]
        } else {
            impact.runs
        };
        for &(element, edge, ratio) in runs {
            impact.run(out, edge, ratio, element)?;
        }
    }
    Ok(())
}

impl Impact {
    fn run(
        &self,
        out: &mut impl Write,
        edge: f64,
        ratio: f64,
        element: Element,
    ) -> Result<(), Box<dyn Error>> {
        let start = Instant::now();
        let (r, v) = (self.material.radius, self.speed);
        let mass = 4.0 / 3.0 * PI * r.powi(3) * self.density;
        let approach = self.material.largest_approach(mass, v);
        let a = self.material.contact_radius(approach);
        let order = if element == Element::T10 { 2.0 } else { 1.0 };
        let finest = order * edge * r;
        let ball = Ball {
            radius: r,
            whole: true,
            finest,
            reach: (1.3 * a).max(2.5 * finest),
            coarsest: 0.25 * r,
        };
        let mesh = ball.mesh()?;
        // Edges of quadratic tetrahedra are counted as half.
        let fine = ball.edge(&mesh) / order;
        // The mass is that of the ball, not of its polyhedron.
        let density = mass / mesh.volume();
        let model = setting::model(&mesh, element, &self.material, density, self.law)?;
        let setting = Setting::new(&model, ratio * self.material.young / fine)?;
        let mut world = World::new(setting::smooth(0.9))?;
        let stiffness = ContactStiffness::Penalty(setting.penalty);
        let id = world.add_model("ball", model, stiffness)?;
        let spec = |pose, speed| DeformableSpec {
            velocity: Vector3::new(0.0, 0.0, speed),
            ..DeformableSpec::at_rest(id, pose)
        };
        if self.two {
            world.add_deformable(spec(setting::turned(PI, Vector3::new(0.0, 0.0, -r)), v))?;
        } else {
            let floor = Wall::half_space("floor", Vector3::z(), 0.0)?;
            world.add_wall(floor, Drive::Fixed)?;
        }
        let top = world.add_deformable(spec(Pose::translation(0.0, 0.0, r), -v))?;
        let duration = self.material.duration(mass, v);
        let (mut curve, mut last) = (Vec::new(), 0.0);
        while world.time() < 1.3 * duration {
            world.step()?;
            let force = world.deformable_contacts().next();
            let force = force.map_or(0.0, |c| c.force_on_b().z);
            curve.push((world.time(), force));
            if force > 0.0 {
                last = world.time();
            }
        }
        let peak = curve.iter().map(|(_, f)| *f).fold(0.0, f64::max);
        let body = world.deformable(top).ok_or("the ball is there")?;
        let velocities = body.velocities().iter().zip(body.model().masses());
        let momentum: Vector3 = velocities.map(|(v, m)| v * *m).sum();
        let exact = self.material.force(approach);
        writeln!(
            out,
            "impact\t{}\t{element:?}\t{edge}\t{:.4}\t{}\t{ratio}\t{:.2}\t{:.5e}\t{:.5}\t{:.5e}\t{:.5}\t{:.5}\t{:.2e}\t{}\t{:.1}",
            self.name,
            fine / r,
            mesh.tets().len(),
            a / fine,
            peak,
            peak / exact,
            last,
            last / duration,
            momentum.z / mass / v,
            world.ledger().error_relative(),
            world.steps(),
            start.elapsed().as_secs_f64(),
        )?;
        let every = (curve.len() / POINTS).max(1);
        for (t, f) in curve.iter().step_by(every) {
            writeln!(
                out,
                "curve\t{}\t{element:?}\t{edge}\t{ratio}\t{:.5}\t{:.5}",
                self.name,
                t / duration,
                f / exact
            )?;
        }
        out.flush()?;
        Ok(())
    }
}
