//! The attraction of contacts, and liquid bridges between bodies that have touched and are apart.

use super::evaluate::Context;
use super::pairs::{BallPair, Bridge, Cache, Pair};
use crate::adhesion::{Adhesion, Round, VectorArea, before_end};
use crate::contact::{BodyId, Partner, RigidContact};
use crate::kernel::{CavityKernel, Overlap, Scratch};
use crate::law::ContactParameters;
use crate::shape::Frame;
use crate::sphere::Meeting;
use femdem_mesh::Vector3;

/// When an attraction began and ends, by the way that the two have to go.
struct Span {
    /// How fast they open, m/s.
    opening: f64,
    /// How deep they are in it, m.
    depth: f64,
    /// How far it is to its end, m.
    left: f64,
    /// Whether it began within the last step.
    fresh: bool,
}

impl Context<'_> {
    /// Keeps on record whether something began within the last step; an evaluation outside of a step is at the end of it.
    pub(super) fn date(&self, fresh: &mut bool, is_new: bool) {
        if self.pace.dt > 0.0 {
            *fresh = is_new;
        }
    }

    /// Factor of a force that begins or ends with a jump within a step.
    fn weight(&self, span: &Span) -> f64 {
        if span.opening > 0.0 {
            before_end(span.left, span.opening, self.last_step)
        } else if span.fresh {
            // As if it had just ended in reversed time.
            before_end(span.depth, -span.opening, self.last_step)
        } else {
            1.0
        }
    }

    /// How fast the two open along a direction from A to B at the ends of their arms, m/s.
    fn opening(&self, (a, b): (Partner, BodyId), arms: [&Vector3; 2], direction: &Vector3) -> f64 {
        let (of_a, of_b) = self.motions(a, b);
        direction.dot(&(of_b.velocity_at(arms[1]) - of_a.velocity_at(arms[0])))
    }

    /// The cohesion of a patch.
    pub(super) fn cohere(
        &self,
        ids: (Partner, BodyId),
        law: &ContactParameters,
        area: &VectorArea,
        overlap: &Overlap,
        fresh: bool,
    ) -> Adhesion {
        let found = Adhesion::of_area(law.cohesion, area, overlap.volume, &overlap.arm_b);
        let stiffness = overlap.foundation.stiffness;
        if found.is_none() || stiffness <= 0.0 {
            return found;
        }
        let depth = overlap.force_magnitude() / stiffness;
        let arms = [&overlap.arm_a, &overlap.arm_b];
        found.weighted(self.weight(&Span {
            opening: self.opening(ids, arms, &overlap.normal),
            depth,
            left: depth,
            fresh,
        }))
    }

    /// Gives a pair that touches in one patch its attraction, and the liquid bridge that forms.
    pub(super) fn attract(&self, pair: &mut Pair, overlap: &Overlap, scratch: &mut Scratch) {
        let ids = (pair.a, pair.b);
        let Some(touch) = pair.touch.as_deref_mut() else {
            return;
        };
        let law = self.materials.law(pair.a, pair.b);
        touch.contact.adhesion = Adhesion::default();
        if law.cohesion > 0.0 {
            let area = self.vector_area(ids, &pair.cache, &law, overlap, scratch);
            touch.contact.adhesion = self.cohere(ids, &law, &area, overlap, touch.history.fresh);
        }
        if let Cache::Sphere(ball) = &mut pair.cache {
            let round = self.round(ids);
            let found = round.map(|round| {
                let adhesion = self.adhere(ids, &law, &round, overlap, touch.history.fresh);
                adhesion.and(&self.wet(ids, &law, &round, overlap, ball))
            });
            let adhesion = touch.contact.adhesion.and(&found.unwrap_or_default());
            touch.contact.adhesion = adhesion;
        }
    }

    /// The vector area of a contact of one patch that has just been found.
    fn vector_area(
        &self,
        (a, b): (Partner, BodyId),
        cache: &Cache,
        law: &ContactParameters,
        overlap: &Overlap,
        scratch: &mut Scratch,
    ) -> VectorArea {
        let (of_a, of_b) = self.motions(a, b);
        let frames = [&of_a.frame, &of_b.frame];
        let convex = |body: BodyId| self.shape(body).convex();
        let found = match (cache, a) {
            (Cache::Body(cache), Partner::Body(i)) => convex(i).zip(convex(b)).map(|(x, y)| {
                let kernel = self.pair_kernel(law.penalty);
                kernel.vector_area([x, y], frames, cache, scratch)
            }),
            (Cache::Wall(cache), Partner::Wall(w)) => {
                self.planes(w).zip(convex(b)).map(|(wall, body)| {
                    let kernel = CavityKernel::of(law.penalty);
                    kernel.vector_area(wall, body, frames, cache, scratch)
                })
            }
            (Cache::Sphere(_), _) => {
                let meeting = self.meeting(a, b, frames);
                meeting.map(|meeting| meeting.vector_area(overlap))
            }
            _ => None,
        };
        found.unwrap_or_default()
    }

    /// A sphere and what it meets.
    pub(super) fn meeting<'s>(
        &'s self,
        a: Partner,
        b: BodyId,
        frames: [&'s Frame; 2],
    ) -> Option<Meeting<'s>> {
        let body = self.shape(b);
        match a {
            Partner::Body(i) => Meeting::of_bodies([self.shape(i), body], frames),
            Partner::Wall(w) => Meeting::with_wall(self.planes(w)?, frames, body),
        }
    }

    /// A ball, as side B, with another or a plane.
    fn round(&self, (a, b): (Partner, BodyId)) -> Option<Round> {
        let (of_a, of_b) = self.motions(a, b);
        self.meeting(a, b, [&of_a.frame, &of_b.frame])?.round()
    }

    /// The adhesion of two round bodies that touch.
    fn adhere(
        &self,
        ids: (Partner, BodyId),
        law: &ContactParameters,
        round: &Round,
        overlap: &Overlap,
        fresh: bool,
    ) -> Adhesion {
        if law.adhesion_energy == 0.0 {
            return Adhesion::default();
        }
        let arms = [&overlap.arm_a, &overlap.arm_b];
        let found = Adhesion::of_round(law.adhesion_energy, round, &overlap.arm_b);
        found.weighted(self.weight(&Span {
            opening: self.opening(ids, arms, &round.direction),
            depth: round.depth,
            left: round.depth,
            fresh,
        }))
    }

    /// The liquid bridge of two round bodies that touch, which forms if there is none.
    fn wet(
        &self,
        ids: (Partner, BodyId),
        law: &ContactParameters,
        round: &Round,
        overlap: &Overlap,
        ball: &mut BallPair,
    ) -> Adhesion {
        let Some(liquid) = law.bridge() else {
            ball.bridge = None;
            return Adhesion::default();
        };
        let mut fresh = ball.bridge.as_ref().is_some_and(|bridge| bridge.fresh);
        self.date(&mut fresh, ball.bridge.is_none());
        ball.clear_until = 0.0;
        ball.bridge = Some(Box::new(Bridge {
            work_of_rupture: liquid.work_of_rupture(round.radius),
            fresh,
            across_gap: None,
        }));
        let arms = [&overlap.arm_a, &overlap.arm_b];
        let found = Adhesion::of_bridge(liquid, round, &overlap.arm_b);
        found.weighted(self.weight(&Span {
            opening: self.opening(ids, arms, &round.direction),
            depth: round.depth,
            left: round.depth + liquid.rupture_distance(),
            fresh,
        }))
    }

    /// Stretches the liquid bridge of two that do not touch any more, or breaks it.
    pub(super) fn stretch(&self, pair: &mut Pair) {
        let ids = (pair.a, pair.b);
        let Cache::Sphere(ball) = &mut pair.cache else {
            return;
        };
        let Some(bridge) = ball.bridge.as_deref_mut() else {
            return;
        };
        let law = self.materials.law(pair.a, pair.b);
        let joined = law
            .bridge()
            .zip(self.round(ids))
            .and_then(|(liquid, round)| {
                let left = round.depth + liquid.rupture_distance();
                (left > 0.0).then_some((liquid, round, left))
            });
        let Some((liquid, round, left)) = joined else {
            // Outside of a step the host has changed what holds it, and keeps the books of that.
            if self.pace.dt > 0.0 {
                pair.broken = bridge.work_of_rupture;
            }
            ball.bridge = None;
            return;
        };
        let (of_a, of_b) = self.motions(pair.a, pair.b);
        let [from_a, from_b] = [of_a.frame.position, of_b.frame.position];
        let radius = self.shape(pair.b).radius();
        let arm_b = round.direction * (0.5 * round.depth - radius);
        let arm_a = from_b - from_a + arm_b;
        self.date(&mut bridge.fresh, false);
        let found = Adhesion::of_bridge(liquid, &round, &arm_b);
        let adhesion = found.weighted(self.weight(&Span {
            opening: self.opening(ids, [&arm_a, &arm_b], &round.direction),
            depth: round.depth,
            left,
            fresh: false,
        }));
        bridge.work_of_rupture = liquid.work_of_rupture(round.radius);
        let contact = RigidContact::across_gap(
            ids,
            from_b + arm_b,
            [arm_a, arm_b],
            round.direction,
            adhesion,
        );
        bridge.across_gap = Some(contact);
    }
}
