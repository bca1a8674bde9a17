//! A deformable body that becomes rigid, in the form that it has.

use super::super::State;
use super::spin::Kept;
use super::{Fidelity, FidelityChange};
use crate::body::{Body, BodySpec, Shape};
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::{BodyId, Field};
use femdem_mesh::nalgebra::{Rotation3, Translation3, UnitQuaternion};
use femdem_mesh::{Matrix3, Pose, TetMesh, Vector3};

impl World {
    /// Makes a deformable body rigid that uses `ratio` of its strength.
    pub(super) fn harden(&mut self, id: BodyId, ratio: f64) -> Result<(), SolveError> {
        let own = self.adaptives.as_deref();
        let Some(own) = own.and_then(|all| all.bodies.get(&id)) else {
            return Ok(());
        };
        let own_shape = own.own_shape;
        let before = self.ledger();
        let friction = self.friction_of(id);
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let (model, state) = deformables.parts(id);
        let masses = model.model.masses();
        let kept = Kept {
            mass: masses.iter().sum(),
            momentum: state.momentum(masses),
            angular_momentum: state.angular_momentum(masses, &Vector3::zeros()),
        };
        let load = crate::applied::AppliedLoad::from(femdem_contact::Wrench {
            force: state.pull * kept.mass,
            torque: Vector3::zeros(),
        });
        let pose = pose_of(model.model.nodes(), &state.positions, masses);
        let pose = pose.ok_or(SolveError::CannotAdapt {
            needs: "nodes that turn with it",
            found: "nodes on a line",
        })?;
        let back = pose.inverse();
        let points = state.positions.iter();
        let points = points.map(|x| back * femdem_mesh::Point3::from(*x));
        let mesh = TetMesh::new(points.collect(), model.model.mesh().tets().to_vec())?;
        let shape = Shape::meshed(&model.name, &mesh.surface()?, &mesh, Field::Body)?;
        let density = kept.mass / shape.volume;
        let shape = self.own_shape(own_shape, shape)?;
        self.batch.make_rigid(id, shape)?;
        if let Some(deformables) = self.deformables.as_deref_mut() {
            deformables.bodies[id as usize] = State::vacant();
            deformables.bound = None;
        }
        let spec = BodySpec::at_rest(shape, density, pose);
        let contact = &self.batch.shapes()[shape as usize];
        let of_shape = &self.shapes[shape as usize];
        let mut body = Body::new(&spec, of_shape, contact.radius())?;
        body.mass = kept.mass;
        body.velocity = kept.momentum / kept.mass;
        let about = kept.angular_momentum - body.position.cross(&kept.momentum);
        body.momentum = body.orientation.inverse_transform_vector(&about);
        body.set_load(&load, of_shape);
        self.step_control.launch(&body);
        self.motions[id as usize] = body.motion();
        self.bodies[id as usize] = body;
        let at = self.awake.partition_point(|&other| other < id);
        self.awake.insert(at, id);
        self.step_control.lose();
        self.meet_with(&friction)?;
        let energy = self.book_fidelity(&before);
        self.note_change(
            id,
            None,
            Some(shape),
            FidelityChange {
                body: id,
                to: Fidelity::Rigid,
                time: self.time,
                ratio,
                energy,
            },
        );
        Ok(())
    }

    /// Puts a shape in the place of the one that the body had alone, or in a new one.
    fn own_shape(&mut self, own: Option<u32>, shape: Shape) -> Result<u32, SolveError> {
        let contact = shape.contact()?;
        match own {
            Some(number) => {
                self.batch.replace_shape(number, contact)?;
                self.shapes[number as usize] = shape;
                Ok(number)
            }
            None => {
                self.shapes.push(shape);
                Ok(self.batch.add_shape(contact))
            }
        }
    }
}

/// The rigid motion that fits the way of masses (kg) from `from` to `to` (m) best: with their second moment about the centres,
/// Σ m (y − d) ⊗ (x − c) = U S Vᵀ, the rotation is U Vᵀ. `None` for nodes on a line.
fn pose_of(from: &[Vector3], to: &[Vector3], masses: &[f64]) -> Option<Pose> {
    let [c, d] = [from, to].map(|all| super::super::centroid(all, masses));
    let mut second = Matrix3::zeros();
    for ((x, y), m) in from.iter().zip(to).zip(masses) {
        second += (y - d) * (x - c).transpose() * *m;
    }
    let svd = second.svd(true, true);
    let turn = svd.u? * svd.v_t?;
    if turn.determinant() <= 0.0 {
        return None;
    }
    let turn = Rotation3::from_matrix_unchecked(turn);
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
    Some(Pose::from_parts(Translation3::from(d - turn * c), turn))
}
