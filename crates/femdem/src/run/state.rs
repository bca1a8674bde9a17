//! The state of a simulation as plain data: what is measured, drawn and tabulated.

use std::collections::BTreeMap;
use std::io::{self, Write};

use femdem_contact::{BodyId, Contact, Partner as Side};
use femdem_mesh::{Point3, Polyhedron, Pose, Rotation, Vector3};
use femdem_solve::Deformable;
use femdem_view::output::csv::quoted;

use super::inside::inside;
use super::names::Names;
use super::pieces::BreakableBody;
use super::words::in_entry;
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
    /// Bodies are in the order of the members, whose numbers are `sequence`, without those that have left. A deformable body has a
    /// shape of its own: its present skin, about its centroid. Of one that has cracked each piece that is no body yet is one with the number
    /// of the whole and a shape in which the cracks that do not separate it are closed; contacts belong to the piece nearest to
    /// them.
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
        let mut broken = self.breakable_bodies().peekable();
        let there = |(member, _): &(&Member, u32)| member.id != Member::GONE;
        for (member, number) in self.members.iter().zip(0_u32..).filter(there) {
            let own = broken.next_if(|body| body.member == number as usize);
            let has_pieces = |b: &BreakableBody| b.entry.of.is_some() || b.cracks.mesh().is_some();
            if let Some(body) = own.filter(has_pieces) {
                let pieces = body.add_pieces(&mut snapshot, &mut names);
                let pieces = pieces.map_err(in_entry(format!("body \"{}\"", member.name)))?;
                numbers.insert(member.id, pieces);
                continue;
            }
            let first = snapshot.bodies.len() as u32;
            numbers.insert(
                member.id,
                Pieces {
                    first,
                    places: Vec::new(),
                },
            );
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

    fn rows(&self, numbers: &BTreeMap<BodyId, Pieces>) -> Vec<ContactRow> {
        let world = &self.world;
        let renumbered = |mut row: ContactRow| {
            let at = row.point.coords;
            row.body = numbers[&row.body].number_at(&at);
            if let Partner::Body(other) = &mut row.partner {
                *other = numbers[other].number_at(&at);
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

/// The bodies of a snapshot that a body has become.
struct Pieces {
    /// The number of the first.
    first: u32,
    /// Places of their points \[m\] with their numbers; none of a body that is whole.
    places: Vec<(Vector3, u32)>,
}

impl Pieces {
    /// The number of the body nearest to a place \[m\].
    fn number_at(&self, at: &Vector3) -> u32 {
        let far = |place: &&(Vector3, u32)| (place.0 - at).norm_squared();
        let nearest = self.places.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.map_or(self.first, |(_, number)| *number)
    }
}

impl BreakableBody<'_> {
    /// Adds each of its pieces as a body to a snapshot.
    fn add_pieces(&self, snapshot: &mut Snapshot, names: &mut Names) -> Result<Pieces, Error> {
        let first = snapshot.bodies.len() as u32;
        let mut places = Vec::new();
        for piece in self.pieces() {
            let number = snapshot.bodies.len() as u32;
            let points = self.places(&piece).into_values();
            places.extend(points.map(|point| (point.coords + piece.centre, number)));
            let polyhedron = self.surface(&piece)?;
            let name = names.of("body", "", &self.entry.name)?;
            snapshot.bodies.push(Body {
                shape: snapshot.shapes.len() as u32,
                pose: Pose::from_parts(piece.centre.into(), Rotation::identity()),
                sequence: self.member as u32,
                sleeping: self.body.is_asleep(),
            });
            snapshot.shapes.push(NamedShape { name, polyhedron });
            snapshot.masses.push(piece.mass);
            snapshot.velocities.push(piece.velocity);
        }
        Ok(Pieces { first, places })
    }
}

/// The present surface of a deformable body, about its centroid.
fn skin(body: &Deformable) -> Result<Polyhedron, Error> {
    let (positions, centroid) = (body.positions(), body.centroid());
    let place = |i: usize| Point3::from(positions[i] - centroid);
    Ok(body.model().mesh().moved_surface(place)?)
}
