//! Overlaps that are too deep for a contact.

use std::collections::BTreeSet;

use femdem_contact::WallShape;
use femdem_mesh::{Point3, Vector3};

use super::Simulation;
use super::contacts::{ContactLine, Side};

/// Depth over the circumscribed diameter of the smaller body from which an overlap is deep: contacts of
/// bodies at rest are a few tenths of a percent deep.
const DEEP: f64 = 0.02;

/// Two bodies, or a body and a wall, that overlap deeply.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    /// Name of one side, a body or a wall.
    pub a: String,
    /// Name of the other, a body.
    pub b: String,
    /// Mean depth: overlap volume over contact area, at most the diameter of the smaller body \[m\].
    pub depth: f64,
    /// The depth over the circumscribed diameter of the smaller body.
    pub share: f64,
}

impl Simulation {
    /// Overlaps of more than 2 % of the circumscribed diameter of the smaller body, the deepest (by that
    /// measure) first. Bodies placed so burst apart, and bodies wholly in a wall, which do not touch its
    /// surface, fall through it. Contacts are known after the first step, also if that step has failed. Those within a pack
    /// from which the simulation started do not count.
    #[must_use]
    pub fn deep_overlaps(&self) -> Vec<Overlap> {
        let (mut deep, mut touching) = (Vec::new(), BTreeSet::new());
        let overlap = |a, b, depth: f64, size: f64| Overlap {
            a: self.name_of(a),
            b: self.name_of(Side::Member(b)),
            depth,
            share: depth / size,
        };
        for contact in self.contacts() {
            if let Side::Wall(wall) = contact.a {
                touching.insert((wall, contact.b));
            }
            if self.are_of_pack(contact.a, contact.b) {
                continue;
            }
            let size = self.smaller_diameter(contact.a, contact.b);
            let (depth, a) = (self.depth_of(&contact), contact.a);
            if depth >= DEEP * size {
                deep.push(overlap(a, contact.b, depth, size));
            }
        }
        for (wall, shape) in self.world.walls() {
            let wall = wall as usize;
            for member in 0..self.members.len() {
                let of_pack = self.are_of_pack(Side::Wall(wall), member);
                if !of_pack
                    && !touching.contains(&(wall, member))
                    && self.is_beyond(wall, shape, member)
                {
                    let size = self.smaller_diameter(Side::Wall(wall), member);
                    deep.push(overlap(Side::Wall(wall), member, size, size));
                }
            }
        }
        deep.sort_by(|x, y| y.share.total_cmp(&x.share));
        // Bodies that are not convex have several patches; the deepest represents the pair.
        let mut seen = BTreeSet::new();
        deep.retain(|pair| seen.insert((pair.a.clone(), pair.b.clone())));
        deep
    }

    /// Whether both sides come from the pack from which the simulation started.
    fn are_of_pack(&self, a: Side, b: usize) -> bool {
        let origin = &self.origin;
        let is_of_pack = match a {
            Side::Member(member) => member < origin.bodies,
            Side::Wall(wall) => origin.container.contains(&(wall as u32)),
        };
        is_of_pack && b < origin.bodies
    }

    /// Depth of a contact \[m\]: its [`ContactLine::penetration`], and at most the circumscribed diameter of
    /// the smaller body, because a body wholly in another or in a wall has hardly any contact area.
    #[must_use]
    pub fn depth_of(&self, contact: &ContactLine) -> f64 {
        if contact.volume > 0.0 {
            let most = self.smaller_diameter(contact.a, contact.b);
            // What is not flat is as deep as it is wide: a part of a broken body may lie in a wall with no skin there.
            let area = contact.area.max(contact.volume.cbrt().powi(2));
            (contact.volume / area).min(most)
        } else {
            0.0
        }
    }

    /// Name of a side of a contact: of the body, or of the wall.
    #[must_use]
    pub fn name_of(&self, side: Side) -> String {
        let name = match side {
            Side::Member(member) => self.members.get(member).map(|member| &*member.name),
            Side::Wall(wall) => self.world.wall(wall as u32).map(|wall| wall.name()),
        };
        name.unwrap_or_default().to_owned()
    }

    /// Whether the centroid of a member lies in a wall of planes.
    pub(super) fn is_beyond(&self, wall: usize, shape: &WallShape, member: usize) -> bool {
        let centroid = self.world.position(self.members[member].id);
        let (WallShape::Planes(planes), Some(centroid), Some(pose)) =
            (shape, centroid, self.world.wall_pose(wall as u32))
        else {
            return false;
        };
        let x = pose.inverse_transform_point(&Point3::from(centroid)).coords;
        let mut planes = planes.planes().iter();
        planes.any(|plane| plane.normal.dot(&x) < plane.offset)
    }

    /// Circumscribed diameter of the smaller of two sides \[m\].
    fn smaller_diameter(&self, a: Side, b: usize) -> f64 {
        let a = match a {
            Side::Member(member) => self.diameter(member),
            Side::Wall(_) => None,
        };
        let sizes = [a, self.diameter(b)].into_iter().flatten();
        sizes.fold(f64::INFINITY, f64::min)
    }

    /// Circumscribed diameter of a member, as it was made \[m\].
    pub(super) fn diameter(&self, member: usize) -> Option<f64> {
        let id = self.members.get(member)?.id;
        let radius = if let Some(body) = self.world.deformable(id) {
            let nodes = body.model().nodes();
            let centre = nodes.iter().sum::<Vector3>() / nodes.len() as f64;
            let far = nodes.iter().map(|x| (x - centre).norm());
            far.fold(0.0, f64::max)
        } else {
            let shape = self.world.shape(self.world.shape_of(id)?)?;
            shape.polyhedron.bounding_radius()
        };
        Some(2.0 * radius)
    }
}
