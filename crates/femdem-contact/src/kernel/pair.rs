//! The gauge-gauge pair kernel (sum form, exact polygons) with its cache.

use super::candidates::{ContactBox, KeptBox, candidates, contact_box};
use super::overlap::{MEAN_OVER_RMS, Overlap};
use super::plan::{Margins, PlanScratch, SidePlan};
use super::separation::{gap_along, separate};
use super::side::{FieldPlane, Region, SideScratch, SideSums, Skin, integrate_side, pose_planes};
use crate::error::{ContactError, check_pressure};
use crate::mark::Mark;
use crate::shape::{ConvexShape, Frame};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// How long candidate lists last. A pair at rest gets short lists, a fast pair lists that last a few
/// evaluations.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Lists {
    /// Number of evaluations at the present speed that a list should last.
    lasts: f64,
    /// Least and largest margin over the sum of the inradii.
    margin: [f64; 2],
}

impl Default for Lists {
    fn default() -> Self {
        Self {
            lasts: 32.0,
            margin: [2e-4, 1e-2],
        }
    }
}

/// For bodies that move far between evaluations: lists are used only a few times, and short ones hardly more
/// than once.
const FAR_APART: Lists = Lists {
    lasts: 8.0,
    margin: [2e-4, 4e-2],
};

/// Buffers that the kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(crate) side: SideScratch,
    pub(crate) planes: Vec<FieldPlane>,
    pub(crate) heights: Vec<f64>,
    pub(crate) plan: PlanScratch,
}

/// The cache of a pair: a separating direction with the motion that it allows, or the planes and facets that
/// can touch. It never changes which contacts are found; a fresh cache gives the same result to round-off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PairCache {
    /// Contact or separating direction from A to B, in A's axes; zero: unknown.
    axis: Vector3,
    /// The cache is valid while the motion is below this, m.
    until: f64,
    /// Motion at the last evaluation, m.
    last: f64,
    /// Relative pose at which the cache was renewed, and the relative motion from there for which it is
    /// valid, m.
    found: Mark,
    margin: f32,
    /// `None`: the bodies are apart.
    near: Option<Box<Near>>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Near {
    /// In A's axes.
    pub region: KeptBox,
    /// A's field on B's skin.
    pub on_b: SidePlan,
    /// B's field on A's skin.
    pub on_a: SidePlan,
}

/// The penalty law of convex bodies: U = p int (phi_A + phi_B) dV over the overlap.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairKernel {
    #[serde(deserialize_with = "crate::error::read_penalty")]
    penalty: f64,
    #[serde(skip)]
    lists: Lists,
}

impl PairKernel {
    /// A kernel with penalty `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is between 1e-100 and 1e100 Pa.
    pub fn new(penalty: f64) -> Result<Self, ContactError> {
        check_pressure("penalty", penalty)?;
        Ok(Self {
            penalty,
            lists: Lists::default(),
        })
    }

    /// The same kernel, tuned for large motion between evaluations. Contacts are the same to round-off.
    pub fn for_large_steps(self) -> Self {
        Self {
            lists: FAR_APART,
            ..self
        }
    }

    /// The penalty, Pa.
    pub fn penalty(&self) -> f64 {
        self.penalty
    }

    /// The margin for the lists of a pair that has moved by `moved` since the last evaluation, m.
    fn margin(&self, a: &ConvexShape, b: &ConvexShape, moved: f64) -> f64 {
        let [least, largest] = self.lists.margin.map(|m| m * (a.inradius() + b.inradius()));
        (self.lists.lasts * moved).clamp(least, largest)
    }

    /// The contact of A and B. `None` if they do not overlap, or if there is no net force (one centred in the
    /// other).
    pub fn evaluate(
        &self,
        a: &ConvexShape,
        frame_a: &Frame,
        b: &ConvexShape,
        frame_b: &Frame,
        scratch: &mut Scratch,
    ) -> Option<Overlap> {
        let mut cache = PairCache::default();
        self.evaluate_cached(a, frame_a, b, frame_b, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with a cache carried from call to call.
    ///
    /// `motion` is a running upper bound of the distance that any point of A or of B has
    /// travelled (the sum of both), m. It must not decrease between calls with the same
    /// cache.
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_cached(
        &self,
        a: &ConvexShape,
        frame_a: &Frame,
        b: &ConvexShape,
        frame_b: &Frame,
        cache: &mut PairCache,
        motion: f64,
        scratch: &mut Scratch,
    ) -> Option<Overlap> {
        let expired = motion >= cache.until;
        if cache.near.is_none() && !expired {
            return None;
        }
        let rotation = frame_a.rotation.tr_mul(&frame_b.rotation);
        let between = frame_b.position - frame_a.position;
        let offset = frame_a.rotation.tr_mul(&between);
        if expired && !cache.still_holds(&rotation, &offset, b.radius(), motion) {
            let margin = self.margin(a, b, motion - cache.last);
            cache.renew(a, b, &rotation, &offset, motion, margin, scratch);
        }
        cache.last = motion;
        let near = cache.near.as_ref()?;
        let sides = sides(a, b, &rotation, &offset, near, scratch);
        let (overlap, axis) =
            self.assemble(&frame_a.rotation, &rotation, &between, near, &sides)?;
        cache.axis = axis;
        Some(overlap)
    }

    /// Turns the sums of both sides, in A's axes, into the wrench on B in world axes and the contact normal
    /// in A's axes.
    fn assemble(
        &self,
        to_world: &Matrix3,
        rotation: &Matrix3,
        between: &Vector3,
        near: &Near,
        [on_b, on_a]: &[SideSums; 2],
    ) -> Option<(Overlap, Vector3)> {
        let p = self.penalty;
        let pressure = on_a.pressure + on_b.pressure;
        let force = (on_a.force - rotation * on_b.force) * p;
        let magnitude = force.norm();
        if !(pressure > 0.0 && magnitude > 0.0) {
            return None;
        }
        let na = force / magnitude;
        let nb = rotation.tr_mul(&na);
        let centre = (on_a.pressure_moment + rotation * on_b.pressure_moment) / pressure;
        let torque = (on_a.torque - rotation * on_b.torque) * p;
        let arm_a = to_world * (near.region.centre + centre);
        let volume = na.dot(&(on_a.volume_tensor * na)) + nb.dot(&(on_b.volume_tensor * nb));
        let stiffness = p * (on_a.stiffness + on_b.stiffness);
        let stiffness_centre =
            (on_a.stiffness_moment + rotation * on_b.stiffness_moment) * (p / stiffness);
        let spread =
            (on_a.pressure_second + on_b.pressure_second) / pressure - centre.norm_squared();
        let normal = to_world * na;
        let overlap = Overlap {
            force: normal * magnitude,
            moment: to_world * (torque - centre.cross(&force)),
            arm_a,
            arm_b: arm_a - between,
            normal,
            energy: (p * (0.5 * volume + 0.25 * (on_a.lever + on_b.lever))).max(0.0),
            volume: volume.max(0.0),
            area: (0.5 * (na.dot(&on_a.vector_area) - nb.dot(&on_b.vector_area))).max(0.0),
            stiffness,
            stiffness_second: (p * (on_a.stiffness_second + on_b.stiffness_second)
                - stiffness * stiffness_centre.norm_squared())
            .max(0.0),
            torsion_radius: MEAN_OVER_RMS * spread.max(0.0).sqrt(),
        };
        Some((overlap, na))
    }
}

/// Both sides: A's field on B's skin (in B's axes), B's field on A's skin (in A's axes).
pub(super) fn sides(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    near: &Near,
    scratch: &mut Scratch,
) -> [SideSums; 2] {
    let Scratch { side, planes, .. } = scratch;
    let mut sums = [SideSums::default(); 2];
    let pose = Pose::new(rotation, offset);
    let region = near.region.open();
    let skin_b = Skin {
        shape: b,
        plan: &near.on_b,
        field_centre: pose.a_in_b,
        origin: pose.inverse * region.centre + pose.a_in_b,
        region: Region::Posed(&region, &pose),
    };
    pose_planes(a, &near.on_b.planes, &pose.inverse, &pose.a_in_b, planes);
    integrate_side(&skin_b, planes, &mut sums[0], side);
    let skin_a = Skin {
        shape: a,
        plan: &near.on_a,
        field_centre: *offset,
        origin: region.centre,
        region: Region::Here(&region),
    };
    pose_planes(b, &near.on_a.planes, rotation, offset, planes);
    integrate_side(&skin_a, planes, &mut sums[1], side);
    sums
}

/// The pose of A in B's axes.
#[derive(Debug)]
pub(crate) struct Pose {
    inverse: Matrix3,
    a_in_b: Vector3,
}

impl Pose {
    #[inline]
    pub fn new(rotation: &Matrix3, offset: &Vector3) -> Self {
        let inverse = rotation.transpose();
        Self {
            inverse,
            a_in_b: -(inverse * offset),
        }
    }

    #[inline]
    pub fn in_b(&self, region: &ContactBox) -> ContactBox {
        ContactBox {
            axes: region.axes.map(|d| self.inverse * d),
            centre: self.inverse * region.centre + self.a_in_b,
            half: region.half,
        }
    }
}

impl PairCache {
    /// Whether the planes and facets that it names are those of two bodies.
    pub(crate) fn fits(&self, a: &ConvexShape, b: &ConvexShape) -> bool {
        let near = self.near.as_deref();
        near.is_none_or(|near| near.on_b.fits(a, b) && near.on_a.fits(b, a))
    }

    /// Whether the pair was close enough for contact when the cache was last renewed.
    pub fn is_near(&self) -> bool {
        self.near.is_some()
    }

    /// Whether the cache alone shows that the pair is apart at this `motion`.
    pub fn is_clear(&self, motion: f64) -> bool {
        self.near.is_none() && motion < self.until
    }

    /// A lower bound of the gap between A and B, m, along a known direction from A to B in world axes.
    pub(crate) fn gap(
        &self,
        a: &ConvexShape,
        frame_a: &Frame,
        b: &ConvexShape,
        frame_b: &Frame,
    ) -> Option<(f64, Vector3)> {
        if self.axis.norm_squared() < 0.5 {
            return None;
        }
        let rotation = frame_a.rotation.tr_mul(&frame_b.rotation);
        let between = frame_b.position - frame_a.position;
        let offset = frame_a.rotation.tr_mul(&between);
        let gap = gap_along(a, b, &rotation, &offset, &self.axis);
        Some((gap, frame_a.rotation * self.axis))
    }

    /// Whether the relative pose is still within the margin of the cache, though the bodies may have
    /// travelled far together. The radius of B suffices for both: points of A matter only where B reaches
    /// them.
    fn still_holds(
        &mut self,
        rotation: &Matrix3,
        offset: &Vector3,
        radius: f64,
        motion: f64,
    ) -> bool {
        let left = f64::from(self.margin) - self.found.moved(rotation, offset, radius);
        if left > 0.0 {
            self.until = motion + left;
        }
        left > 0.0
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "two shapes, their relative pose, the state of the cache"
    )]
    fn renew(
        &mut self,
        a: &ConvexShape,
        b: &ConvexShape,
        rotation: &Matrix3,
        offset: &Vector3,
        motion: f64,
        margin: f64,
        scratch: &mut Scratch,
    ) {
        let holds = self.look(a, b, rotation, offset, margin, scratch);
        self.found = Mark::new(rotation, offset);
        self.margin = holds as f32;
        self.until = motion + holds;
    }

    /// Renews the state of the cache, and returns the relative motion for which it is valid, m.
    fn look(
        &mut self,
        a: &ConvexShape,
        b: &ConvexShape,
        rotation: &Matrix3,
        offset: &Vector3,
        margin: f64,
        scratch: &mut Scratch,
    ) -> f64 {
        if self.axis.norm_squared() < 0.5 {
            self.axis = offset
                .try_normalize(1e-12 * a.radius())
                .unwrap_or_else(Vector3::z);
        }
        let mut clear = gap_along(a, b, rotation, offset, &self.axis);
        self.near = None;
        if clear <= 0.25 * margin {
            self.near = find_near(a, b, rotation, offset, &self.axis, margin, scratch);
            if self.near.is_some() {
                return margin;
            }
            clear = margin;
        }
        if clear <= margin
            && let Some(better) = separate(a, b, rotation, offset, &self.axis)
            && better.gap > clear
        {
            self.axis = better.axis;
            clear = better.gap;
        }
        clear
    }
}

pub(super) fn find_near(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    axis: &Vector3,
    margin: f64,
    scratch: &mut Scratch,
) -> Option<Box<Near>> {
    let region = contact_box(a, b, rotation, offset, axis, margin, &mut scratch.heights)?;
    let pose = Pose::new(rotation, offset);
    let region_b = pose.in_b(&region);
    let in_a = candidates(a, &region, 0.0, axis)?;
    let in_b = candidates(b, &region_b, margin, &-region_b.axes[0])?;
    let Scratch { planes, plan, .. } = scratch;
    pose_planes(a, &in_a.planes, &pose.inverse, &pose.a_in_b, planes);
    let margins = |region: f64| Margins {
        field: margin,
        region,
    };
    let on_b = SidePlan::new(
        b,
        &in_b.facets,
        &in_a,
        planes,
        &region_b,
        margins(margin),
        plan,
    );
    pose_planes(b, &in_b.planes, rotation, offset, planes);
    let on_a = SidePlan::new(a, &in_a.facets, &in_b, planes, &region, margins(0.0), plan);
    let some = !(on_a.facets.is_empty() && on_b.facets.is_empty());
    some.then(|| {
        Box::new(Near {
            region: KeptBox::from(&region),
            on_b,
            on_a,
        })
    })
}
