//! Friction of one pair: the springs of all its triangles.

use super::bristle::{Bristle, Mobility, Touch};
use super::operand::Operand;
use super::outcome::{Dashpot, Outcome};
use super::pair::{Mover, Pair};
use super::patches::Patches;
use super::scratch::DeformableScratch;
use super::sums::{PairSums, TriangleLoad};
use crate::spring_load::SpringLoad;
use femdem_mesh::Vector3;

/// Sums of the friction of a pair.
#[derive(Default)]
pub(crate) struct Rubbing {
    pub power: f64,
    /// Force on A, and torque about the pair's origin; the part of it due to dashpots.
    pub wrench: [Vector3; 2],
    pub drag: [Vector3; 2],
    pub marks: Vec<Mark>,
}

/// Friction of one triangle and where it acts.
pub(crate) struct Mark {
    /// The tetrahedra (indices in the lists) on which it acts, and the point's weights in them.
    places: [u32; 2],
    weights: [[f64; 4]; 2],
    pub point: Vector3,
    /// On B, N, and the part due to the dashpot.
    force: Vector3,
    drag: Vector3,
    pub stiffness: f64,
    /// Rates of the corners, 1/s.
    rates: [[f64; 4]; 2],
    /// Effective viscosity for a rigid A, N s/m.
    pub viscosity: f64,
}

impl Mark {
    fn add_to(&self, sums: &mut PairSums, side: usize, nodes: &[u32; 4]) {
        let force = if side == 1 { self.force } else { -self.force };
        for ((&node, w), rate) in nodes.iter().zip(self.weights[side]).zip(self.rates[side]) {
            let at = node as usize;
            if let Some(total) = sums.forces[side].get_mut(at) {
                *total += force * w;
            }
            if let Some(total) = sums.stiffness[side].get_mut(at) {
                *total += self.stiffness * w.abs();
            }
            if let Some(total) = sums.rates[side].get_mut(at) {
                *total += rate;
            }
        }
    }
}

impl Outcome {
    /// Friction of all triangles, added to the nodal forces and to the contacts of their patches.
    pub fn rub(
        &mut self,
        pair: &Pair,
        scratch: &mut DeformableScratch,
        patches: &Patches,
        dashpots: &[Dashpot],
    ) -> Rubbing {
        let mut rubbing = Rubbing::default();
        let old = std::mem::take(&mut self.bristles);
        if pair.law.friction <= 0.0 {
            return rubbing;
        }
        let loads = std::mem::take(&mut scratch.sums.loads);
        let of_patch = |number: usize| {
            let numbered = loads.iter().enumerate();
            let own = numbered.filter(move |(i, _)| patches.of_load(*i) == number);
            own.map(|(_, load)| load)
        };
        let bearings: Vec<Bearing> = (0..dashpots.len())
            .map(|number| Bearing::new(of_patch(number)))
            .collect();
        let mut touches: Vec<(u32, Touch)> = Vec::with_capacity(loads.len());
        let mut numbers = Vec::with_capacity(loads.len());
        let mut stiffness = vec![0.0; dashpots.len()];
        for (i, load) in loads.iter().enumerate() {
            let number = patches.of_load(i);
            let bearing = &bearings[number];
            if !bearing.holds(load) {
                continue;
            }
            let scale = dashpots[number].total * bearing.share;
            if let Some(touch) = pair.touch(load, scratch, scale) {
                stiffness[number] += touch.stiffness;
                touches.push((load.triangle, touch));
                numbers.push(number);
                self.contacts[number].slides = true;
            }
        }
        for ((_, touch), &number) in touches.iter_mut().zip(&numbers) {
            touch.period = 1.0 / (stiffness[number] * dashpots[number].inverse_mass).sqrt();
        }
        let mut bristles = match &pair.begins {
            Some(start) if old.is_empty() => pair.begin(start, &touches),
            _ => pair.inherit(old, &touches),
        };
        let mut marks: Vec<Mark> = Vec::with_capacity(touches.len());
        for (((_, touch), bristle), &number) in touches.iter().zip(&mut bristles).zip(&numbers) {
            let friction = bristle.update(pair.law, &pair.sides, touch);
            let contact = &mut self.contacts[number];
            contact.friction += friction.force;
            contact.spring_energy += friction.energy;
            contact.tangential_stiffness += friction.stiffness;
            contact.slides &= friction.slides;
            rubbing.power += friction.force.dot(&touch.slip);
            let held = friction.force - friction.drag;
            let arm = touch.point - (contact.point - pair.near.origin);
            self.springs[number].force += held;
            self.springs[number].torsion += contact.normal.dot(&arm.cross(&held));
            let (rates, viscosity) = touch.rates(friction.viscosity);
            marks.push(Mark {
                places: touch.places,
                weights: touch.weights,
                point: touch.point,
                force: friction.force,
                drag: friction.drag,
                stiffness: friction.stiffness,
                rates,
                viscosity,
            });
        }
        self.bristles = bristles;
        scratch.sums.loads = loads;
        for mark in &marks {
            for (side, members) in pair.near.sides.iter().enumerate() {
                if let Some(nodes) = members.corners.get(mark.places[side] as usize) {
                    mark.add_to(&mut scratch.sums, side, nodes);
                }
            }
            rubbing.wrench[0] -= mark.force;
            rubbing.wrench[1] -= mark.point.cross(&mark.force);
            rubbing.drag[0] -= mark.drag;
            rubbing.drag[1] -= mark.point.cross(&mark.drag);
        }
        rubbing.marks = marks;
        rubbing
    }
}

/// A point with a lower weight at a corner of a tetrahedron is far outside of it.
const FAR: f64 = -0.25;

/// Triangles whose stiffness over force is below this fraction of the mean carry no friction.
const SOFT: f64 = 1e-6;

/// Which triangles carry friction, and by how much it is scaled up to replace the others. (Where the skin
/// bends away, the field may be constant along the normal: there is pressure without stiffness.)
struct Bearing {
    /// Least stiffness over force, 1/m.
    least: f64,
    /// Force of all triangles over that of those that carry friction.
    share: f64,
}

impl Bearing {
    fn new<'a>(loads: impl Iterator<Item = &'a TriangleLoad> + Clone) -> Self {
        let force: f64 = loads.clone().map(|l| l.force.norm()).sum();
        let stiffness: f64 = loads.clone().map(|l| l.stiffness.total).sum();
        let mut bearing = Self {
            least: SOFT * stiffness / force,
            share: 1.0,
        };
        let borne = loads.filter(|l| bearing.holds(l));
        let borne: f64 = borne.map(|l| l.force.norm()).sum();
        if borne > 0.0 {
            bearing.share = force / borne;
        }
        bearing
    }

    fn holds(&self, load: &TriangleLoad) -> bool {
        let force = load.force.norm();
        force > 0.0 && load.pressure > 0.0 && load.stiffness.total > self.least * force
    }
}

impl Pair<'_> {
    /// Normal load and motion of a triangle.
    fn touch<'s>(
        &self,
        load: &TriangleLoad,
        scratch: &'s DeformableScratch,
        scale: f64,
    ) -> Option<Touch<'s>> {
        let force = load.force.norm();
        let point = load.moment / load.pressure;
        let places = [0, 1].map(|side| self.host(side, load.hosts[side], &point, scratch));
        let host = |side: usize| {
            let tet = *self.near.sides[side].tets.get(places[side] as usize)?;
            Some((tet, scratch.tets[side].known(places[side])?))
        };
        let hosts = [host(0)?, host(1)?];
        let weights = hosts.map(|(_, current)| current.weights(&point));
        let (va, of_a) = self.motion_at(0, hosts[0].0, &weights[0], &point)?;
        let (vb, of_b) = self.motion_at(1, hosts[1].0, &weights[1], &point)?;
        Some(Touch {
            point,
            normal: load.force / force,
            force: force * scale,
            stiffness: self.law.tangential_ratio * load.stiffness.total,
            slip: vb - va,
            mobilities: [of_a, of_b],
            period: f64::INFINITY,
            hosts,
            places,
            weights,
            origin: self.near.origin,
        })
    }

    /// The tetrahedron (place on the list) to hold a point of a side: `usual`, unless the point lies far outside. A
    /// triangle of B may reach over many tetrahedra of A, and the one that bears the largest part need not be near the
    /// centre of pressure.
    fn host(&self, side: usize, usual: u32, point: &Vector3, scratch: &DeformableScratch) -> u32 {
        let lowest = |place: u32| {
            let tet = scratch.tets[side].known(place)?;
            let weights = tet.weights(point).into_iter();
            Some(weights.fold(f64::INFINITY, f64::min))
        };
        let held = lowest(usual);
        if held.is_some_and(|weight| weight >= FAR) {
            return usual;
        }
        let mut best = (usual, held);
        for place in 0..self.near.sides[side].tets.len() as u32 {
            let weight = lowest(place);
            // `None` is less than any weight.
            if weight > best.1 {
                best = (place, weight);
            }
        }
        best.0
    }

    /// Velocity of a point of one side, and its mobility; `None` for a tetrahedron that is not there.
    fn motion_at(
        &self,
        side: usize,
        tet: u32,
        weights: &[f64; 4],
        point: &Vector3,
    ) -> Option<(Vector3, Mobility)> {
        let mut mobility = Mobility::default();
        let mut velocity = Vector3::zeros();
        match (&self.movers[side], &self.sides[side]) {
            (Mover::Rigid(motion), _) => {
                let arm = point + self.near.origin - motion.frame.position;
                velocity = motion.velocity_at(&arm);
                mobility.inverse_mass = motion.inverse_mass_at(&arm);
            }
            (Mover::Nodes(state), Operand::Deformable(shape, _)) => {
                let nodes = shape.tets().get(tet as usize)?.nodes;
                for ((node, w), corner) in nodes.into_iter().zip(weights).zip(&mut mobility.corners)
                {
                    velocity += shape.place(node, state.velocities)? * *w;
                    *corner = shape.inverse_mass(node, state.inverse_masses) * w * w;
                    mobility.inverse_mass += *corner;
                }
            }
            _ => {}
        }
        Some((velocity, mobility))
    }

    /// Springs that carry a given friction, in proportion to the normal loads of their triangles; none where the dashpots leave none.
    fn begin(&self, start: &SpringLoad, touches: &[(u32, Touch)]) -> Vec<Bristle> {
        let pressing: f64 = touches.iter().map(|(_, t)| t.force).sum();
        if pressing <= 0.0 {
            return self.inherit(Vec::new(), touches);
        }
        let centre: Vector3 = touches.iter().map(|(_, t)| t.point * t.force).sum();
        let centre = centre / pressing;
        let normal: Vector3 = touches.iter().map(|(_, t)| t.normal * t.force).sum();
        let arm = |t: &Touch| normal.cross(&(t.point - centre)) / pressing;
        let second: f64 = touches
            .iter()
            .map(|(_, t)| t.force * arm(t).norm_squared())
            .sum();
        let turn = if second > 0.0 {
            start.torsion / second
        } else {
            0.0
        };
        touches
            .iter()
            .map(|(triangle, touch)| {
                let force = (start.force / pressing + arm(touch) * turn) * touch.force;
                let stretch = -force / touch.stiffness;
                Bristle::new(&self.sides, *triangle, touch, &stretch)
            })
            .collect()
    }

    /// The springs of the triangles in contact now, from those of the last step. A triangle newly in contact
    /// takes over the stretch of its neighbours, as far as the energy of vanished springs allows.
    fn inherit(&self, old: Vec<Bristle>, touches: &[(u32, Touch)]) -> Vec<Bristle> {
        let kept = old.iter().zip(touches).all(|(b, t)| b.triangle == t.0);
        if kept && old.len() == touches.len() {
            return old;
        }
        let origin = &self.near.origin;
        let known = |t: u32| {
            old.binary_search_by_key(&t, |b| b.triangle)
                .ok()
                .map(|i| &old[i])
        };
        let mut born = 0.0;
        let mut list = Vec::with_capacity(touches.len());
        for (triangle, touch) in touches {
            list.push(known(*triangle).copied().unwrap_or_else(|| {
                let stretch = self.stretch_beside(*triangle, known);
                let bristle = Bristle::new(&self.sides, *triangle, touch, &stretch);
                let stretch = bristle.stretch(&self.sides, origin);
                born += 0.5 * touch.stiffness * stretch.norm_squared();
                bristle
            }));
        }
        if born > 0.0 {
            let is_gone =
                |b: &&Bristle| touches.binary_search_by_key(&b.triangle, |t| t.0).is_err();
            let died: f64 = old
                .iter()
                .filter(is_gone)
                .map(|b| b.energy(&self.sides, origin))
                .sum();
            if died < born {
                let scale = (died / born).sqrt();
                for (bristle, (_, touch)) in list.iter_mut().zip(touches) {
                    if known(bristle.triangle).is_none() {
                        let stretch = bristle.stretch(&self.sides, origin) * scale;
                        *bristle = Bristle::new(&self.sides, bristle.triangle, touch, &stretch);
                    }
                }
            }
        }
        list
    }

    /// Mean stretch of the springs of a triangle's neighbours, weighted by their stiffness.
    fn stretch_beside<'b>(
        &self,
        triangle: u32,
        known: impl Fn(u32) -> Option<&'b Bristle>,
    ) -> Vector3 {
        let Operand::Deformable(shape, _) = self.sides[1] else {
            return Vector3::zeros();
        };
        let (mut sum, mut total) = (Vector3::zeros(), 0.0);
        for bristle in shape.beside(triangle).into_iter().filter_map(known) {
            sum += bristle.stretch(&self.sides, &self.near.origin) * bristle.stiffness;
            total += bristle.stiffness;
        }
        if total > 0.0 { sum / total } else { sum }
    }
}
