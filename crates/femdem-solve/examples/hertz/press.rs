//! Elastic balls pressed on a rigid plane and on each other.

use crate::ball::{Ball, Hertz};
use crate::law::Law;
use crate::setting::{self, Setting};
use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::{Boundary, DeformableModel, Selection};
use femdem_mesh::{Pose, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World, WorldRelaxation};
use std::error::Error;
use std::f64::consts::PI;
use std::io::Write;
use std::time::Instant;

const MATERIAL: Hertz = Hertz {
    young: 1e9,
    poisson: 0.3,
    radius: 0.01,
};
const DENSITY: f64 = 1000.0;

/// Approaches over the radius.
const DEPTHS: [f64; 5] = [0.01, 0.02, 0.03, 0.045, 0.06];

/// Edges at the contact over the radius.
const EDGES: [f64; 3] = [0.08, 0.055, 0.04];

/// Radius of the fine part of the mesh over the ball's: Hertz's contact radius at the largest depth is
/// 0.245.
const REACH: f64 = 0.26;

/// A finer mesh for the smallest depths only, which the others resolve least: its edge, the stiffnesses, the
/// depths and the radius of its fine part. The contact radius at the larger depth is 0.141.
const SHALLOW: (f64, [f64; 2], [f64; 2], f64) = (0.028, [1.0, 3.0], [0.01, 0.02], 0.16);

/// Time of rest between two depths, as the number of times that sound crosses the radius.
const CROSSINGS: f64 = 8.0;

/// One mesh, one stiffness.
struct Press {
    edge: f64,
    ratio: f64,
    depths: &'static [f64],
    reach: f64,
    /// Against an equal ball instead of the plane.
    two: bool,
}

/// All meshes and stiffnesses, for a ball on the plane or for two; a line for each depth.
pub fn run(out: &mut impl Write, two: bool, quick: bool) -> Result<(), Box<dyn Error>> {
    let edges = if quick { &EDGES[..1] } else { &EDGES[..] };
    let runs = edges
        .iter()
        .flat_map(|&edge| [0.3, 1.0, 3.0].map(|ratio| (edge, ratio)));
    for (edge, ratio) in runs {
        let press = Press {
            edge,
            ratio,
            depths: &DEPTHS,
            reach: REACH,
            two,
        };
        press.run(out)?;
    }
    if quick {
        return Ok(());
    }
    shallow(out, two)
}

/// The smallest depths on their own mesh.
pub fn shallow(out: &mut impl Write, two: bool) -> Result<(), Box<dyn Error>> {
    let (edge, ratios, ref depths, reach) = SHALLOW;
    for ratio in ratios {
        let press = Press {
            edge,
            ratio,
            depths,
            reach,
            two,
        };
        press.run(out)?;
    }
    Ok(())
}

impl Press {
    fn run(&self, out: &mut impl Write) -> Result<(), Box<dyn Error>> {
        let start = Instant::now();
        let r = MATERIAL.radius;
        let ball = Ball {
            radius: r,
            whole: false,
            finest: self.edge * r,
            reach: self.reach * r,
            coarsest: 0.3 * r,
        };
        let mesh = ball.mesh()?;
        let edge = ball.edge(&mesh);
        let model = setting::model(&mesh, Element::T4, &MATERIAL, DENSITY, Law::NeoHookean)?;
        let boundary = held(&model)?;
        let setting = Setting::new(&model, self.ratio * MATERIAL.young / edge)?;
        let mut world = World::new(setting::smooth(0.9))?;
        let stiffness = ContactStiffness::Penalty(setting.penalty);
        let id = world.add_model("ball", model.clone(), stiffness)?;
        let spec = |pose| DeformableSpec {
            boundary: boundary.clone(),
            ..DeformableSpec::at_rest(id, pose)
        };
        if self.two {
            let upside_down = setting::turned(PI, Vector3::new(0.0, 0.0, -r));
            world.add_deformable(spec(upside_down))?;
        } else {
            let floor = Wall::half_space("floor", Vector3::z(), 0.0)?;
            world.add_wall(floor, Drive::Fixed)?;
        }
        let top = world.add_deformable(spec(Pose::translation(0.0, 0.0, r)))?;
        // Two balls approach each other by twice the depth of each.
        let sides = if self.two { 2.0 } else { 1.0 };
        let rest = CROSSINGS * r / (MATERIAL.young / DENSITY).sqrt();
        let mut at = 0.0;
        for &depth in self.depths {
            let goal = sides * depth * r;
            let (from, time) = (at, world.time());
            let drive = Drive::Linear {
                velocity: Vector3::new(0.0, 0.0, (from - goal) / rest),
                start: time,
                end: time + rest,
            };
            let places: Vec<Vector3> = model
                .nodes()
                .iter()
                .map(|x| x + Vector3::new(0.0, 0.0, r - from))
                .collect();
            let mut moved = Boundary::default();
            moved.drive_from(&model, &equator(), [true; 3], drive, &places)?;
            world.set_boundary(top, moved)?;
            while world.time() < time + rest {
                world.step()?;
            }
            at = goal;
            let relaxed = world.relax(&WorldRelaxation {
                tolerance: 5e-4,
                ..WorldRelaxation::default()
            })?;
            let d = depth * r;
            let contact = world.deformable_contacts().next();
            let force = contact.map_or(0.0, |c| c.force_on_b().z);
            let area = contact.map_or(0.0, |c| c.area);
            let height = if self.two { -0.5 * goal } else { 0.0 };
            // A wall pushes back with 4 p phi on its plane, like the mirror image of a ball; two balls push
            // with 2 p (phi_A + phi_B) anywhere between their skins.
            let mirrors = if self.two { 1.0 } else { 2.0 };
            let bodies = world.deformables();
            let pressure: f64 = bodies
                .map(|body| 2.0 * mirrors * setting.pressure_at(body.positions(), height))
                .sum();
            writeln!(
                out,
                "hertz\t{}\t{}\t{:.4}\t{}\t{}\t{}\t{:.3}\t{:.5}\t{:.4}\t{:.4}\t{}\t{:.1}",
                if self.two { "two balls" } else { "plane" },
                self.edge,
                edge / r,
                mesh.tets().len(),
                self.ratio,
                depth,
                MATERIAL.contact_radius(d) / edge,
                force / MATERIAL.force(d),
                (area / PI).sqrt() / MATERIAL.contact_radius(d),
                pressure / MATERIAL.peak_pressure(d),
                relaxed.steps[1],
                start.elapsed().as_secs_f64(),
            )?;
            out.flush()?;
        }
        Ok(())
    }
}

fn equator() -> Selection {
    Selection::Plane {
        normal: Vector3::z(),
        offset: 0.0,
        tolerance: 1e-9,
    }
}

fn held(model: &DeformableModel) -> Result<Boundary, Box<dyn Error>> {
    let mut boundary = Boundary::default();
    boundary.fix(model, &equator(), [true; 3])?;
    Ok(boundary)
}
