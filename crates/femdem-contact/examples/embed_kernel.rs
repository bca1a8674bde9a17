//! How to embed this crate in your granular code: the host has its own bodies, integrator and thread pool,
//! and takes its contacts from layers 1 and 2.
//!
//! ```text
//! cargo run --release -p femdem-contact --example embed_kernel
//! ```
//!
//! Part 1 evaluates one pair at a time: a tetrapod flies at a cube, and the pair kernel is called in every
//! step. Part 2 gives 27 cubes and tetrapods in a box to the batch. Nothing is damped, so energy must be
//! conserved; both parts print the error.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use femdem_contact::general::{GeneralCache, GeneralScratch};
use femdem_contact::{
    BodyShape, ContactBatch, ContactLaw, ContactParameters, ConvexShape, Field, FieldMesh, Frame,
    GeneralKernel, Motion, Wall,
};
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::{MeshOptions, mesh};
use femdem_mesh::{Matrix3, Polyhedron, Rotation, Vector3};
use std::error::Error;
use std::sync::Arc;

const DENSITY: f64 = 2500.0;
const SIZE: f64 = 0.1;
const PENALTY: f64 = 5e6;
const GRAVITY: Vector3 = Vector3::new(0.0, 0.0, -9.81);

/// A body in the host's data structure, which the kernel never sees.
#[derive(Debug, Clone)]
struct Grain {
    position: Vector3,
    rotation: Rotation,
    velocity: Vector3,
    /// Angular momentum about the centroid, kg m^2/s: torques change it.
    spin: Vector3,
    mass: f64,
    /// Inverse inertia in body axes, 1/(kg m^2).
    inverse_inertia: Matrix3,
    /// Largest distance of a vertex from the centroid, m.
    radius: f64,
    /// Upper bound of the distance that any of its points has travelled, m: the caches need it.
    travelled: f64,
}

impl Grain {
    /// A grain at rest. The kernels' body frames have the centroid as their origin.
    fn new(body: &Polyhedron, position: Vector3) -> Option<Self> {
        let properties = body.mass_properties();
        let centroid = properties.centroid;
        let far = |m: f64, v: &femdem_mesh::Point3| m.max((v - centroid).norm());
        Some(Self {
            position,
            rotation: Rotation::identity(),
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            mass: DENSITY * properties.volume,
            inverse_inertia: (properties.inertia * DENSITY).try_inverse()?,
            radius: body.vertices().iter().fold(0.0, far),
            travelled: 0.0,
        })
    }

    fn frame(&self) -> Frame {
        Frame {
            position: self.position,
            rotation: self.rotation.to_rotation_matrix().into_inner(),
        }
    }

    /// Inverse inertia in world axes.
    fn inverse_inertia(&self) -> Matrix3 {
        let r = self.rotation.to_rotation_matrix().into_inner();
        r * self.inverse_inertia * r.transpose()
    }

    fn angular_velocity(&self) -> Vector3 {
        self.inverse_inertia() * self.spin
    }

    fn kinetic_energy(&self) -> f64 {
        let turning = self.spin.dot(&self.angular_velocity());
        0.5 * (self.mass * self.velocity.norm_squared() + turning)
    }

    fn kick(&mut self, force: &Vector3, torque: &Vector3, dt: f64) {
        self.velocity += force * (dt / self.mass);
        self.spin += torque * dt;
    }

    /// Moves and turns by the midpoint rule, and counts the travel.
    fn drift(&mut self, dt: f64) {
        let turned = |by: Vector3| Rotation::from_scaled_axis(by) * self.rotation;
        let mut middle = self.clone();
        middle.rotation = turned(self.angular_velocity() * (0.5 * dt));
        let angular_velocity = middle.angular_velocity();
        self.position += self.velocity * dt;
        self.rotation = turned(angular_velocity * dt);
        self.travelled += (self.velocity.norm() + angular_velocity.norm() * self.radius) * dt;
    }

    /// The input of layer 2.
    fn motion(&self) -> Motion {
        let inverse_inertia = self.inverse_inertia();
        Motion {
            velocity: self.velocity,
            angular_velocity: self.angular_velocity(),
            inverse_mass: 1.0 / self.mass,
            inverse_inertia,
            // The Frobenius norm is no smaller than the largest eigenvalue.
            inverse_inertia_max: inverse_inertia.norm(),
            travelled: self.travelled,
            ..Motion::fixed(self.frame())
        }
    }
}

/// The two bodies of this example: surfaces for their mass, prepared shapes for the kernels.
struct Shapes {
    cube: Polyhedron,
    tetrapod: Polyhedron,
    convex: Arc<ConvexShape>,
    meshed: Arc<FieldMesh>,
}

impl Shapes {
    fn new() -> Result<Self, Box<dyn Error>> {
        let cube = "P5".parse::<Shape>()?.polyhedron(SIZE)?;
        let tetrapod = "tetrapod".parse::<Shape>()?.polyhedron(SIZE)?;
        let (tets, _) = mesh(&tetrapod, &MeshOptions::default())?;
        let centroid = tetrapod.mass_properties().centroid.coords;
        let meshed = FieldMesh::new(&tets, centroid, Field::Body)?;
        Ok(Self {
            convex: Arc::new(ConvexShape::new(&cube)?),
            meshed: Arc::new(meshed),
            cube,
            tetrapod,
        })
    }

    fn surface(&self, shape: usize) -> &Polyhedron {
        [&self.cube, &self.tetrapod][shape % 2]
    }
}

/// Part 1, layer 1: the pair kernel in the host's own loop. Two bodies in free flight collide;
/// returns the relative errors of energy and momentum, and in how many steps they touched.
fn collide(shapes: &Shapes) -> Result<(f64, f64, u32), Box<dyn Error>> {
    // A cube as tetrahedra has the same field as the convex shape, for contact with meshes. For
    // two convex bodies take PairKernel with ConvexShape, which is several times faster.
    let cube = shapes.convex.fan()?;
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut a = Grain::new(&shapes.cube, Vector3::zeros()).ok_or("flat")?;
    let start = Vector3::new(0.12, 0.01, 0.02);
    let mut b = Grain::new(&shapes.tetrapod, start).ok_or("flat")?;
    b.velocity = Vector3::new(-2.0, 0.0, 0.0);
    let energy = a.kinetic_energy() + b.kinetic_energy();
    let momentum = b.velocity * b.mass;

    // The cache and the buffers belong to the host: one cache per pair, one scratch per thread.
    let (mut cache, mut scratch) = (GeneralCache::default(), GeneralScratch::default());
    let (dt, mut touching) = (2e-6, 0);
    for _ in 0..50_000 {
        a.drift(0.5 * dt);
        b.drift(0.5 * dt);
        let motion = a.travelled + b.travelled;
        let (frame_a, frame_b) = (a.frame(), b.frame());
        let patches = kernel.evaluate_cached(
            &cube,
            &frame_a,
            &shapes.meshed,
            &frame_b,
            &mut cache,
            motion,
            &mut scratch,
        );
        // Bodies that are not convex may touch in several places, with one patch each.
        touching += u32::from(!patches.is_empty());
        for patch in patches {
            let overlap = &patch.overlap;
            a.kick(&-overlap.force, &overlap.torque_a(), dt);
            b.kick(&overlap.force, &overlap.torque_b(), dt);
        }
        a.drift(0.5 * dt);
        b.drift(0.5 * dt);
    }
    let after = a.velocity * a.mass + b.velocity * b.mass;
    let change = a.kinetic_energy() + b.kinetic_energy() - energy;
    let momentum_error = (after - momentum).norm() / momentum.norm();
    Ok((change / energy, momentum_error, touching))
}

/// Part 2, layer 2: the batch finds the pairs, keeps caches and friction history, and returns loads.
struct Host {
    grains: Vec<Grain>,
    batch: ContactBatch,
    walls: Vec<Motion>,
    pool: rayon::ThreadPool,
}

impl Host {
    fn new(shapes: &Shapes) -> Result<Self, Box<dyn Error>> {
        let law = ContactLaw::new(ContactParameters {
            penalty: PENALTY,
            friction: 0.0,
            damping_ratio: 0.0,
            ..ContactParameters::default()
        })?;
        let mut batch = ContactBatch::new(law);
        let kinds = [
            batch.add_shape(BodyShape::from(shapes.convex.clone())),
            batch.add_shape(BodyShape::from(shapes.meshed.clone())),
        ];
        let mut grains = Vec::new();
        for i in 0..27_usize {
            let cell = Vector3::from([i % 3, i / 3 % 3, i / 9].map(|k| k as f64));
            let at = cell.add_scalar(0.5) * (1.1 * SIZE);
            let mut grain = Grain::new(shapes.surface(i), at).ok_or("flat")?;
            let turn = i as f64;
            grain.velocity = Vector3::new(turn.sin(), turn.cos(), (2.0 * turn).sin());
            batch.add_body(kinds[i % 2])?;
            grains.push(grain);
        }
        let walls = Wall::closed_box(Vector3::zeros(), Vector3::repeat(3.3 * SIZE))?;
        for wall in &walls {
            batch.add_wall(wall.clone());
        }
        Ok(Self {
            grains,
            batch,
            walls: vec![Motion::fixed(Frame::identity()); walls.len()],
            pool: rayon::ThreadPoolBuilder::new().num_threads(2).build()?,
        })
    }

    /// Contacts of the present state, evaluated on the host's pool: the batch starts no threads.
    fn update(&mut self, dt: f64) -> Result<(), Box<dyn Error>> {
        let motions: Vec<Motion> = self.grains.iter().map(Grain::motion).collect();
        let (batch, walls) = (&mut self.batch, &self.walls);
        self.pool.install(|| batch.update(&motions, walls, dt))?;
        Ok(())
    }

    fn kick(&mut self, dt: f64) {
        for (grain, load) in self.grains.iter_mut().zip(self.batch.loads()) {
            let force = load.total.force + GRAVITY * grain.mass;
            grain.kick(&force, &load.total.torque, dt);
        }
    }

    /// Kick, drift, contacts, kick.
    fn step(&mut self, dt: f64) -> Result<(), Box<dyn Error>> {
        self.kick(0.5 * dt);
        self.grains.iter_mut().for_each(|grain| grain.drift(dt));
        self.update(dt)?;
        self.kick(0.5 * dt);
        Ok(())
    }

    /// A twentieth of the largest stable step for the present contacts, at most `most`.
    fn time_step(&self, most: f64) -> f64 {
        let motions: Vec<Motion> = self.grains.iter().map(Grain::motion).collect();
        most.min(0.05 * self.batch.stable_step(&motions))
    }

    fn kinetic_energy(&self) -> f64 {
        self.grains.iter().map(Grain::kinetic_energy).sum()
    }

    fn energy(&self) -> f64 {
        let weight = |g: &Grain| -g.mass * GRAVITY.dot(&g.position);
        let height: f64 = self.grains.iter().map(weight).sum();
        self.kinetic_energy() + height + self.batch.totals().energy
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let shapes = Shapes::new()?;
    let (energy, momentum, touching) = collide(&shapes)?;
    println!("layer 1, a cube and a tetrapod that touch for {touching} steps");
    println!("relative errors: energy {energy:.1e}, momentum {momentum:.1e}");

    let mut host = Host::new(&shapes)?;
    host.update(0.0)?;
    let start = host.energy();
    let (mut time, mut steps, mut worst, mut most) = (0.0, 0, 0.0_f64, 0);
    while time < 0.25 {
        let dt = host.time_step(2e-5);
        host.step(dt)?;
        time += dt;
        steps += 1;
        worst = worst.max((host.energy() / start - 1.0).abs());
        most = most.max(host.batch.totals().touching);
    }
    println!(
        "layer 2, {} bodies in a box: {time:.2} s in {steps} steps, up to {most} pairs in touch",
        host.grains.len()
    );
    println!("energy {start:.3} J at the start, error at most {worst:.1e} of it");
    Ok(())
}
