//! A world that was written and read is the same world, in every state that calls can reach.

use super::block;
use femdem_contact::{ContactParameters, Field, Wall};
use femdem_fem::element::Element;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, ImplicitStep, Medium, SolveError, World,
    WorldParameters, WorldRelaxation,
};
use proptest::prelude::*;

/// A call that changes a world.
#[derive(Debug, Clone)]
enum Call {
    AddShape,
    AddMeshShape,
    AddModel,
    /// Of a shape, at a place, with a speed.
    AddBody(u32, [f64; 3], f64),
    AddDriven(u32, [f64; 3]),
    AddDeformable([f64; 3], f64),
    AddFloor(bool),
    DriveWall(u32),
    Step(u32),
    Stop,
    WakeAll,
    SetSleeping(bool),
    SetSleepRule(u32, bool),
    SetContact(f64),
    SetTimeStep(bool),
    StepExplicitly,
    SetMedium(f64),
    SetSelfContact(u32, bool),
    Relax,
}

const SHAKE: Drive = Drive::Shake {
    stroke: Vector3::new(0.0, 0.0, 0.002),
    frequency: 50.0,
    start: 0.0,
    periods: 2,
};

impl Call {
    /// Makes the call; the outcome as text, to be compared.
    fn on(&self, world: &mut World) -> String {
        match self.try_on(world) {
            Ok(text) => text,
            Err(error) => format!("refused: {error}"),
        }
    }

    fn try_on(&self, world: &mut World) -> Result<String, SolveError> {
        let told = |done: &dyn std::fmt::Debug| Ok(format!("{done:?}"));
        match self {
            Self::AddShape => {
                let cube = "P5".parse::<CatalogueShape>().unwrap();
                told(&world.add_shape("cube", &cube.polyhedron(0.1).unwrap())?)
            }
            Self::AddMeshShape => {
                let mesh = TetMesh::block([2, 1, 1], &Vector3::new(0.1, 0.05, 0.05)).unwrap();
                let surface = mesh.surface().unwrap();
                told(&world.add_mesh_shape("bar", &surface, &mesh, Field::Body)?)
            }
            Self::AddModel => {
                let model = block([1, 1, 1], [0.06; 3], Element::T4, 1e6);
                told(&world.add_model("block", model, ContactStiffness::default())?)
            }
            Self::AddBody(shape, at, speed) => {
                let mut spec =
                    BodySpec::at_rest(*shape, 2000.0, Pose::translation(at[0], at[1], at[2]));
                spec.velocity.z = -speed;
                told(&world.add_body(spec)?)
            }
            Self::AddDriven(shape, at) => {
                let spec =
                    BodySpec::at_rest(*shape, 2000.0, Pose::translation(at[0], at[1], at[2]));
                told(&world.add_driven_body(spec, SHAKE)?)
            }
            Self::AddDeformable(at, speed) => {
                let at = Pose::translation(at[0], at[1], at[2]);
                // The first model, if there is one: its index cannot be made otherwise.
                let Some(model) = world.deformables().next().map(|d| d.model_id()) else {
                    let model = block([1, 1, 1], [0.06; 3], Element::T4, 1e6);
                    let model = world.add_model("block", model, ContactStiffness::default())?;
                    return told(&world.add_deformable(DeformableSpec::at_rest(model, at))?);
                };
                told(&world.add_deformable(DeformableSpec {
                    velocity: Vector3::new(0.0, 0.0, -speed),
                    ..DeformableSpec::at_rest(model, at)
                })?)
            }
            Self::AddFloor(driven) => {
                let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
                let drive = if *driven { SHAKE } else { Drive::Fixed };
                told(&world.add_wall(floor, drive)?)
            }
            Self::DriveWall(wall) => told(&world.drive_wall(*wall, SHAKE)?),
            Self::Step(count) => {
                for _ in 0..*count {
                    world.step()?;
                }
                told(&world.time_step())
            }
            Self::Stop => told(&world.stop()),
            Self::WakeAll => told(&world.wake_all()),
            Self::SetSleeping(enabled) => told(&world.set_sleeping(*enabled)),
            Self::SetSleepRule(window, deformables) => {
                let mut rule = world.parameters().sleeping;
                (rule.window, rule.deformables) = (*window, *deformables);
                told(&world.set_sleep_rule(rule)?)
            }
            Self::SetContact(penalty) => told(&world.set_contact(ContactParameters {
                penalty: *penalty,
                ..world.parameters().contact
            })?),
            Self::SetTimeStep(implicit) => {
                let mut step = world.parameters().time_step;
                step.implicit = implicit.then(ImplicitStep::default);
                told(&world.set_time_step(step)?)
            }
            Self::StepExplicitly => told(&world.step_explicitly()?),
            Self::SetMedium(drag) => told(&world.set_medium(Medium {
                drag: *drag,
                ..Medium::default()
            })?),
            Self::SetSelfContact(body, on) => told(&world.set_self_contact(*body, *on)?),
            Self::Relax => told(&world.relax(&WorldRelaxation {
                steps: 40,
                ..WorldRelaxation::default()
            })?),
        }
    }
}

/// Near enough to one another that many touch.
fn place() -> impl Strategy<Value = [f64; 3]> {
    [-0.06..0.06_f64, -0.06..0.06_f64, 0.025..0.15_f64]
}

fn speed() -> impl Strategy<Value = f64> {
    prop_oneof![4 => Just(0.0), 2 => 0.1..2.0_f64, 1 => Just(1e8), 1 => Just(1e300)]
}

fn calls() -> impl Strategy<Value = Call> {
    prop_oneof![
        2 => Just(Call::AddShape),
        1 => Just(Call::AddMeshShape),
        1 => Just(Call::AddModel),
        6 => (0_u32..3, place(), speed()).prop_map(|(s, at, v)| Call::AddBody(s, at, v)),
        1 => (0_u32..3, place()).prop_map(|(s, at)| Call::AddDriven(s, at)),
        2 => (place(), speed()).prop_map(|(at, v)| Call::AddDeformable(at, v)),
        2 => any::<bool>().prop_map(Call::AddFloor),
        1 => (0_u32..3).prop_map(Call::DriveWall),
        8 => prop_oneof![4 => 1_u32..4, 1 => Just(60)].prop_map(Call::Step),
        1 => Just(Call::Stop),
        1 => Just(Call::WakeAll),
        1 => any::<bool>().prop_map(Call::SetSleeping),
        1 => (10_u32..30, any::<bool>()).prop_map(|(w, d)| Call::SetSleepRule(w, d)),
        1 => prop_oneof![Just(1e5), Just(1e7), Just(-1.0)].prop_map(Call::SetContact),
        1 => any::<bool>().prop_map(Call::SetTimeStep),
        1 => Just(Call::StepExplicitly),
        1 => Just(Call::Relax),
        1 => (0.0..10.0_f64).prop_map(Call::SetMedium),
        1 => (0_u32..3, any::<bool>()).prop_map(|(body, on)| Call::SetSelfContact(body, on)),
    ]
}

fn read(world: &World) -> World {
    World::from_bytes(&world.to_bytes().unwrap()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]

    /// The hash is that of what was written, and goes on to be it.
    #[test]
    fn a_world_that_was_read_is_the_same(calls in prop::collection::vec(calls(), 0..24)) {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let mut twin = read(&world);
        prop_assert_eq!(twin.state_hash().unwrap(), world.state_hash().unwrap(), "empty");
        for (k, call) in calls.iter().enumerate() {
            let told = [&mut world, &mut twin].map(|w| call.on(w));
            prop_assert_eq!(&told[0], &told[1], "call {} {:?}", k, call);
            prop_assert_eq!(
                twin.state_hash().unwrap(), world.state_hash().unwrap(), "after call {} {:?}: {}", k, call, &told[0]
            );
            twin = read(&world);
            prop_assert_eq!(
                twin.state_hash().unwrap(), world.state_hash().unwrap(), "read after call {} {:?}: {}", k, call, &told[0]
            );
        }
    }
}
