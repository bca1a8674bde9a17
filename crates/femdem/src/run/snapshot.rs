//! All bodies of a simulation as a snapshot.

use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};
use femdem_solve::Deformable;

use super::contacts::{ContactLine, Side};
use super::{Member, Simulation};
use crate::results::surface_of;
use crate::{Body, ContactClass, ContactRow, Error, Gaps, NamedShape, Partner, Snapshot};

impl Simulation {
    /// All bodies as they are: the number of a body is that among the members. Deformable bodies are rigid ones of the
    /// form that they have now, by the corners of their elements; contacts have no classes, and the container is
    /// not known.
    ///
    /// # Errors
    ///
    /// [`Error::Mesh`] if a deformable body is no longer one closed surface.
    pub fn snapshot(&self) -> Result<Snapshot, Error> {
        let world = &self.world;
        let mut shapes: Vec<NamedShape> = world
            .shapes()
            .iter()
            .map(|shape| NamedShape {
                name: shape.name.clone(),
                polyhedron: surface_of(shape),
            })
            .collect();
        let mut bodies = Vec::with_capacity(self.members.len());
        let mut rows = Vec::with_capacity(self.members.len());
        for (member, sequence) in self.members.iter().zip(0..) {
            let placed = match (world.shape_of(member.id), world.pose(member.id)) {
                (Some(shape), Some(pose)) => Some((shape, pose)),
                _ => match world.deformable(member.id) {
                    Some(body) => {
                        shapes.push(present_shape(member, &body)?);
                        Some((shapes.len() as u32 - 1, Pose::identity()))
                    }
                    None => None,
                },
            };
            rows.push(placed.map(|_| bodies.len() as u32));
            bodies.extend(placed.map(|(shape, pose)| Body {
                shape,
                pose,
                sequence,
                sleeping: world.is_asleep(member.id),
            }));
        }
        let contacts = self.contacts();
        let row = |contact: &ContactLine| self.row(contact, &rows);
        Ok(Snapshot {
            shapes,
            bodies,
            contacts: contacts.iter().filter_map(row).collect(),
            gaps: Gaps {
                classes: true,
                ..Gaps::default()
            },
            ..Snapshot::default()
        })
    }

    /// A contact as a row that starts from a body; `rows` has the row of each member.
    fn row(&self, contact: &ContactLine, rows: &[Option<u32>]) -> Option<ContactRow> {
        let b = rows[contact.b]?;
        let (body, partner, sign) = match contact.a {
            Side::Member(a) => (rows[a]?, Partner::Body(b), 1.0),
            Side::Wall(wall) => {
                let name = self.world.wall(wall as u32).map_or("wall", |w| w.name());
                (b, Partner::Wall(name.to_owned()), -1.0)
            }
        };
        Some(ContactRow {
            body,
            partner,
            point: Point3::from(contact.point),
            normal: contact.normal * sign,
            normal_force: contact.normal_force,
            friction: contact.friction * sign,
            moment: Vector3::zeros(),
            area: contact.area,
            volume: contact.volume,
            class: ContactClass::Point,
            patch: 0,
        })
    }
}

/// The skin of a deformable body as it is now.
fn present_shape(member: &Member, body: &Deformable) -> Result<NamedShape, Error> {
    let mesh = body.model().mesh();
    let positions = body.positions();
    let mut numbers = vec![None; mesh.points().len()];
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    for (tet, neighbours) in mesh.tets().iter().zip(mesh.neighbours()) {
        for (face, neighbour) in femdem_mesh::tet::FACES.iter().zip(neighbours) {
            if neighbour.is_some() {
                continue;
            }
            let corner = |i: usize| {
                let node = tet[i] as usize;
                *numbers[node].get_or_insert_with(|| {
                    vertices.push(Point3::from(positions[node]));
                    vertices.len() as u32 - 1
                })
            };
            faces.push(face.map(corner).to_vec());
        }
    }
    Ok(NamedShape {
        name: member.name.clone(),
        polyhedron: Polyhedron::new(vertices, faces)?,
    })
}
