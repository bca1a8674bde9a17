//! Taylor's impact test: a copper bar strikes a rigid, smooth wall.
//!
//! Wilkins and Guinan, J. Appl. Phys. 44, 1200 (1973), in the form that element studies use.

use crate::meshes::quarter_cylinder;
use femdem_mesh::Vector3;
use femdem_solve::SolveError;
use femdem_solve::deformable::{DeformableModel, MaterialRegion, Workspace};
use femdem_solve::element::Element;
use femdem_solve::material::J2;

const LENGTH: f64 = 32.4e-3;
const RADIUS: f64 = 3.2e-3;
const SPEED: f64 = 227.0;
const END: f64 = 80e-6;
/// Share of the bound of the stable step that is used.
const SAFETY: f64 = 0.9;
/// Steps after which the stable step is looked up again.
const RENEWAL: usize = 10;

/// Shape of the bar at the end.
#[derive(Debug)]
pub struct Outcome {
    pub elements: usize,
    pub steps: usize,
    /// m
    pub length: f64,
    /// Of the face on the wall, m.
    pub radius: f64,
    /// Change of kinetic + elastic energy + plastic work, over the energy at the start.
    pub energy_error: f64,
}

/// Follows a quarter of the bar to 80 microseconds.
///
/// # Errors
/// If an element is inverted.
pub fn run(
    element: Element,
    rings: u32,
    layers: u32,
) -> Result<Outcome, Box<dyn std::error::Error>> {
    let mesh = quarter_cylinder(RADIUS, LENGTH, rings, layers)?;
    let copper = MaterialRegion {
        material: J2::new(117e9, 0.35, 400e6, 100e6)?.into(),
        density: 8930.0,
    };
    let model = DeformableModel::new(&mesh, element, vec![copper], None)?;
    let mut bar = Bar::new(&model);
    let mut time = 0.0;
    while time < END {
        if bar.steps % RENEWAL == 0 {
            bar.dt = SAFETY * bar.stable_step()?;
        }
        bar.step(bar.dt.min(END - time))?;
        time += bar.dt;
    }
    Ok(bar.outcome())
}

struct Bar<'a> {
    model: &'a DeformableModel,
    x: Vec<Vector3>,
    v: Vec<Vector3>,
    forces: Vec<Vector3>,
    old: Vec<f64>,
    new: Vec<f64>,
    work: Workspace,
    /// Components that may move.
    free: Vec<Vector3>,
    dt: f64,
    steps: usize,
    stored: f64,
    dissipated: f64,
}

impl<'a> Bar<'a> {
    fn new(model: &'a DeformableModel) -> Self {
        let nodes = model.nodes();
        let free: Vec<Vector3> = nodes
            .iter()
            .map(|x| x.map(|c| f64::from(u8::from(c != 0.0))))
            .collect();
        Self {
            model,
            x: nodes.to_vec(),
            v: free
                .iter()
                .map(|f| Vector3::new(0.0, 0.0, -SPEED * f.z))
                .collect(),
            forces: vec![Vector3::zeros(); nodes.len()],
            old: vec![0.0; model.history_len()],
            new: vec![0.0; model.history_len()],
            work: Workspace::default(),
            free,
            dt: 0.0,
            steps: 0,
            stored: 0.0,
            dissipated: 0.0,
        }
    }

    fn stable_step(&self) -> Result<f64, SolveError> {
        Ok(self
            .model
            .stable_frequency2(&self.x, &self.old)?
            .critical_step())
    }

    /// Kick, drift, forces, kick.
    fn step(&mut self, dt: f64) -> Result<(), SolveError> {
        self.kick(0.5 * dt);
        for (x, v) in self.x.iter_mut().zip(&self.v) {
            *x += dt * v;
        }
        let state = self.model.internal_forces(
            &self.x,
            &self.v,
            &self.old,
            &mut self.new,
            &mut self.forces,
            &mut self.work,
        )?;
        std::mem::swap(&mut self.old, &mut self.new);
        self.stored = state.energy;
        self.dissipated += state.plastic_work;
        self.kick(0.5 * dt);
        self.steps += 1;
        Ok(())
    }

    fn kick(&mut self, dt: f64) {
        let nodes = self.v.iter_mut().zip(&self.forces).zip(&self.free);
        for (((v, f), free), m) in nodes.zip(self.model.masses()) {
            *v += (dt / m) * f.component_mul(free);
        }
    }

    fn outcome(&self) -> Outcome {
        let reference = self.model.nodes();
        let on_wall = self.x.iter().zip(reference).filter(|(_, r)| r.z == 0.0);
        let kinetic: f64 = self
            .v
            .iter()
            .zip(self.model.masses())
            .map(|(v, m)| 0.5 * m * v.norm_squared())
            .sum();
        let start: f64 = 0.5 * SPEED * SPEED * self.model.masses().iter().sum::<f64>();
        // Nodes on the wall have no velocity from the start.
        let lost: f64 = self
            .free
            .iter()
            .zip(self.model.masses())
            .map(|(f, m)| 0.5 * m * SPEED * SPEED * (1.0 - f.z))
            .sum();
        Outcome {
            elements: self.model.volumes().len(),
            steps: self.steps,
            length: self.x.iter().map(|x| x.z).fold(0.0, f64::max),
            radius: on_wall.map(|(x, _)| x.x.hypot(x.y)).fold(0.0, f64::max),
            energy_error: (kinetic + self.stored + self.dissipated - start + lost) / start,
        }
    }
}
