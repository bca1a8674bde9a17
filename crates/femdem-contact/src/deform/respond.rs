//! Damping and friction of one pair, from the sums of its elastic contact.

use super::body_dashpot::BodyDashpot;
use super::operand::Operand;
use super::outcome::{Dashpot, NodeLoad, Outcome};
use super::pair::{Mover, Pair};
use super::patches::{Patch, Patches};
use super::record::{DeformableTotals, NodalState};
use super::rub::Rubbing;
use super::scratch::DeformableScratch;
use crate::adhesion::Adhesion;
use crate::contact::Partner;
use crate::contact::{Load, Wrench, rolling_radius};
use crate::foundation::Foundation;
use crate::generalized::Resistance;
use crate::motion::Motion;
use crate::record::Contact;
use crate::rocking::{Rocker, Rocking, RockingState, Turn};
use crate::rolling::{Roller, Rolling, RollingState};
use crate::spring_load::SpringLoad;
use femdem_mesh::Vector3;

/// How easily a patch gives way, and how it moves.
#[derive(Debug, Clone, Copy, Default)]
struct Response {
    /// Σ |f_a|²/m_a over the nodes, and the same of rigid bodies, N²/kg.
    of_nodes: f64,
    of_bodies: f64,
    /// Of the elastic forces, W.
    power: f64,
    /// The largest contact stiffness over mass of a node, 1/s².
    fastest: f64,
}

impl Response {
    /// `force` is the elastic one on B, N, and `stiffness` that of the patch, N/m.
    ///
    /// The contact swings at ω² = Σ|f|²/m / 2U, and no faster than its nodes and bodies on their springs, ω² ≤ 2 max k_a/m_a + K/M.
    /// That bounds it where patches share nodes, as in rubble, so that little of the energy is that of one and much of the force.
    fn dashpot(&self, energy: f64, force: &Vector3, stiffness: f64, zeta: f64) -> Dashpot {
        let response = self.of_bodies + self.of_nodes;
        let scale = (2.0 * energy * response).sqrt();
        let inverse_mass = response / force.norm_squared();
        let usable = zeta > 0.0 && scale > 0.0 && scale.is_finite();
        if !usable {
            return Dashpot {
                scale: 1.0,
                total: 1.0,
                inverse_mass,
                ..Dashpot::default()
            };
        }
        let fastest = 2.0 * self.fastest + stiffness * self.of_bodies / force.norm_squared();
        let (usual, most) = (1.0 / scale, fastest.sqrt() / response);
        let coefficient = 2.0 * zeta * if most < usual { most } else { usual };
        let factor = (1.0 - coefficient * self.power).max(0.0);
        let both = if self.of_bodies > 0.0 { 2.0 } else { 1.0 };
        Dashpot {
            scale: factor,
            total: factor,
            inverse_mass,
            coefficient,
            rate: coefficient * self.of_nodes * both,
            power: (factor - 1.0) * self.power,
        }
    }
}

impl Outcome {
    /// Nothing touches: the springs are dropped.
    pub fn clear(&mut self) {
        self.nodes.iter_mut().for_each(Vec::clear);
        self.whole = Default::default();
        self.whole_rates = [0.0; 2];
        self.load = None;
        self.contacts.clear();
        self.totals = DeformableTotals::default();
        self.bristles.clear();
        self.rocking.clear();
        self.rolling.clear();
        self.springs.clear();
    }

    /// Makes side A side B. The springs stay those of the side that they belong to.
    pub fn swap_sides(&mut self) {
        self.nodes.swap(0, 1);
        self.whole.swap(0, 1);
        self.whole_rates.swap(0, 1);
        // Not the negative: what is 0 stays without a sign.
        let opposite = |v: &mut Vector3| *v = Vector3::zeros() - *v;
        for contact in &mut self.contacts {
            opposite(&mut contact.normal);
            opposite(&mut contact.rocking);
            opposite(&mut contact.rolling);
            opposite(&mut contact.friction);
        }
        for springs in &mut self.springs {
            opposite(&mut springs.force);
            opposite(&mut springs.rolling);
        }
    }

    /// Takes over the sums from the scratch, which are consumed. The sides are those of `pair`.
    pub fn take(&mut self, pair: &Pair, scratch: &mut DeformableScratch) {
        let patches = Patches::new(&pair.sides, pair.near, &scratch.sums);
        let (dashpots, of_bodies) = pair.dashpots(scratch, &patches);
        scratch.sums.keep_elastic();
        for (side, forces) in scratch.sums.forces.iter_mut().enumerate() {
            for (at, force) in forces.iter_mut().enumerate() {
                *force *= dashpots[patches.of_node(side, at)].scale;
            }
        }
        self.contacts.clear();
        self.whole = Default::default();
        self.whole_rates = [0.0; 2];
        let (mut damping_power, mut rolling_power) = (0.0, 0.0);
        let mut rockings = Vec::with_capacity(patches.list.len());
        let mut rollings = Vec::with_capacity(patches.list.len());
        // Where the number of patches changes they are others.
        if self.rocking.len() != patches.list.len() {
            self.rocking = vec![RockingState::default(); patches.list.len()];
            self.rolling = vec![RollingState::default(); patches.list.len()];
        }
        if let Some(start) = pair.begins.filter(|_| self.bristles.is_empty()) {
            let pressed = |patch: &Patch| patch.wrench[1][0].norm();
            let all: f64 = patches.list.iter().map(pressed).sum();
            let part =
                |patch: &Patch| start.rolling * (pressed(patch) / all.max(f64::MIN_POSITIVE));
            let each = patches.list.iter().map(part);
            self.rolling = each.map(RollingState::carrying).collect();
        }
        self.springs.clear();
        let turn = pair.turn();
        for (number, (patch, dashpot)) in patches.list.iter().zip(&dashpots).enumerate() {
            let mut contact = pair.contact(scratch, &patches, number, dashpot.total);
            damping_power += dashpot.power;
            let mut rocking = (Rocking::default(), [0.0; 2]);
            let mut rolling = Rolling::default();
            if let Some(turn) = &turn {
                rocking = pair.rocking(patch, &contact, turn, &mut self.rocking[number]);
                let moment = rocking.0.moment;
                contact.rocking = moment;
                self.whole[0][1] -= moment;
                self.whole[1][1] += moment;
                for (rate, more) in self.whole_rates.iter_mut().zip(rocking.1) {
                    *rate += more;
                }
                damping_power += moment.dot(&(turn.rates[1] - turn.rates[0]));
                let stiffness = patch.stiffness.total;
                rolling = pair.rolling(&contact, stiffness, turn, &mut self.rolling[number]);
                contact.rolling = rolling.moment;
                contact.spring_energy = rolling.energy;
                self.whole[0][1] -= rolling.moment;
                self.whole[1][1] += rolling.moment;
                for (rate, mobility) in self.whole_rates.iter_mut().zip(&turn.mobilities) {
                    *rate += 2.0 * rolling.viscosity * mobility.trace();
                }
                rolling_power += rolling.moment.dot(&(turn.rates[1] - turn.rates[0]));
            }
            self.springs.push(SpringLoad {
                rolling: rolling.moment - rolling.drag,
                ..SpringLoad::default()
            });
            rollings.push(rolling);
            self.contacts.push(contact);
            rockings.push(rocking.0);
        }
        for dashpot in &of_bodies {
            damping_power += dashpot.power;
            for side in 0..2 {
                self.whole[side][0] += dashpot.wrench[side][0];
                self.whole[side][1] += dashpot.wrench[side][1];
                self.whole_rates[side] += dashpot.rates[side];
            }
        }
        let friction = self.rub(pair, scratch, &patches, &dashpots);
        for (side, members) in pair.near.sides.iter().enumerate() {
            scratch.sums.fold(side, &members.slaves);
        }
        self.totals = DeformableTotals {
            energy: scratch.sums.energy,
            spring_energy: self.contacts.iter().map(|c| c.spring_energy).sum(),
            damping_power,
            friction_power: friction.power + rolling_power,
            pairs: 0,
            touching: 1,
            candidates: 0,
            pieces: 0,
        };
        // The stiffness counts double if both sides can move, as both motions stretch it; only once if the
        // other side is fixed.
        let both = pair.moves_rigidly() || matches!(pair.sides[0], Operand::Deformable(..));
        let share = if both { 1.0 } else { 0.5 };
        for side in 0..2 {
            self.list_nodes(pair, scratch, side, share, (&patches, &dashpots));
        }
        self.load = pair.rigid_load(
            scratch,
            &patches,
            (&dashpots, &rockings, &rollings),
            &friction,
        );
    }

    fn list_nodes(
        &mut self,
        pair: &Pair,
        scratch: &DeformableScratch,
        side: usize,
        share: f64,
        (patches, dashpots): (&Patches, &[Dashpot]),
    ) {
        let list = &mut self.nodes[side];
        list.clear();
        let Mover::Nodes(_) = &pair.movers[side] else {
            return;
        };
        let sums = &scratch.sums;
        for (at, &node) in pair.near.sides[side].nodes.iter().enumerate() {
            let (force, stiffness) = (sums.forces[side][at], sums.stiffness[side][at]);
            if force == Vector3::zeros() && stiffness == 0.0 {
                continue;
            }
            let elastic = sums.elastic[side][at];
            let dashpot = &dashpots[patches.of_node(side, at)];
            list.push(NodeLoad {
                node,
                force,
                damping: elastic * (dashpot.scale - 1.0),
                friction: force - elastic * dashpot.scale,
                stiffness: stiffness * share,
                rate: dashpot.rate + sums.rates[side][at],
            });
        }
    }
}

impl<'a> Pair<'a> {
    fn moves_rigidly(&self) -> bool {
        matches!(self.movers[0], Mover::Rigid(motion) if motion.inverse_mass > 0.0)
    }

    /// The dashpots of the patches: along the gradient of U, in the space of all nodes and bodies of the pair,
    /// f -> (1 + s) f, s = 2 zeta dU/dt / (sqrt(2 U) sqrt(sum |f_a|^2/m_a)).
    fn dashpots(
        &self,
        scratch: &DeformableScratch,
        patches: &Patches,
    ) -> (Vec<Dashpot>, Vec<BodyDashpot>) {
        let mut motions = vec![Response::default(); patches.list.len()];
        for (side, mover) in self.movers.iter().enumerate() {
            match mover {
                Mover::Nodes(state) => self.respond(side, state, scratch, patches, &mut motions),
                Mover::Rigid(motion) => {
                    for (patch, of_patch) in patches.list.iter().zip(&mut motions) {
                        let (response, power) = self.rigid_response(motion, &patch.wrench[side]);
                        of_patch.of_bodies += response;
                        of_patch.power += power;
                    }
                }
            }
        }
        let all = self.all_patches(&patches.list, scratch.sums.energy);
        let each = patches.list.iter().zip(&motions);
        each.map(|(patch, motion)| {
            let energy = scratch.sums.energy * patch.share;
            let (force, zeta) = (&patch.wrench[1][0], self.law.damping_ratio);
            let mut dashpot = motion.dashpot(energy, force, patch.stiffness.total, zeta);
            let rate = dashpot.coefficient * patch.wrench[1][0].norm();
            let of_bodies = self.body_dashpot(patch, &all, rate, dashpot.scale);
            dashpot.total += of_bodies.scale;
            dashpot.coefficient += of_bodies.coefficient;
            (dashpot, of_bodies)
        })
        .unzip()
    }

    /// The dashpot of a patch against rocking, and its rates on A and B for the step, 1/s.
    fn rocking(
        &self,
        patch: &Patch,
        contact: &Contact,
        turn: &Turn,
        state: &mut RockingState,
    ) -> (Rocking, [f64; 2]) {
        let normal = &contact.normal;
        let point = contact.point - self.near.origin;
        let foundation = Foundation::new(&patch.stiffness, normal, &point);
        let [force, torque] = patch.wrench[1];
        let rocker = Rocker {
            foundation: &foundation,
            normal,
            force,
            moment: torque - point.cross(&force),
            scale: contact.normal_force / contact.elastic_force.max(f64::MIN_POSITIVE),
            zeta: self.law.damping_ratio,
        };
        let rocking = state.update(&rocker, turn, self.dt);
        let [of_a, of_b] = turn.mobilities.map(|mobility| {
            let about = |(axis, c): (&Vector3, f64)| c * axis.dot(&(mobility * axis));
            let rates = rocking.axes.iter().zip(rocking.viscosity).map(about);
            rates.fold(0.0, f64::max)
        });
        // (ω_B - ω_A)^2 <= 2 ω_A^2 + 2 ω_B^2, if both can rotate.
        let both = if of_a > 0.0 && of_b > 0.0 { 2.0 } else { 1.0 };
        (rocking, [both * of_a, both * of_b])
    }

    /// Rolling friction of a patch of the given normal stiffness, N/m.
    fn rolling(
        &self,
        contact: &Contact,
        stiffness: f64,
        turn: &Turn,
        state: &mut RollingState,
    ) -> Rolling {
        if self.law.rolling_friction <= 0.0 {
            return Rolling::default();
        }
        let distance = |side: usize| {
            if side == 0 && matches!(self.ids.0, Partner::Wall(_)) {
                return f64::INFINITY;
            }
            let centre = match (&self.movers[side], self.turnings[side]) {
                (Mover::Rigid(motion), _) => motion.frame.position,
                (Mover::Nodes(..), Some(turning)) => *turning.centre(),
                // There is no `turn` without it.
                (Mover::Nodes(..), None) => contact.point,
            };
            contact.normal.dot(&(contact.point - centre)).abs()
        };
        let radius = rolling_radius(distance(0), distance(1));
        let roller = Roller {
            normal: contact.normal,
            most: self.law.rolling_friction * contact.normal_force * radius,
            stiffness: self.law.tangential_ratio * stiffness * radius * radius,
            zeta: self.law.tangential_damping,
        };
        state.update(&roller, turn, self.dt, true)
    }

    /// |f|²/M + t I⁻¹ t, N²/kg, and power, W, of a wrench about the pair's origin on a rigid body.
    pub fn rigid_response(&self, motion: &Motion, [force, about]: &[Vector3; 2]) -> (f64, f64) {
        let torque = about + (self.near.origin - motion.frame.position).cross(force);
        (
            force.norm_squared() * motion.inverse_mass
                + torque.dot(&(motion.inverse_inertia * torque)),
            force.dot(&motion.velocity) + torque.dot(&motion.angular_velocity),
        )
    }

    /// Adds what the nodes of a side contribute to the patches.
    fn respond(
        &self,
        side: usize,
        state: &NodalState,
        scratch: &DeformableScratch,
        patches: &Patches,
        motions: &mut [Response],
    ) {
        let nodes = self.near.sides[side].nodes.iter();
        for (at, (&node, force)) in nodes.zip(&scratch.sums.forces[side]).enumerate() {
            let (Some(v), Some(w)) = (
                state.velocities.get(node as usize),
                state.inverse_masses.get(node as usize),
            ) else {
                break;
            };
            let of_patch = &mut motions[patches.of_node(side, at)];
            of_patch.of_nodes += force.norm_squared() * w;
            of_patch.power += force.dot(v);
            let rate = scratch.sums.stiffness[side][at] * w;
            of_patch.fastest = if rate > of_patch.fastest {
                rate
            } else {
                of_patch.fastest
            };
        }
    }

    /// The record of the elastic contact with damping.
    fn contact(
        &self,
        scratch: &DeformableScratch,
        patches: &Patches,
        number: usize,
        scale: f64,
    ) -> Contact {
        let (sums, patch) = (&scratch.sums, &patches.list[number]);
        let force = patch.wrench[1][0];
        let elastic_force = force.norm();
        let normal = if elastic_force > 0.0 {
            force / elastic_force
        } else {
            Vector3::zeros()
        };
        let (mut pressure, mut moment, mut stiffness) = (0.0, Vector3::zeros(), 0.0);
        let (mut pressing, mut area) = (0.0, 0.0);
        for (i, load) in sums.loads.iter().enumerate() {
            if patches.of_load(i) == number {
                pressure += load.pressure;
                moment += load.moment;
                stiffness += load.stiffness.total;
                let force = load.force.norm();
                pressing += force;
                // Along its own normal, since those of a patch that goes round cancel.
                area += load.force.dot(&load.area) / (2.0 * force).max(f64::MIN_POSITIVE);
            }
        }
        let centre = if pressure > 0.0 {
            moment / pressure
        } else {
            moment
        };
        Contact {
            a: self.ids.0,
            b: self.ids.1,
            patch: number as u32,
            point: self.near.origin + centre,
            normal,
            elastic_force,
            normal_force: elastic_force * scale,
            pressing: pressing * scale,
            rocking: Vector3::zeros(),
            rolling: Vector3::zeros(),
            friction: Vector3::zeros(),
            slides: false,
            area,
            volume: sums.volume * patch.share,
            energy: sums.energy * patch.share,
            adhesion: Adhesion::default(),
            spring_energy: 0.0,
            stiffness,
            tangential_stiffness: 0.0,
        }
    }

    /// The load on a rigid A about its origin.
    fn rigid_load(
        &self,
        scratch: &DeformableScratch,
        patches: &Patches,
        (dashpots, rockings, rollings): (&[Dashpot], &[Rocking], &[Rolling]),
        rubbing: &Rubbing,
    ) -> Option<Box<(Load, Resistance)>> {
        let Mover::Rigid(motion) = self.movers[0] else {
            return None;
        };
        let to = self.near.origin - motion.frame.position;
        let about = |[force, torque]: &[Vector3; 2]| Wrench {
            force: *force,
            torque: torque + to.cross(force),
        };
        let (mut load, mut resistance) = (Load::default(), Resistance::default());
        let mut friction = about(&rubbing.wrench);
        let mut drag = about(&rubbing.drag);
        for rolling in rollings {
            friction.torque -= rolling.moment;
            drag.torque -= rolling.drag;
        }
        let moments = rockings.iter().zip(rollings);
        for ((patch, dashpot), (rocking, rolling)) in patches.list.iter().zip(dashpots).zip(moments)
        {
            let elastic = about(&patch.wrench[0]);
            let damping = Wrench {
                force: elastic.force * (dashpot.total - 1.0),
                torque: elastic.torque * (dashpot.total - 1.0) - rocking.moment,
            };
            let (friction, drag) = (std::mem::take(&mut friction), std::mem::take(&mut drag));
            load.add_wrenches([&elastic, &damping, &friction, &drag]);
            load.normal_sum += elastic.force.norm() * dashpot.total;
            load.contacts += 1;
            if motion.inverse_mass > 0.0 {
                let viscosity = &mut resistance.viscosity;
                viscosity.add_along(&elastic.force, &elastic.torque, 2.0 * dashpot.coefficient);
                for (axis, c) in rocking.axes.iter().zip(rocking.viscosity) {
                    viscosity.add_about(axis, 2.0 * (c + rolling.viscosity));
                    resistance
                        .stiffness
                        .add_about(axis, 2.0 * rolling.stiffness);
                }
            }
        }
        if motion.inverse_mass > 0.0 {
            // (u_B - u_A)^2 <= 2 u_A^2 + 2 u_B^2: twice the stiffness for each side.
            for spring in &scratch.sums.springs {
                let lever = (spring.point + to).cross(&spring.normal);
                resistance
                    .stiffness
                    .add_along(&spring.normal, &lever, 2.0 * spring.stiffness);
            }
            for mark in &rubbing.marks {
                let arm = mark.point + to;
                resistance
                    .stiffness
                    .add_everywhere(&arm, 2.0 * mark.stiffness);
                resistance.viscosity.add_everywhere(&arm, mark.viscosity);
            }
        }
        Some(Box::new((load, resistance)))
    }
}
