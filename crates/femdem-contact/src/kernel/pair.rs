//! The gauge-gauge pair kernel (exact polygons) with its cache.

use super::candidates::{KeptBox, candidates, contact_box};
use super::deep::volume_within;
use super::field::CLOSE;
use super::overlap::Overlap;
use super::plan::{Margins, PlanScratch, SidePlan};
use super::plane::{FieldPlane, pose_planes};
use super::region::{Pose, Region};
use super::separation::{gap_along, separate};
use super::side::{SideScratch, integrate_side};
use super::skin::{SideSums, Skin};
use super::touching::of_skin;
use super::trail::Trail;
use crate::adhesion::VectorArea;
use crate::error::{ContactError, check_pressure};
use crate::foundation::{Foundation, FoundationSums};
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
    pub trail: Trail,
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
        Ok(Self::of(penalty))
    }

    /// With a penalty that was checked.
    pub(crate) fn of(penalty: f64) -> Self {
        Self {
            penalty,
            lists: Lists::default(),
        }
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
        let near = cache.near.as_deref_mut()?;
        std::mem::swap(&mut near.trail, &mut scratch.side.fast.trail);
        let sides = sides(a, b, &rotation, &offset, near, scratch);
        std::mem::swap(&mut near.trail, &mut scratch.side.fast.trail);
        near.trail.begin();
        let contents = Contents::new(a, b, &rotation, &offset, &sides);
        let (overlap, axis) = self.assemble(
            &frame_a.rotation,
            &rotation,
            &between,
            near,
            &sides,
            &contents,
        )?;
        cache.axis = axis;
        Some(overlap)
    }

    /// The vector area of B's skin in A where [`evaluate_cached`](Self::evaluate_cached) has just found a contact with this cache; none
    /// where it has found none.
    pub fn vector_area(
        &self,
        [a, b]: [&ConvexShape; 2],
        [frame_a, frame_b]: [&Frame; 2],
        cache: &PairCache,
        scratch: &mut Scratch,
    ) -> VectorArea {
        let Some(near) = cache.near.as_deref() else {
            return VectorArea::default();
        };
        let rotation = frame_a.rotation.tr_mul(&frame_b.rotation);
        let between = frame_b.position - frame_a.position;
        let offset = frame_a.rotation.tr_mul(&between);
        let mut sums = [[Vector3::zeros(); 2]; 2];
        for_sides(
            a,
            b,
            &rotation,
            &offset,
            near,
            scratch,
            |k, skin, planes, side| {
                sums[k] = of_skin(skin, planes, &mut side.clipper);
            },
        );
        // Both skins have the same vector area, up to sign and round-off.
        let [on_b, on_a] = sums;
        let mean = [0, 1].map(|k| (rotation * on_b[k] - on_a[k]) * 0.5);
        let arm = frame_a.rotation * near.region.centre - between;
        VectorArea::of_sums(&frame_a.rotation, &arm, mean)
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
        contents: &Contents,
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
        let spread =
            (on_a.pressure_second + on_b.pressure_second) / pressure - centre.norm_squared();
        let foundation = FoundationSums {
            total: p * (on_a.stiffness + on_b.stiffness),
            first: (on_a.stiffness_moment + rotation * on_b.stiffness_moment) * p,
            second: (on_a.stiffness_second
                + rotation * on_b.stiffness_second * rotation.transpose())
                * p,
        };
        let foundation = Foundation::new(&foundation, &na, &centre);
        let normal = to_world * na;
        let overlap = Overlap {
            force: normal * magnitude,
            moment: to_world * (torque - centre.cross(&force)),
            arm_a,
            arm_b: arm_a - between,
            normal,
            energy: p * contents.energy,
            volume: contents.volume,
            area: (0.5 * (na.dot(&on_a.vector_area) - nb.dot(&on_b.vector_area))).max(0.0),
            torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
            foundation: foundation.rotated(to_world),
        };
        Some((overlap, na))
    }
}

/// Bodies are alike in size if the ratio of their volumes is above this.
const ALIKE: f64 = 0.1;

/// Integrals over the overlap.
#[derive(Debug, Clone, Copy)]
struct Contents {
    /// Of phi_A + phi_B, m^3.
    energy: f64,
    /// m^3.
    volume: f64,
}

impl Contents {
    /// From the sums of both sides; B is posed by `rotation`, `offset` in A's axes.
    fn new(
        a: &ConvexShape,
        b: &ConvexShape,
        rotation: &Matrix3,
        offset: &Vector3,
        [on_b, on_a]: &[SideSums; 2],
    ) -> Self {
        let a_inside = b.holds(&-rotation.tr_mul(offset));
        let b_inside = a.holds(offset);
        let volumes = [
            on_b.volume + if a_inside { a.volume() } else { 0.0 },
            on_a.volume + if b_inside { b.volume() } else { 0.0 },
        ];
        // Both are right; that of the smaller body has more digits if its centre is not close to the other's skin.
        let smaller = usize::from(b.volume() < a.volume());
        let alike = a.volume().min(b.volume()) > ALIKE * a.volume().max(b.volume());
        let outside = !(a_inside || b_inside || on_a.singular || on_b.singular);
        let volume = if outside && alike {
            0.5 * (volumes[0] + volumes[1])
        } else if ![on_b.singular, on_a.singular][smaller] {
            volumes[smaller]
        } else if smaller == 0 {
            let inverse = rotation.transpose();
            volume_within(a, &inverse, &-(inverse * offset), b)
        } else {
            volume_within(b, rotation, offset, a)
        };
        let integral = |side: &SideSums, inside: bool| {
            // Near its centre and beyond, the field is better integrated by div ((x - c) phi) = 4 phi - 1; for a slight
            // overlap that would be a difference of large numbers.
            let deep = inside || side.singular || side.energy > 0.25 * volume;
            if deep {
                0.25 * (volume + side.lever)
            } else {
                side.energy
            }
        };
        let energy = integral(on_b, a_inside) + integral(on_a, b_inside);
        Self {
            energy: energy.max(0.0),
            volume: volume.max(0.0),
        }
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
    scratch.side.fast.trail.begin();
    let mut sums = [SideSums::default(); 2];
    for_sides(
        a,
        b,
        rotation,
        offset,
        near,
        scratch,
        |k, skin, planes, side| {
            integrate_side(skin, planes, &mut sums[k], side);
        },
    );
    sums
}

/// Calls `see` with the skin of B in A's field and the posed planes of that, as side 0, and with the skin of A in B's field.
#[inline(always)]
fn for_sides(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    near: &Near,
    scratch: &mut Scratch,
    mut see: impl FnMut(usize, &Skin, &mut Vec<FieldPlane>, &mut SideScratch),
) {
    let Scratch { side, planes, .. } = scratch;
    let pose = Pose::new(rotation, offset);
    let region = near.region.open();
    let skin_b = Skin {
        shape: b,
        plan: &near.on_b,
        field_centre: pose.a_in_b,
        close: CLOSE * a.inradius(),
        origin: pose.inverse * region.centre + pose.a_in_b,
        region: Region::Posed(&region, &pose),
    };
    pose_planes(a, &near.on_b.planes, &pose.inverse, &pose.a_in_b, planes);
    see(0, &skin_b, planes, side);
    let skin_a = Skin {
        shape: a,
        plan: &near.on_a,
        field_centre: *offset,
        close: CLOSE * b.inradius(),
        origin: region.centre,
        region: Region::Here(&region),
    };
    pose_planes(b, &near.on_a.planes, rotation, offset, planes);
    see(1, &skin_a, planes, side);
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
        let before = self.near.take();
        if clear <= 0.25 * margin {
            self.near = find_near(a, b, rotation, offset, &self.axis, margin, scratch);
            if let Some(near) = &mut self.near {
                near.trail = before.map(|near| near.trail).unwrap_or_default();
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
            trail: Trail::default(),
        })
    })
}
