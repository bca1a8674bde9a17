//! The state of a simulation as plain data: what is measured, drawn and tabulated.

use std::collections::BTreeMap;
use std::io::{self, Write};

use femdem_contact::{BodyId, Contact, Partner as Side};
use femdem_mesh::{Point3, Polyhedron, Pose, Rotation, Vector3};
use femdem_solve::Deformable;
use femdem_view::output::csv::quoted;

use super::build::in_entry;
use super::inside::inside;
use super::names::Names;
use super::{Member, Simulation};
use crate::results::{from_a_body, row, surface_of};
use crate::{Body, ContactClass, ContactRow, Error, NamedShape, Partner, Snapshot};

/// Header of `walls.csv`.
pub(super) const WALL_COLUMNS: &str = "wall,x,y,z,qw,qx,qy,qz,fx,fy,fz";

/// A component of gravity beside -z that is at most this part of it does not count.
const UPRIGHT: f64 = 1e-9;

impl Simulation {
    /// The bodies, contacts and walls as they are, in the form that tables, measurements and pictures take.
    ///
    /// Bodies are in the order of the members, whose numbers are `sequence`, without those that have left. A deformable body has a shape of its own: its present skin, about its centroid.
    /// Contacts of deformable bodies have no class, which the [`gaps`](Snapshot::gaps) then say, and those of a body with
    /// itself are left out. The inside of the container is known where planes bound a box, or a cylinder with a floor.
    ///
    /// # Errors
    ///
    /// [`Error::Entry`] with the deformable body whose skin is no surface any more.
    pub fn snapshot(&self) -> Result<Snapshot, Error> {
        let world = &self.world;
        let mut snapshot = Snapshot::default();
        let mut names = Names::default();
        for shape in world.shapes() {
            snapshot.shapes.push(NamedShape {
                name: names.of("body", "", &shape.name)?,
                polyhedron: surface_of(shape),
            });
        }
        let mut numbers = BTreeMap::new();
        let there = |(member, _): &(&Member, u32)| member.id != Member::GONE;
        for (member, number) in self.members.iter().zip(0_u32..).filter(there) {
            numbers.insert(member.id, snapshot.bodies.len() as u32);
            let (shape, pose) = match world.deformable(member.id) {
                Some(body) => {
                    let skin = skin(&body);
                    let polyhedron = skin.map_err(in_entry(format!("body \"{}\"", member.name)))?;
                    let name = names.of("body", "", &member.name)?;
                    snapshot.shapes.push(NamedShape { name, polyhedron });
                    let shape = snapshot.shapes.len() as u32 - 1;
                    (
                        shape,
                        Pose::from_parts(body.centroid().into(), Rotation::identity()),
                    )
                }
                None => self.place(member)?,
            };
            snapshot.bodies.push(Body {
                shape,
                pose,
                sequence: number,
                sleeping: world.is_asleep(member.id),
            });
            snapshot.masses.extend(world.mass(member.id));
            snapshot.velocities.extend(world.velocity(member.id));
        }
        snapshot.contacts = self.rows(&numbers);
        snapshot.space = self.space();
        snapshot.wrap();
        snapshot.gaps.classes = world.deformable_contacts().next().is_some();
        snapshot.gravity = self.level_gravity();
        let walls = world.walls().map(|(wall, shape)| {
            let pose = world.wall_pose(wall);
            (shape, pose.unwrap_or_default())
        });
        snapshot.container = inside(walls, &snapshot);
        Ok(snapshot)
    }

    /// Gravity along -z \[m/s²\]; 0 where it has another direction.
    pub(super) fn level_gravity(&self) -> f64 {
        let gravity = self.world.parameters().gravity;
        if gravity.xy().norm() <= UPRIGHT * gravity.norm() {
            f64::max(0.0, -gravity.z)
        } else {
            0.0
        }
    }

    /// Shape and pose of a rigid member.
    fn place(&self, member: &Member) -> Result<(u32, Pose), Error> {
        let (world, id) = (&self.world, member.id);
        let place = world.shape_of(id).zip(world.pose(id));
        // Only a state that was put together by hand has a member without a body.
        place.ok_or_else(|| Error::Option {
            name: "members",
            value: format!("\"{}\"", member.name),
            allowed: "each is a body of the world",
        })
    }

    fn rows(&self, numbers: &BTreeMap<BodyId, u32>) -> Vec<ContactRow> {
        let world = &self.world;
        let renumbered = |mut row: ContactRow| {
            row.body = numbers[&row.body];
            if let Partner::Body(other) = &mut row.partner {
                *other = numbers[other];
            }
            row
        };
        let rigid = world.rigid_contacts().into_iter();
        let rigid = rigid.map(|contact| row(world, contact));
        let soft = world.deformable_contacts();
        let soft = soft.filter(|contact| contact.a != Side::Body(contact.b));
        let soft = soft.map(|contact| self.soft_row(contact));
        rigid.chain(soft).map(renumbered).collect()
    }

    fn soft_row(&self, contact: &Contact) -> ContactRow {
        let (body, partner, sign) = from_a_body(&self.world, contact.a, contact.b);
        ContactRow {
            body,
            partner,
            point: Point3::from(contact.point),
            normal: contact.normal * sign,
            normal_force: contact.normal_force,
            friction: contact.friction * sign,
            moment: (contact.rocking + contact.rolling) * sign,
            area: contact.area,
            volume: contact.volume,
            class: ContactClass::Point,
            patch: contact.patch,
        }
    }

    /// Writes `walls.csv`: for each wall its pose, from its coordinates in the scene to the world, and the force of the bodies
    /// on it \[N\].
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_walls(&self, mut writer: impl Write) -> io::Result<()> {
        writeln!(writer, "{WALL_COLUMNS}")?;
        let forces = self.forces(&self.contacts());
        for (wall, force) in self.walls.iter().zip(&forces.walls) {
            let Some(pose) = self.world.wall_pose(wall.id) else {
                continue;
            };
            let (x, q) = (pose.translation.vector, pose.rotation);
            let force = force + Vector3::zeros();
            writeln!(
                writer,
                "{},{},{},{},{},{},{},{},{},{},{}",
                quoted(&wall.name),
                x.x,
                x.y,
                x.z,
                q.w,
                q.i,
                q.j,
                q.k,
                force.x,
                force.y,
                force.z
            )?;
        }
        Ok(())
    }
}

/// The present surface of a deformable body, about its centroid.
fn skin(body: &Deformable) -> Result<Polyhedron, Error> {
    let (positions, centroid) = (body.positions(), body.centroid());
    let place = |i: usize| Point3::from(positions[i] - centroid);
    Ok(body.model().mesh().moved_surface(place)?)
}
