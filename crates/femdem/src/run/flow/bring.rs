//! Bodies of sources come, where there is room for them.

use femdem_mesh::{Point3, Pose, Vector3};
use femdem_solve::{BodySpec, Halo, ShapeId, World};

use super::state::{Flow, Supply};
use crate::Error;
use crate::gather::of_all;
use crate::run::Member;

/// Places that are tried in a step at most.
const TRIES: u32 = 16;

/// A ball around a body: its centroid and the distance of the farthest point \[m\].
type Ball = (Vector3, f64);

impl Flow {
    /// Adds the bodies of sources that are due and for which there is room, to a world that ranks may share. `members` is how many
    /// there are so far; the new ones are returned.
    pub(super) fn bring(
        &mut self,
        world: &mut World,
        members: usize,
        halo: &mut dyn Halo,
    ) -> Result<Vec<Member>, Error> {
        let time = world.time();
        let (mut new, mut balls) = (Vec::new(), Vec::new());
        for k in 0..self.supplies.len() {
            let due = self.supplies[k].due(time);
            let lacks = |supply: &Supply| (supply.come.bodies as u64) < due;
            if !lacks(&self.supplies[k]) {
                continue;
            }
            // What is there, found once a step.
            let others = self.supplies[k].in_the_way(world, halo)?;
            for _ in 0..TRIES {
                let supply = &mut self.supplies[k];
                if !lacks(supply) {
                    break;
                }
                let place = supply.next_place();
                let next = supply.next_kind();
                let radius = supply.kinds[next].radius;
                let x = place.translation.vector;
                let free = |ball: &Ball| !meets(world, ball, &x, radius);
                if others.iter().chain(&balls).all(free) && is_off_walls(world, &x, radius) {
                    let member = supply.next_body(next, &place, members + new.len(), world)?;
                    balls.push((x, radius));
                    self.note_member(&x, None);
                    new.push(member);
                }
            }
        }
        Ok(new)
    }
}

impl Supply {
    /// Balls around the bodies, those of all ranks, that may keep the next ones from coming: on one rank around all.
    fn in_the_way(&self, world: &World, halo: &mut dyn Halo) -> Result<Vec<Ball>, Error> {
        let balls = world.own_bodies(0).filter_map(|id| {
            let x = world.position(id)?;
            let radius = match world.deformable(id) {
                Some(body) => {
                    let far = body.positions().iter().map(|p| (p - x).norm());
                    far.fold(0.0, f64::max)
                }
                None => reach_of(world, world.shape_of(id)?),
            };
            Some((x, radius))
        });
        if halo.size() == 1 {
            return Ok(balls.collect());
        }
        let ahead = self.places_ahead(TRIES);
        let radii = self.kinds.iter().map(|kind| kind.radius);
        let largest = radii.fold(0.0, f64::max);
        let is_near = |ball: &Ball| ahead.iter().any(|x| meets(world, ball, x, largest));
        Ok(of_all(balls.filter(is_near).collect(), halo)?)
    }

    /// Adds its next body, of kind `next`, with its centroid and orientation at `place`, as member `number`.
    fn next_body(
        &mut self,
        next: usize,
        place: &Pose,
        number: usize,
        world: &mut World,
    ) -> Result<Member, Error> {
        let kind = &mut self.kinds[next];
        let polyhedron = &world.shapes()[kind.shape as usize].polyhedron;
        let centroid = polyhedron.mass_properties().centroid;
        let placed = place * Pose::from_parts((-centroid.coords).into(), Default::default());
        let id = world.add_body(BodySpec {
            shape: kind.shape,
            density: self.density,
            pose: placed,
            velocity: Vector3::from(self.velocity),
            angular_velocity: Vector3::zeros(),
            material: self.material,
        })?;
        kind.come += 1;
        self.come.add(1, kind.mass, world.time());
        Ok(Member {
            name: format!("{} {number}", self.name),
            id,
            placed,
            of: None,
        })
    }
}

/// Whether a ball overlaps one of a radius at a place \[m\], or the nearest image of it, axis by axis.
fn meets(world: &World, (at, reach): &Ball, x: &Vector3, radius: f64) -> bool {
    let way = x - at;
    let way = world.cell().map_or(way, |cell| cell.shortest(&way));
    way.norm() < radius + reach
}

/// Distance of the farthest point of a shape from its centroid \[m\].
pub(super) fn reach_of(world: &World, shape: ShapeId) -> f64 {
    let shape = &world.shapes()[shape as usize];
    let polyhedron = &shape.polyhedron;
    shape.sphere.unwrap_or_else(|| polyhedron.bounding_radius())
}

/// Whether a ball overlaps no wall.
fn is_off_walls(world: &World, x: &Vector3, radius: f64) -> bool {
    world.walls().all(|(wall, shape)| {
        let pose = world.wall_pose(wall).unwrap_or_default();
        let x = pose.inverse_transform_point(&Point3::from(*x));
        shape.clearance(&x.coords) >= radius
    })
}
