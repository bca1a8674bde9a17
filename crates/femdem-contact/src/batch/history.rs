//! Matching of the patches of a pair with those of one step ago, which carries the friction history through
//! slip, splits and merges.
//!
//! A patch continues the old patch with its key, or else the nearest one. A patch that splits has several
//! heirs, which share its bristles. An old patch without heir is merged into the nearest new one. A patch too
//! far away for either vanishes, and the energy of its springs is dissipated. Everything is done in index
//! order, so that the outcome is a function of the state.

use crate::contact::RigidContact;
use crate::friction::{FrictionState, Springs};
use crate::kernel::Overlap;
use crate::motion::Motion;
use crate::rocking::RockingState;
use crate::rolling::RollingState;
use crate::spring_load::SpringLoad;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Patches farther apart than this many times the sum of their radii are not matched.
const REACH: f64 = 4.0;

/// What a patch remembers from step to step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct History {
    pub friction: FrictionState,
    pub rocking: RockingState,
    pub rolling: RollingState,
    /// Whether the patch formed within the last step.
    pub fresh: bool,
}

impl History {
    /// Of a patch that has just formed.
    pub fn new(overlap: &Overlap, a: &Motion, b: &Motion) -> Self {
        FrictionState::new(overlap, a, b).into()
    }
}

/// Of a patch that takes over friction springs.
impl From<FrictionState> for History {
    fn from(friction: FrictionState) -> Self {
        Self {
            friction,
            rocking: RockingState::default(),
            rolling: RollingState::default(),
            fresh: false,
        }
    }
}

/// A patch on record.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct PatchRecord {
    /// The key that the kernel gave to it.
    pub key: [u32; 2],
    /// The contact point in the axes of A and of B, m from their origins.
    place: [Vector3; 2],
    /// Mean distance of the pressure from the contact point, m.
    radius: f64,
    pub history: History,
    pub contact: RigidContact,
}

impl PatchRecord {
    pub fn new(
        key: [u32; 2],
        overlap: &Overlap,
        [a, b]: [&Motion; 2],
        history: History,
        contact: RigidContact,
    ) -> Self {
        Self {
            key,
            place: [
                a.frame.rotation.tr_mul(&overlap.arm_a),
                b.frame.rotation.tr_mul(&overlap.arm_b),
            ],
            radius: overlap.torsion_radius,
            history,
            contact,
        }
    }

    /// Invalidates the key: the kernel's keys have changed, and only positions match patches now.
    pub fn forget_key(&mut self) {
        self.key = [u32::MAX; 2];
    }

    /// Gives its springs a load. `ratio` is the tangential over the normal stiffness.
    pub fn carry(&mut self, [a, b]: [&Motion; 2], load: &SpringLoad, ratio: f64) {
        let foundation = &self.contact.foundation;
        let stiffness = [ratio * foundation.stiffness, ratio * foundation.polar()];
        let normal = self.contact.normal;
        let across = load.force - normal * normal.dot(&load.force);
        let places = [self.contact.arm_a, self.contact.arm_b];
        let friction = FrictionState::carrying(places, [a, b], &across, load.torsion, stiffness);
        self.history = History {
            rolling: RollingState::carrying(load.rolling),
            ..friction.into()
        };
    }

    /// Distance (m) between a patch and the present place of this one, carried along by both bodies, if
    /// within reach.
    fn distance(&self, overlap: &Overlap, [a, b]: [&Motion; 2]) -> Option<f64> {
        let by_a = a.frame.rotation * self.place[0];
        let by_b = overlap.arm_a - overlap.arm_b + b.frame.rotation * self.place[1];
        let distance = (overlap.arm_a - (by_a + by_b) * 0.5).norm();
        let reach = REACH * (self.radius + overlap.torsion_radius) + 2.0 * (by_a - by_b).norm();
        (distance <= reach).then_some(distance)
    }
}

/// Initial histories of the patches found now, taken from the recorded ones. `ratio` is the tangential
/// over the normal stiffness.
pub(crate) fn inherit(
    old: &[PatchRecord],
    new: &[([u32; 2], &Overlap)],
    motions: [&Motion; 2],
    ratio: f64,
) -> Vec<History> {
    let [a, b] = motions;
    if let ([one], [(_, overlap)]) = (old, new)
        && one.distance(overlap, motions).is_some()
    {
        return vec![one.history];
    }
    let parents = parents(old, new, motions);
    let parts = parts(old, new, &parents, motions);
    let mut plain = true;
    let mut states: Vec<History> = Vec::with_capacity(new.len());
    for ((_, overlap), (parents, parts)) in new.iter().zip(parents.iter().zip(&parts)) {
        let only = matches!((parents.as_slice(), parts.as_slice()), ([_], [(_, true)]));
        let springs: Vec<Springs> = parts.iter().map(|p| p.0).collect();
        states.push(if only {
            old[parents[0]].history
        } else if let Some(springs) = Springs::merged(&springs, &overlap.normal) {
            plain = false;
            FrictionState::with_springs(overlap, a, b, &springs).into()
        } else {
            History::new(overlap, a, b)
        });
    }
    if !plain {
        limit_energy(old, new, &mut states, motions, ratio);
    }
    states
}

/// The old patches that each new one continues, ascending.
fn parents(
    old: &[PatchRecord],
    new: &[([u32; 2], &Overlap)],
    motions: [&Motion; 2],
) -> Vec<Vec<usize>> {
    let mut heirless = vec![true; old.len()];
    let mut parents: Vec<Vec<usize>> = Vec::with_capacity(new.len());
    for (key, overlap) in new {
        let same = old.iter().position(|o| o.key == *key);
        let parent = same.or_else(|| nearest(old.iter().map(|o| o.distance(overlap, motions))));
        if let Some(i) = parent {
            heirless[i] = false;
        }
        parents.push(parent.into_iter().collect());
    }
    for (i, o) in old.iter().enumerate().filter(|(i, _)| heirless[*i]) {
        let distances = new.iter().map(|(_, overlap)| o.distance(overlap, motions));
        if let Some(k) = nearest(distances) {
            parents[k].push(i);
            parents[k].sort_unstable();
        }
    }
    parents
}

/// Index of the smallest distance, the first of equals.
fn nearest(distances: impl Iterator<Item = Option<f64>>) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (i, d) in distances.enumerate() {
        if let Some(d) = d
            && best.is_none_or(|(_, least)| d < least)
        {
            best = Some((i, d));
        }
    }
    best.map(|(i, _)| i)
}

/// The springs that each new patch takes over from its parents, and whether they are all of the parent's
/// springs. Heirs of one parent share its springs by their stiffness.
fn parts(
    old: &[PatchRecord],
    new: &[([u32; 2], &Overlap)],
    parents: &[Vec<usize>],
    [a, b]: [&Motion; 2],
) -> Vec<Vec<(Springs, bool)>> {
    let weight = |k: usize| new[k].1.foundation.stiffness.max(f64::MIN_POSITIVE);
    let mut total = vec![0.0; old.len()];
    let mut heirs = vec![0_u32; old.len()];
    for (k, list) in parents.iter().enumerate() {
        for &i in list {
            total[i] += weight(k);
            heirs[i] += 1;
        }
    }
    let of = |k: usize, i: usize| {
        let springs = old[i].history.friction.springs(a, b);
        let all = heirs[i] == 1;
        let part = if all { 1.0 } else { weight(k) / total[i] };
        (springs.share(part), all)
    };
    let list = |(k, list): (usize, &Vec<usize>)| list.iter().map(|&i| of(k, i)).collect();
    parents.iter().enumerate().map(list).collect()
}

/// Limits the energy: splits and merges redistribute the bristles and create no energy.
fn limit_energy(
    old: &[PatchRecord],
    new: &[([u32; 2], &Overlap)],
    states: &mut [History],
    [a, b]: [&Motion; 2],
    ratio: f64,
) {
    let before: f64 = old
        .iter()
        .map(|o| o.history.friction.springs(a, b).energy(&o.contact.normal))
        .sum();
    // A patch that is softer than the springs it took over stores its own stiffness times the stretch.
    let held = |(state, (_, overlap)): (&History, &([u32; 2], &Overlap))| {
        let mut springs = state.friction.springs(a, b);
        springs.stiffness = springs.stiffness.min(ratio * overlap.foundation.stiffness);
        let second = ratio * overlap.foundation.polar();
        springs.torsion_stiffness = springs.torsion_stiffness.min(second);
        springs.energy(&overlap.normal)
    };
    let after: f64 = states.iter().zip(new).map(held).sum();
    if after > before {
        let scale = (before / after).sqrt();
        for (state, (_, overlap)) in states.iter_mut().zip(new) {
            state.friction.relax(overlap, a, b, scale);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Partner, assemble};
    use crate::damping::{Moment, damp};
    use crate::foundation::Foundation;
    use crate::friction::Pace;
    use crate::law::ContactParameters;
    use crate::rocking::Rocking;
    use crate::rolling::Rolling;
    use crate::shape::Frame;

    /// A round patch of radius 0.1 at `x` on the plane z = 0, of stiffness `k`.
    fn overlap(x: f64, k: f64) -> Overlap {
        Overlap {
            force: Vector3::z(),
            moment: Vector3::zeros(),
            arm_a: Vector3::x() * x,
            arm_b: Vector3::x() * x,
            normal: Vector3::z(),
            energy: 1.0,
            volume: 1.0,
            area: 1.0,
            foundation: Foundation::round(Vector3::zeros(), Vector3::x(), k, 0.01 * k),
            torsion_radius: 0.1,
        }
    }

    /// Patches at the given places, stretched by 1 mm along x.
    fn records(places: &[(f64, f64)], body: &Motion) -> Vec<PatchRecord> {
        let law = ContactParameters {
            friction: 1e3,
            tangential_damping: 0.0,
            ..ContactParameters::default()
        };
        let mut moved = *body;
        moved.frame.position.x += 1e-3;
        places
            .iter()
            .enumerate()
            .map(|(i, &(x, k))| {
                let before = overlap(x, k);
                let mut now = before;
                now.arm_b.x -= 1e-3;
                let mut state = FrictionState::new(&before, body, body);
                let pace = Pace {
                    dt: 1.0,
                    dashpots: true,
                    share: 1.0,
                    birth: None,
                };
                let friction = state.update(&law, &now, 1.0, body, &moved, pace);
                let damped = damp(&now, None, body, &moved, 0.0, Moment::default());
                let ids = (Partner::Body(0), 1, i as u32);
                let contact = assemble(
                    ids,
                    &now,
                    &damped,
                    (&Rocking::default(), &Rolling::default()),
                    &friction,
                    [body, &moved],
                );
                PatchRecord::new([i as u32, 0], &now, [body, &moved], state.into(), contact)
            })
            .collect()
    }

    /// Stretch times stiffness of the heirs at the given places, with keys from 100 upwards.
    fn forces(old: &[PatchRecord], places: &[(f64, f64)]) -> Vec<f64> {
        let body = Motion::fixed(Frame::identity());
        let mut moved = body;
        moved.frame.position.x += 1e-3;
        let overlaps: Vec<Overlap> = places
            .iter()
            .map(|&(x, k)| {
                let mut o = overlap(x, k);
                o.arm_b.x -= 1e-3;
                o
            })
            .collect();
        let new: Vec<_> = (100..).map(|i| [i, 0]).zip(&overlaps).collect();
        inherit(old, &new, [&body, &moved], 0.8)
            .iter()
            .map(|s| {
                let springs = s.friction.springs(&body, &moved);
                springs.stretch.x * springs.stiffness
            })
            .collect()
    }

    fn near(got: &[f64], want: &[f64]) -> bool {
        let close = |(x, y): (&f64, &f64)| (x - y).abs() < 1e-12;
        got.len() == want.len() && got.iter().zip(want).all(close)
    }

    #[test]
    fn heirs_share_and_orphans_join() {
        let body = Motion::fixed(Frame::identity());
        // 0.8 k times 1 mm.
        let old = records(&[(0.0, 10.0), (5.0, 20.0)], &body);
        assert!(near(
            &forces(&old, &[(0.01, 10.0), (5.02, 20.0)]),
            &[8e-3, 16e-3]
        ));
        // Both heirs of the first are within reach of it alone, so they share by stiffness.
        let split = forces(&old, &[(-0.2, 2.0), (0.3, 6.0), (5.0, 20.0)]);
        assert!(near(&split, &[2e-3, 6e-3, 16e-3]), "{split:?}");
        let close = records(&[(0.0, 10.0), (0.4, 30.0)], &body);
        assert!(near(&forces(&close, &[(0.3, 40.0)]), &[32e-3]));
    }

    #[test]
    fn strangers_inherit_nothing() {
        let body = Motion::fixed(Frame::identity());
        let old = records(&[(0.0, 10.0)], &body);
        assert!(near(&forces(&old, &[(3.0, 10.0)]), &[0.0]));
        assert!(near(
            &forces(&old, &[(0.0, 10.0), (3.0, 10.0)]),
            &[8e-3, 0.0]
        ));
    }
}
