//! Damping and friction of one pair, from the sums of its elastic contact.

use super::bristle::{Bristle, Touch};
use super::current::Operand;
use super::kernel::DeformableScratch;
use super::near::Near;
use super::record::{DeformableContact, DeformablePartner, DeformableTotals, NodalState};
use super::sums::{PairSums, TriangleLoad};
use crate::contact::{Load, Wrench};
use crate::general::cells::NONE;
use crate::law::ContactParameters;
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// How one side of a pair moves.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Mover<'a> {
    Nodes(NodalState<'a>),
    Rigid(&'a Motion),
}

/// A pair of bodies in contact.
pub(crate) struct Pair<'a> {
    pub ids: (DeformablePartner, u32),
    pub sides: [Operand<'a>; 2],
    pub movers: [Mover<'a>; 2],
    pub near: &'a Near,
    pub law: &'a ContactParameters,
    /// Whether the fields act in series (form Min).
    pub series: bool,
    /// Friction to begin with.
    pub begins: Option<FrictionStart>,
}

/// Friction that the springs of a pair begin with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct FrictionStart {
    /// On B, N.
    pub force: Vector3,
    /// On B about the normal, N m.
    pub torsion: f64,
}

/// What a contact does to a node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct NodeLoad {
    pub node: u32,
    /// N, and the parts of it by damping and by friction.
    pub force: Vector3,
    pub damping: Vector3,
    pub friction: Vector3,
    /// N/m, and 1/s.
    pub stiffness: f64,
    pub rate: f64,
}

/// What a pair gives, and its history.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Outcome {
    pub nodes: [Vec<NodeLoad>; 2],
    /// On a rigid body or wall.
    pub load: Option<Box<Load>>,
    pub contact: Option<DeformableContact>,
    pub totals: DeformableTotals,
    pub bristles: Vec<Bristle>,
}

/// The dashpot of a pair.
#[derive(Debug, Clone, Copy, Default)]
struct Dashpot {
    /// Elastic plus viscous force over elastic force.
    scale: f64,
    /// Its matrix is this times f f^T, with f the elastic force on all nodes and bodies.
    coefficient: f64,
    /// Rate of the nodes, 1/s.
    rate: f64,
    power: f64,
}

impl Outcome {
    /// Nothing touches: springs die.
    pub fn clear(&mut self) {
        self.nodes.iter_mut().for_each(Vec::clear);
        self.load = None;
        self.contact = None;
        self.totals = DeformableTotals::default();
        self.bristles.clear();
    }

    /// Takes over the sums in the scratch, which are used up.
    pub fn take(&mut self, pair: &Pair, scratch: &mut DeformableScratch) {
        for (side, members) in pair.near.sides.iter().enumerate() {
            scratch.sums.fold(side, &members.slaves);
        }
        let dashpot = pair.dashpot(scratch);
        let elastic = scratch.sums.wrench;
        scratch.sums.keep_elastic();
        for side in &mut scratch.sums.forces {
            side.iter_mut().for_each(|f| *f *= dashpot.scale);
        }
        let mut contact = pair.contact(scratch, dashpot.scale);
        let friction = self.rub(pair, scratch, &mut contact, dashpot.scale);
        for (side, members) in pair.near.sides.iter().enumerate() {
            scratch.sums.fold(side, &members.slaves);
        }
        self.totals = DeformableTotals {
            energy: contact.energy,
            spring_energy: contact.spring_energy,
            damping_power: dashpot.power,
            friction_power: friction.power,
            pairs: 0,
            touching: 1,
            candidates: 0,
            pieces: 0,
        };
        self.contact = Some(contact);
        // Both sides' motions count double, but not where the other side stays.
        let both = pair.moves_rigidly() || matches!(pair.sides[0], Operand::Deformable(..));
        let share = if both || pair.series { 1.0 } else { 0.5 };
        for side in 0..2 {
            self.list_nodes(pair, scratch, side, share, &dashpot);
        }
        self.load = pair.rigid_load(scratch, &elastic[0], &dashpot, &friction);
    }

    fn list_nodes(
        &mut self,
        pair: &Pair,
        scratch: &DeformableScratch,
        side: usize,
        share: f64,
        dashpot: &Dashpot,
    ) {
        let list = &mut self.nodes[side];
        list.clear();
        let Mover::Nodes(state) = &pair.movers[side] else {
            return;
        };
        let sums = &scratch.sums;
        for (at, &node) in pair.near.sides[side].nodes.iter().enumerate() {
            let Some(weight) = state.inverse_masses.get(node as usize) else {
                break;
            };
            let (force, stiffness) = (sums.forces[side][at], sums.stiffness[side][at]);
            let viscosity = sums.viscosity[side][at];
            if force == Vector3::zeros() && stiffness == 0.0 {
                continue;
            }
            let elastic = sums.elastic[side][at];
            list.push(NodeLoad {
                node,
                force,
                damping: elastic * (dashpot.scale - 1.0),
                friction: force - elastic * dashpot.scale,
                stiffness: stiffness * share,
                rate: dashpot.rate + 2.0 * share * viscosity * weight,
            });
        }
    }
}

/// Sums of the friction of a pair.
#[derive(Default)]
struct Rubbing {
    power: f64,
    /// On A, about the pair's origin.
    wrench: [Vector3; 2],
    marks: Vec<Mark>,
}

/// Friction of one triangle and where it acts.
struct Mark {
    /// The tetrahedra (places on the lists) that bear it, and the point's weights in them.
    places: [u32; 2],
    weights: [[f64; 4]; 2],
    point: Vector3,
    /// On B, N.
    force: Vector3,
    stiffness: f64,
    viscosity: f64,
}

impl Mark {
    fn add_to(&self, sums: &mut PairSums, side: usize, nodes: &[u32; 4]) {
        let force = if side == 1 { self.force } else { -self.force };
        for (&node, w) in nodes.iter().zip(self.weights[side]) {
            let at = node as usize;
            if let Some(total) = sums.forces[side].get_mut(at) {
                *total += force * w;
            }
            if let Some(total) = sums.stiffness[side].get_mut(at) {
                *total += self.stiffness * w.abs();
            }
            if let Some(total) = sums.viscosity[side].get_mut(at) {
                *total += self.viscosity * w.abs();
            }
        }
    }
}

impl Outcome {
    /// Friction of all triangles, added to the nodes.
    fn rub(
        &mut self,
        pair: &Pair,
        scratch: &mut DeformableScratch,
        contact: &mut DeformableContact,
        scale: f64,
    ) -> Rubbing {
        let mut rubbing = Rubbing::default();
        let old = std::mem::take(&mut self.bristles);
        if pair.law.friction <= 0.0 {
            return rubbing;
        }
        let loads = std::mem::take(&mut scratch.sums.loads);
        let bearing = Bearing::new(&loads);
        let touches: Vec<(u32, Touch)> = loads
            .iter()
            .filter(|load| bearing.holds(load))
            .filter_map(|load| {
                let touch = pair.touch(load, scratch, scale * bearing.share)?;
                Some((load.triangle, touch))
            })
            .collect();
        let mut bristles = match &pair.begins {
            Some(start) if old.is_empty() => pair.begin(start, &touches),
            _ => pair.inherit(&old, &touches),
        };
        let mut marks: Vec<Mark> = Vec::with_capacity(touches.len());
        let mut slides = !touches.is_empty();
        for ((_, touch), bristle) in touches.iter().zip(&mut bristles) {
            let size = touch.hosts[1].1.posed.size();
            let friction = bristle.update(pair.law, &pair.sides, touch, size);
            contact.friction += friction.force;
            contact.spring_energy += friction.energy;
            contact.tangential_stiffness += friction.stiffness;
            rubbing.power += friction.force.dot(&touch.slip);
            slides &= friction.slides;
            marks.push(Mark {
                places: touch.places,
                weights: touch.hosts.map(|h| h.1.weights(&touch.point)),
                point: touch.point,
                force: friction.force,
                stiffness: friction.stiffness,
                viscosity: friction.viscosity,
            });
        }
        contact.slides = slides;
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
        }
        rubbing.marks = marks;
        rubbing
    }
}

/// Triangles with less than this part of the mean stiffness for their force bear no friction.
const SOFT: f64 = 1e-6;

/// Which triangles bear friction, and how much more of it for those that do not. (Where the skin
/// bends away, the field may not change along the normal: there is pressure without stiffness.)
struct Bearing {
    /// Least stiffness over force, 1/m.
    least: f64,
    /// Force of all triangles over that of those which bear friction.
    share: f64,
}

impl Bearing {
    fn new(loads: &[TriangleLoad]) -> Self {
        let force: f64 = loads.iter().map(|l| l.force.norm()).sum();
        let stiffness: f64 = loads.iter().map(|l| l.stiffness).sum();
        let mut bearing = Self {
            least: SOFT * stiffness / force,
            share: 1.0,
        };
        let borne = loads.iter().filter(|l| bearing.holds(l));
        let borne: f64 = borne.map(|l| l.force.norm()).sum();
        if borne > 0.0 {
            bearing.share = force / borne;
        }
        bearing
    }

    fn holds(&self, load: &TriangleLoad) -> bool {
        let force = load.force.norm();
        force > 0.0 && load.pressure > 0.0 && load.stiffness > self.least * force
    }
}

impl<'a> Pair<'a> {
    fn moves_rigidly(&self) -> bool {
        matches!(self.movers[0], Mover::Rigid(motion) if motion.inverse_mass > 0.0)
    }

    /// The dashpot along the gradient of U, in the space of all nodes and bodies of the pair:
    /// f -> (1 + s) f, s = 2 zeta dU/dt / (sqrt(2 U) sqrt(sum |f_a|^2/m_a)).
    fn dashpot(&self, scratch: &DeformableScratch) -> Dashpot {
        let sums = &scratch.sums;
        let (mut response, mut of_nodes, mut power) = (0.0, 0.0, 0.0);
        for (side, mover) in self.movers.iter().enumerate() {
            match mover {
                Mover::Nodes(state) => {
                    for (&node, force) in self.near.sides[side].nodes.iter().zip(&sums.forces[side])
                    {
                        let (Some(v), Some(w)) = (
                            state.velocities.get(node as usize),
                            state.inverse_masses.get(node as usize),
                        ) else {
                            break;
                        };
                        of_nodes += force.norm_squared() * w;
                        power += force.dot(v);
                    }
                }
                Mover::Rigid(motion) => {
                    let [force, about] = sums.wrench[side];
                    let torque = about + (self.near.origin - motion.frame.position).cross(&force);
                    response += force.norm_squared() * motion.inverse_mass
                        + torque.dot(&(motion.inverse_inertia * torque));
                    power += force.dot(&motion.velocity) + torque.dot(&motion.angular_velocity);
                }
            }
        }
        let both = response > 0.0;
        response += of_nodes;
        let zeta = self.law.damping_ratio;
        let scale = (2.0 * sums.energy * response).sqrt();
        let usable = zeta > 0.0 && scale > 0.0 && scale.is_finite();
        if !usable {
            return Dashpot {
                scale: 1.0,
                ..Dashpot::default()
            };
        }
        let coefficient = 2.0 * zeta / scale;
        let factor = (1.0 - coefficient * power).max(0.0);
        Dashpot {
            scale: factor,
            coefficient,
            rate: coefficient * of_nodes * if both { 2.0 } else { 1.0 },
            power: (factor - 1.0) * power,
        }
    }

    /// The record of the elastic contact with damping.
    fn contact(&self, scratch: &DeformableScratch, scale: f64) -> DeformableContact {
        let sums = &scratch.sums;
        let force = sums.wrench[1][0];
        let elastic_force = force.norm();
        let normal = if elastic_force > 0.0 {
            force / elastic_force
        } else {
            Vector3::zeros()
        };
        let (mut pressure, mut moment, mut stiffness) = (0.0, Vector3::zeros(), 0.0);
        for load in &sums.loads {
            pressure += load.pressure;
            moment += load.moment;
            stiffness += load.stiffness;
        }
        let centre = if pressure > 0.0 {
            moment / pressure
        } else {
            moment
        };
        DeformableContact {
            a: self.ids.0,
            b: self.ids.1,
            point: self.near.origin + centre,
            normal,
            elastic_force,
            normal_force: elastic_force * scale,
            friction: Vector3::zeros(),
            slides: false,
            area: (0.5 * normal.dot(&sums.area)).max(0.0),
            volume: sums.volume,
            energy: sums.energy,
            spring_energy: 0.0,
            stiffness,
            tangential_stiffness: 0.0,
        }
    }

    /// What presses on a triangle.
    fn touch<'s>(
        &self,
        load: &TriangleLoad,
        scratch: &'s DeformableScratch,
        scale: f64,
    ) -> Option<Touch<'s>> {
        let force = load.force.norm();
        let host = |side: usize| {
            let place = load.hosts[side];
            let tet = *self.near.sides[side].tets.get(place as usize)?;
            Some((tet, scratch.tets[side].known(place)?))
        };
        let hosts = [host(0)?, host(1)?];
        let point = load.moment / load.pressure;
        let [(va, wa), (vb, wb)] = [0, 1].map(|side| self.motion_at(side, hosts[side], &point));
        Some(Touch {
            point,
            normal: load.force / force,
            force: force * scale,
            stiffness: self.law.tangential_ratio * load.stiffness,
            slip: vb - va,
            inverse_mass: wa + wb,
            hosts,
            places: load.hosts,
            origin: self.near.origin,
        })
    }

    /// Velocity and inverse mass of a point of one side.
    fn motion_at(
        &self,
        side: usize,
        (tet, current): (u32, &super::current::Current),
        point: &Vector3,
    ) -> (Vector3, f64) {
        match (&self.movers[side], &self.sides[side]) {
            (Mover::Rigid(motion), _) => {
                let arm = point + self.near.origin - motion.frame.position;
                (motion.velocity_at(&arm), motion.inverse_mass_at(&arm))
            }
            (Mover::Nodes(state), Operand::Deformable(shape, _)) => {
                let weights = current.weights(point);
                let (mut velocity, mut inverse_mass) = (Vector3::zeros(), 0.0);
                let nodes = shape
                    .tets()
                    .get(tet as usize)
                    .map_or([NONE; 4], |t| t.nodes);
                for (node, w) in nodes.into_iter().zip(weights) {
                    velocity += shape.place(node, state.velocities).unwrap_or_default() * w;
                    inverse_mass += shape.inverse_mass(node, state.inverse_masses) * w * w;
                }
                (velocity, inverse_mass)
            }
            _ => (Vector3::zeros(), 0.0),
        }
    }

    /// Springs that bear a given friction, in proportion to what presses on their triangles.
    fn begin(&self, start: &FrictionStart, touches: &[(u32, Touch)]) -> Vec<Bristle> {
        let pressing: f64 = touches.iter().map(|(_, t)| t.force).sum();
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

    /// The springs of the triangles in contact now, from those of the last step. A triangle newly
    /// in contact takes over the stretch of those beside it, as far as springs that have died
    /// leave the energy for it.
    fn inherit(&self, old: &[Bristle], touches: &[(u32, Touch)]) -> Vec<Bristle> {
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

    /// Mean stretch of the springs of the triangles beside one, weighted by their stiffness.
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

    /// The load on a rigid A about its own origin.
    fn rigid_load(
        &self,
        scratch: &DeformableScratch,
        elastic: &[Vector3; 2],
        dashpot: &Dashpot,
        rubbing: &Rubbing,
    ) -> Option<Box<Load>> {
        let Mover::Rigid(motion) = self.movers[0] else {
            return None;
        };
        let to = self.near.origin - motion.frame.position;
        let about = |[force, torque]: &[Vector3; 2]| Wrench {
            force: *force,
            torque: torque + to.cross(force),
        };
        let elastic = about(elastic);
        let damping = Wrench {
            force: elastic.force * (dashpot.scale - 1.0),
            torque: elastic.torque * (dashpot.scale - 1.0),
        };
        let mut load = Box::new(Load::default());
        load.add_wrenches(&elastic, &damping, &about(&rubbing.wrench));
        load.normal_sum = elastic.force.norm() * dashpot.scale;
        load.contacts = 1;
        if motion.inverse_mass > 0.0 {
            // (u_B - u_A)^2 <= 2 u_A^2 + 2 u_B^2: twice the stiffness for each side.
            for spring in &scratch.sums.springs {
                let lever = (spring.point + to).cross(&spring.normal);
                load.stiffness
                    .add_along(&spring.normal, &lever, 2.0 * spring.stiffness);
            }
            load.viscosity
                .add_along(&elastic.force, &elastic.torque, 2.0 * dashpot.coefficient);
            for mark in &rubbing.marks {
                let arm = mark.point + to;
                load.stiffness.add_everywhere(&arm, 2.0 * mark.stiffness);
                load.viscosity.add_everywhere(&arm, 2.0 * mark.viscosity);
            }
        }
        Some(load)
    }
}
