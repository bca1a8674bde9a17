//! A contact in the implicit step: forces that change linearly with the velocities at the end of the step,
//! within the bounds of a contact that neither pulls nor exceeds its friction.

mod resistance;
mod works;

use super::twist::Twist;
use femdem_contact::{ContactForce, LimitSurface, RigidContact, Springs};
use femdem_mesh::nalgebra::{Matrix6, Vector6};
use femdem_mesh::{Matrix3, Vector3};
pub(in crate::world::implicit) use resistance::LinkResistance;
use resistance::{add, relative};

/// Relative change of a friction force or moment at its bound that requires another solution.
const SETTLED: f64 = 0.02;

/// State of a contact in a solution.
#[derive(Debug, Clone, Copy)]
enum Grip {
    /// Its friction sticks.
    Holds,
    /// It slides.
    Slides(Slip),
    /// The sides part within the step.
    Parts,
}

/// Friction at its bound. It decreases with the slip speed, so that it does not reverse the slip, and has its
/// full value where that speed does not change.
#[derive(Debug, Clone, Copy)]
struct Slip {
    /// Friction (N) and torsion (N m) at the velocities before the step.
    friction: Vector3,
    torsion: f64,
    /// Decrease per unit of velocity gained, N s/m and N m s.
    slopes: [f64; 2],
}

/// Rocking at its bound: the pressure is at the edge of the patch, and the normal spring is compressed and
/// released there. At the middle it would release energy that the contact keeps, since a body that tips over
/// an edge opens the middle of the patch.
#[derive(Debug, Clone, Copy)]
struct Tilt {
    /// Additional lever of the normal force beside that of the elastic wrench, m.
    lever: Vector3,
    /// Remaining moment at the velocities before the step, N m.
    moment: Vector3,
    /// Decrease of the moment per unit of angular velocity gained, N m s.
    slope: Matrix3,
}

impl Tilt {
    /// For a moment at its bound under a normal force. The lever is proportional to `spring`, the share of
    /// the spring in the slope of that force: the dashpot acts along the elastic wrench, as in explicit
    /// steps.
    fn new(moment: &Vector3, normal: f64, spring: f64, slope: Matrix3) -> Self {
        Self {
            lever: moment * (spring / normal),
            moment: moment * (1.0 - spring),
            slope,
        }
    }
}

/// Decrease of forces (N s/m) and moments (N m s) per unit of velocity and angular velocity gained.
#[derive(Debug, Clone, Copy)]
struct Slopes {
    /// Along the elastic wrench.
    normal: f64,
    /// In the contact plane.
    tangential: f64,
    /// Rotation about axes in the contact plane.
    rocking: Matrix3,
    /// Rotation about the normal.
    torsion: f64,
}

impl Slopes {
    /// Slopes of dashpots, and of springs that the motion loads for a time, s.
    fn new(contact: &RigidContact, time: f64) -> Self {
        let (c, springs) = (contact.dashpots(), contact.springs());
        Self {
            normal: springs.normal * time + c.normal,
            tangential: springs.tangential * time + c.tangential,
            rocking: rocking(contact, time),
            torsion: springs.torsion * time + c.torsion,
        }
    }
}

/// Slope of the resistance to rocking over a time, N m s: of springs without what rolling takes back, and of dashpots. When
/// a body rolls by a small angle on a rolling radius r, the pressure F, which travels with the patch, turns it on by F r
/// per angle. For round bodies no stiffness is left; for a face, nearly all of it.
fn rocking(contact: &RigidContact, time: f64) -> Matrix3 {
    // A contact that comes down does not roll yet.
    let rolls = if contact.foreseen {
        0.0
    } else {
        contact.elastic_force
    };
    let turns = rolls * contact.rolling_radius();
    let (springs, dashpots) = (contact.springs(), contact.dashpots());
    let mut sum = Matrix3::zeros();
    for (k, axis) in contact.foundation.axes(&contact.normal).iter().enumerate() {
        let slope = (springs.rocking[k] - turns).max(0.0) * time + dashpots.rocking[k];
        sum += axis * (axis * slope).transpose();
    }
    sum
}

/// A principal axis of the patch, and how far the normal force may move across it, m: to the edges of the patch, taken as
/// a uniform rectangle with the second moments of its foundation.
#[derive(Debug, Clone, Copy)]
struct Edge {
    axis: Vector3,
    /// Half the width of the patch.
    reach: f64,
    /// Moment of the elastic force about the centre of the patch, per force.
    off: f64,
}

fn edges(contact: &RigidContact, lever: &Vector3) -> [Edge; 2] {
    let foundation = &contact.foundation;
    let off = lever - foundation.centre.cross(&contact.normal);
    let axes = foundation.axes(&contact.normal);
    [0, 1].map(|k| Edge {
        axis: axes[k],
        reach: (3.0 * foundation.rocking[k] / foundation.stiffness).sqrt(),
        off: off.dot(&axes[k]),
    })
}

/// A contact of two sides A and B. Motions are those of B relative to A, forces those on B.
#[derive(Debug)]
pub(super) struct Link {
    /// Indices of A and B among the unknowns; none for sides that are not solved for.
    sides: [Option<u32>; 2],
    /// Contact point from the origins of A and B, m.
    arms: [Vector3; 2],
    normal: Vector3,
    /// Lever of the elastic wrench about the contact point, m.
    lever: Vector3,
    /// Relative velocity and angular velocity before the step.
    before: Twist,
    /// Forces at unchanged velocities: elastic and damped along the normal, the others as if they stuck.
    start: ContactForce,
    springs: Springs,
    slopes: Slopes,
    /// Decrease of the starting normal force per unit of velocity before the step, N s/m.
    eased: f64,
    friction: f64,
    /// Elastic normal force where the contact was evaluated, N.
    elastic: f64,
    foreseen: bool,
    /// Of the patch, for the bound of torsion, m.
    radius: f64,
    edges: [Edge; 2],
    dt: f64,
    grip: Grip,
    /// Set while the rocking moment exceeds its bound.
    tilt: Option<Tilt>,
}

/// Decrease of a force at its bound per unit of velocity gained, at most `most`, such that the force vanishes
/// when the velocity that it opposes does.
fn slope_at_bound(force: &Vector3, velocity: &Vector3, most: f64) -> f64 {
    let size = force.norm();
    let speed = -force.dot(velocity) / size.max(f64::MIN_POSITIVE);
    if speed > 0.0 {
        (size / speed).min(most)
    } else {
        0.0
    }
}

impl Link {
    /// `before` is the velocity and angular velocity of B relative to A at the contact point, `friction`
    /// Coulomb's coefficient, `dt` the step, s. The contact has the forces of its springs alone, at the
    /// present poses or, if it is foreseen, at those predicted after `dt` from these velocities.
    pub(super) fn new(
        contact: &RigidContact,
        sides: [Option<u32>; 2],
        arms: [Vector3; 2],
        before: Twist,
        friction: f64,
        dt: f64,
    ) -> Self {
        let (n, springs) = (contact.normal, contact.springs());
        let lever = if contact.elastic_force > 0.0 {
            contact.moment / contact.elastic_force
        } else {
            Vector3::zeros()
        };
        let opening = n.dot(&before.velocity) + lever.dot(&before.turning);
        let across = |x: &Vector3| x - n * n.dot(x);
        let slopes = Slopes::new(contact, dt);
        // Springs of a foreseen contact already include the displacement of the step.
        let ahead = if contact.foreseen { 0.0 } else { dt };
        let ahead = Slopes::new(contact, ahead);
        let mut link = Self {
            sides,
            arms,
            normal: n,
            lever,
            before,
            start: ContactForce {
                normal: contact.elastic_force - ahead.normal * opening,
                friction: contact.friction - across(&before.velocity) * ahead.tangential,
                torsion: contact.torsion - ahead.torsion * n.dot(&before.turning),
                rocking: -(ahead.rocking * before.turning),
                slides: contact.slides,
            },
            springs,
            slopes,
            eased: ahead.normal,
            friction,
            elastic: contact.elastic_force,
            foreseen: contact.foreseen,
            radius: contact.torsion_radius,
            edges: edges(contact, &lever),
            dt,
            grip: Grip::Holds,
            tilt: None,
        };
        if contact.slides {
            // It keeps sliding.
            let dashpots = contact.dashpots();
            let friction = contact.friction - across(&before.velocity) * dashpots.tangential;
            let torsion = contact.torsion - n.dot(&before.turning) * dashpots.torsion;
            let share = link.share(&friction, torsion, link.start.normal.max(0.0));
            link.grip = Grip::Slides(link.slip(
                &(friction * share[0]),
                torsion * share[1],
                [0.0; 2],
                share,
            ));
        }
        link
    }

    /// Relative velocity and angular velocity of B against A from those of the bodies.
    fn relative(&self, x: &[Twist]) -> Twist {
        relative(&self.sides, &self.arms, x)
    }

    /// Adds a force and a moment on B, and the opposite ones on A.
    fn add(&self, force: &Vector3, moment: &Vector3, out: &mut [Twist]) {
        add(&self.sides, &self.arms, [force, moment], out);
    }

    fn add_force(&self, f: &ContactForce, out: &mut [Twist]) {
        let force = self.normal * f.normal + f.friction;
        let moment = self.lever * f.normal + self.normal * f.torsion + f.rocking;
        self.add(&force, &moment, out);
    }

    /// Adds the forces at the velocities before the step.
    pub(super) fn add_start(&self, out: &mut [Twist]) {
        let tilt = self.rocks();
        let normal = self.normal_at_start(&tilt);
        let mut forces = ContactForce {
            normal,
            rocking: tilt.lever * normal + tilt.moment,
            ..self.start
        };
        match self.grip {
            Grip::Holds => {}
            Grip::Slides(slip) => {
                forces.friction = slip.friction;
                forces.torsion = slip.torsion;
            }
            Grip::Parts => return,
        }
        self.add_force(&forces, out);
    }

    /// How rocking is resisted: by spring and dashpot, unless it is at its bound.
    fn rocks(&self) -> Tilt {
        self.tilt.unwrap_or(Tilt {
            lever: Vector3::zeros(),
            moment: self.start.rocking,
            slope: self.slopes.rocking,
        })
    }

    /// The normal force at the velocities before the step, N.
    fn normal_at_start(&self, tilt: &Tilt) -> f64 {
        self.start.normal - self.eased * tilt.lever.dot(&self.before.turning)
    }

    /// The slip state for friction and torsion at their bounds after a change of velocity and spin; `share`
    /// are the fractions of both within the bound.
    fn slip(&self, friction: &Vector3, torsion: f64, change: [f64; 2], share: [f64; 2]) -> Slip {
        let slope = slope_at_bound(friction, &self.before.velocity, self.slopes.tangential);
        let turning = share[1] * self.slopes.torsion;
        Slip {
            friction: *friction,
            torsion: torsion + turning * change[1],
            slopes: [slope, turning],
        }
    }

    /// Slopes of friction and torsion.
    fn held(&self) -> Option<[f64; 2]> {
        match self.grip {
            Grip::Holds => Some([self.slopes.tangential, self.slopes.torsion]),
            Grip::Slides(slip) => Some(slip.slopes),
            Grip::Parts => None,
        }
    }

    /// What the contact adds to the matrix of the system in its present state; `None` if its sides part.
    pub(super) fn resistance(&self) -> Option<LinkResistance> {
        let [held, torsion] = self.held()?;
        let tilt = self.rocks();
        Some(LinkResistance {
            sides: self.sides,
            arms: self.arms,
            normal: self.normal,
            lever: self.lever + tilt.lever,
            pressed: self.slopes.normal,
            held,
            torsion,
            rocking: tilt.slope,
        })
    }

    /// Adds the blocks on the diagonal.
    pub(super) fn add_blocks(&self, blocks: &mut [Matrix6<f64>]) {
        let Some(held) = self.held() else {
            return;
        };
        for (side, arm) in self.sides.iter().zip(&self.arms) {
            if let Some(i) = side {
                blocks[*i as usize] += self.block(arm, held);
            }
        }
    }

    fn block(&self, arm: &Vector3, [held, torsion]: [f64; 2]) -> Matrix6<f64> {
        let (n, s) = (&self.normal, &self.slopes);
        let tilt = self.rocks();
        let lever = self.lever + tilt.lever;
        let mut block = Matrix6::zeros();
        let mut add_along = |turn: &Vector3, value: f64| {
            let x = Vector6::new(n.x, n.y, n.z, turn.x, turn.y, turn.z);
            block += x * (x * value).transpose();
        };
        let turned = arm.cross(n);
        add_along(&(turned + lever), s.normal);
        add_along(&turned, -held);
        let coupling = arm.cross_matrix() * held;
        let turning = Matrix3::from_diagonal_element(held * arm.norm_squared())
            - arm * (arm * held).transpose()
            + n * (n * torsion).transpose()
            + tilt.slope;
        for i in 0..3 {
            block[(i, i)] += held;
            for j in 0..3 {
                block[(3 + i, j)] += coupling[(i, j)];
                block[(j, 3 + i)] += coupling[(i, j)];
                block[(3 + i, 3 + j)] += turning[(i, j)];
            }
        }
        block
    }

    /// The forces after a change of the velocities, limited to their bounds, and the fraction of friction and
    /// torsion within them.
    fn forces(&self, change: &Twist) -> (ContactForce, [f64; 2]) {
        let (n, s) = (&self.normal, &self.slopes);
        let (along, spin) = (n.dot(&change.velocity), n.dot(&change.turning));
        let tilt = self.rocks();
        let opening = along + (self.lever + tilt.lever).dot(&change.turning);
        let normal = self.normal_at_start(&tilt) - s.normal * opening;
        if normal <= 0.0 {
            let none = ContactForce {
                normal: 0.0,
                friction: Vector3::zeros(),
                torsion: 0.0,
                rocking: Vector3::zeros(),
                slides: false,
            };
            return (none, [1.0; 2]);
        }
        let (friction, torsion, [held, turning]) = match self.grip {
            Grip::Slides(slip) => (slip.friction, slip.torsion, slip.slopes),
            Grip::Holds | Grip::Parts => (
                self.start.friction,
                self.start.torsion,
                [s.tangential, s.torsion],
            ),
        };
        let friction = friction - (change.velocity - n * along) * held;
        let torsion = torsion - spin * turning;
        let rocking = tilt.lever * normal + tilt.moment - tilt.slope * change.turning;
        let share = self.share(&friction, torsion, normal);
        let forces = ContactForce {
            normal,
            friction: friction * share[0],
            torsion: torsion * share[1],
            rocking: self.at_edge(&rocking, normal).unwrap_or(rocking),
            slides: share != [1.0; 2] || matches!(self.grip, Grip::Slides(_)),
        };
        (forces, share)
    }

    /// A rocking moment that would move the centre of pressure out of the patch, reduced to its bound, since
    /// the sides do not pull; `None` if it is within.
    fn at_edge(&self, moment: &Vector3, normal: f64) -> Option<Vector3> {
        let mut within = *moment;
        for Edge { axis, reach, off } in &self.edges {
            let asked = moment.dot(axis);
            let room = normal * (reach - off * asked.signum()).max(0.0);
            if asked.abs() > room {
                within -= axis * (asked - room.copysign(asked));
            }
        }
        (within != *moment).then_some(within)
    }

    /// The fractions of friction and torsion within the limit surface of the friction law.
    fn share(&self, friction: &Vector3, torsion: f64, normal: f64) -> [f64; 2] {
        let most = self.friction * normal;
        let bounds = LimitSurface {
            force: most,
            moment: most * self.radius,
        };
        // Where it slides steadily, springs exceed the bound by what the slip stretches them in a step.
        let [k, k_theta] = [self.springs.tangential, self.springs.torsion];
        bounds.within(friction.norm(), torsion.abs(), k, k_theta)
    }

    /// Updates from a solution whether friction and rocking stick and whether the sides part; returns whether
    /// another solution is needed.
    pub(super) fn follow(&mut self, x: &[Twist]) -> bool {
        let x = self.relative(x);
        let (found, within) = self.forces(&x);
        let before = std::mem::replace(&mut self.grip, Grip::Holds);
        let (held, share) = self.forces(&x);
        if held.normal <= 0.0 {
            self.grip = Grip::Parts;
            self.tilt = None;
            return !matches!(before, Grip::Parts);
        }
        let tilted = self.follow_tilt(&x, &found.rocking, held.normal);
        if share == [1.0; 2] {
            return tilted || !matches!(before, Grip::Holds);
        }
        self.grip = self.slides(&x, &held, share);
        let size = held.friction.norm();
        let off = (found.friction * (1.0 / within[0]) - held.friction).norm();
        tilted || !matches!(before, Grip::Slides(_)) || off > SETTLED * size
    }

    /// Reactivates a contact that was excluded as parting but closes in a solution; returns whether it did.
    pub(super) fn close_again(&mut self, x: &[Twist]) -> bool {
        if !matches!(self.grip, Grip::Parts) {
            return false;
        }
        let x = self.relative(x);
        let (held, share) = self.forces(&x);
        if held.normal <= 0.0 {
            return false;
        }
        self.grip = if share != [1.0; 2] {
            self.slides(&x, &held, share)
        } else {
            Grip::Holds
        };
        true
    }

    /// Sliding state from the sticking forces after a change of the velocities, of which the fractions
    /// `share` are within the bound.
    fn slides(&self, x: &Twist, held: &ContactForce, share: [f64; 2]) -> Grip {
        let change = [0.0, self.normal.dot(&x.turning)];
        Grip::Slides(self.slip(&held.friction, held.torsion, change, share))
    }

    /// The same for rocking; `found` is the moment of the solution.
    fn follow_tilt(&mut self, x: &Twist, found: &Vector3, normal: f64) -> bool {
        let before = self.tilt.take();
        let held = self.start.rocking - self.slopes.rocking * x.turning;
        let Some(moment) = self.at_edge(&held, normal) else {
            return before.is_some();
        };
        let square = moment.norm_squared().max(f64::MIN_POSITIVE);
        let full = moment.dot(&(self.slopes.rocking * moment)) / square;
        let slope = slope_at_bound(&moment, &self.before.turning, full);
        let slope = self.slopes.rocking * if full > 0.0 { slope / full } else { 0.0 };
        let spring = self.springs.normal * self.dt / self.slopes.normal.max(f64::MIN_POSITIVE);
        self.tilt = Some(Tilt::new(&moment, normal, spring, slope));
        let off = (found - moment).norm();
        before.is_none() || off > SETTLED * moment.norm()
    }

    /// The forces of a solution, added to `out`.
    pub(super) fn answer(&self, x: &[Twist], out: &mut [Twist]) -> ContactForce {
        let (forces, _) = self.forces(&self.relative(x));
        self.add_force(&forces, out);
        forces
    }
}
