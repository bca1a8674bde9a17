//! The boulders and their bin.

use femdem_contact::Wall;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion, Workspace};
use femdem_mesh::nalgebra::{Quaternion, Translation3};
use femdem_mesh::shapes::{Boulder, Shape};
use femdem_mesh::{Pose, Rotation, TetMesh, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, Drive, World, WorldParameters};
use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

const YOUNG: f64 = 1e8;
const POISSON: f64 = 0.2;
const DENSITY: f64 = 2700.0;
const MASS: f64 = 40.0;
/// Width, depth and height of the bin, m.
const BIN: [f64; 3] = [5.26, 5.3, 3.87];
/// Number of different boulders.
const VARIETY: usize = 50;
/// Angularity that gives about 144 triangles, and as many tetrahedra about the centroid.
const ANGULARITY: f64 = 0.15;
/// The initial lattice: boulders along the width and the depth, and the distance of layers, m.
const ALONG: [usize; 2] = [8, 6];
const LAYER: f64 = 0.55;

/// All boulders in a world.
pub struct Pack {
    pub world: World,
    /// Number of tetrahedra of all boulders.
    pub tets: usize,
    size: f64,
}

impl Pack {
    pub fn new(count: usize, sleep: bool) -> Result<Self, Box<dyn Error>> {
        let mut parameters = WorldParameters::default();
        parameters.sleeping.deformables = sleep;
        let mut world = World::new(parameters)?;
        for wall in Wall::closed_box(
            Vector3::new(-0.5 * BIN[0], -0.5 * BIN[1], 0.0),
            Vector3::new(0.5 * BIN[0], 0.5 * BIN[1], 2.0 * BIN[2]),
        )? {
            world.add_wall(wall, Drive::Fixed)?;
        }
        let size = Boulder::size_for_mass(MASS, DENSITY)?;
        let mut cells = Vec::new();
        for seed in 0..VARIETY.min(count) {
            let boulder = Boulder {
                seed: seed as u64 + 1,
                angularity: ANGULARITY,
                ..Boulder::default()
            };
            let mesh = TetMesh::centroid_fan(&Shape::from(boulder).polyhedron(size)?)?;
            let region = MaterialRegion {
                material: NeoHookean::new(YOUNG, POISSON)?.into(),
                density: DENSITY,
            };
            cells.push(mesh.tets().len());
            let model = DeformableModel::new(&mesh, Element::T4, vec![region], None)?;
            world.add_model("boulder", model, ContactStiffness::default())?;
        }
        let mut tets = 0;
        for i in 0..count {
            let model = i % VARIETY.min(count);
            tets += cells[model];
            let spec = DeformableSpec::at_rest(model as u32, place(i));
            world.add_deformable(spec)?;
        }
        Ok(Self { world, tets, size })
    }

    /// Mean kinetic energy of a boulder over m g d, d being the diameter of the sphere of its volume.
    pub fn kinetic_energy(&self) -> f64 {
        let weight = MASS * 9.81 * self.size * self.world.deformable_count() as f64;
        self.world.kinetic_energy() / weight
    }

    /// Mean overlap volume over contact area of all contacts, over d.
    pub fn penetration(&self) -> f64 {
        let each = self.world.deformable_contacts().map(|c| c.penetration());
        let (sum, count) = each.fold((0.0, 0.0), |(s, n), p| (s + p, n + 1.0));
        sum / f64::max(count, 1.0) / self.size
    }

    /// Number of boulders with their centres above the rim.
    pub fn above_the_rim(&self) -> usize {
        let bodies = self.world.deformables();
        bodies.filter(|b| b.centroid().z > BIN[2]).count()
    }

    /// Time of the elements' forces alone, for all bodies in turn as in a step, on one thread, ns per
    /// tetrahedron.
    pub fn element_cost(&self, repeats: usize) -> Result<f64, Box<dyn Error>> {
        let (mut work, mut forces) = (Workspace::default(), Vec::new());
        let mut time = f64::INFINITY;
        for _ in 0..repeats {
            let start = Instant::now();
            for body in self.world.deformables() {
                let x = body.positions();
                forces.resize(x.len(), Vector3::zeros());
                body.model().forces_without_energy(
                    x,
                    body.velocities(),
                    &[],
                    &mut [],
                    &mut forces,
                    &mut work,
                )?;
            }
            // The smallest time: other programs use the machine too.
            time = time.min(start.elapsed().as_secs_f64());
        }
        Ok(1e9 * time / self.tets as f64)
    }

    /// Writes the present surfaces, and a table with their poses, for `femdem picture`.
    pub fn write(&self, folder: &Path) -> Result<(), Box<dyn Error>> {
        std::fs::create_dir_all(folder)?;
        let mut table = "shape,x,y,z,qw,qx,qy,qz\n".to_owned();
        for (i, body) in self.world.deformables().enumerate() {
            let c = body.centroid();
            let mut obj = String::new();
            for x in body.positions() {
                let x = x - c;
                writeln!(obj, "v {} {} {}", x.x, x.y, x.z)?;
            }
            for [a, b, c] in body.model().mesh().skin() {
                writeln!(obj, "f {} {} {}", a + 1, b + 1, c + 1)?;
            }
            std::fs::write(folder.join(format!("boulder{i}.obj")), obj)?;
            writeln!(table, "boulder{i},{},{},{},1,0,0,0", c.x, c.y, c.z)?;
        }
        std::fs::write(folder.join("bodies.csv"), table)?;
        Ok(())
    }
}

/// Initial pose of boulder `i`: on a lattice, rotated at random.
fn place(i: usize) -> Pose {
    let layer = ALONG[0] * ALONG[1];
    let (x, y, z) = (i % ALONG[0], i % layer / ALONG[0], i / layer);
    let at = |k: usize, axis: usize| BIN[axis] * ((k as f64 + 0.5) / ALONG[axis] as f64 - 0.5);
    let to = Vector3::new(at(x, 0), at(y, 1), LAYER * (z as f64 + 0.5));
    let component = |k: usize| {
        let x = (12.9898 * (i + 1) as f64 + 78.233 * (k + 1) as f64).sin() * 43_758.545_3;
        x - x.floor() - 0.5
    };
    let turn = Quaternion::new(component(0), component(1), component(2), component(3));
    Pose::from_parts(Translation3::from(to), Rotation::new_normalize(turn))
}
