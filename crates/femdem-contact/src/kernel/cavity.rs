//! Contact of a convex body with a rigid wall.
//!
//! The wall has no field of its own: U = p_w int phi_B dV over the part of B outside the
//! free space, with p_w = 2 p, so that a face lying on a wall is as stiff as on an equal
//! face. The force is p_w sum_k n_k int phi_B dS over the wall planes inside B.

use super::candidates::{Candidates, ContactBox, candidates};
use super::cells::PlaneSums;
use super::clip::{Clipper, Cut, Line, Point};
use super::deep::{Inner, volume_behind};
use super::field::{CLOSE, PlaneField, cut_by_field};
use super::overlap::Overlap;
use super::pair::Scratch;
use super::plan::{MOST_PLANES, Margins, Place, PlanScratch, Reach, below};
use super::plane::FieldPlane;
use super::polygon::TooMany;
use super::side::SideScratch;
use super::skin::{Lever, SideSums};
use super::touching::add_polygon;
use super::trail::Trail;
use crate::adhesion::VectorArea;
use crate::axes::complete;
use crate::error::{ContactError, check_pressure};
use crate::foundation::{Foundation, FoundationSums};
use crate::shape::{ConvexShape, Frame, PlaneFrame};
use crate::walls::Wall;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// Wall penalty over body penalty.
pub(crate) const WALL_FACTOR: f64 = 2.0;

/// Lists stay valid while the relative motion is below this fraction of twice the inradius.
const MARGIN: f64 = 0.01;

/// The penalty law between a convex body and a wall.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CavityKernel {
    #[serde(deserialize_with = "crate::error::read_penalty")]
    penalty: f64,
}

/// The cache of a body and a wall; see [`PairCache`](super::PairCache).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CavityCache {
    until: f64,
    near: Option<Box<Near>>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Near {
    /// Wall planes within reach, the deepest first.
    planes: SmallVec<[WallPlan; 2]>,
    /// Centre of the box of what the planes can meet, in the body's axes, and half its diagonal.
    centre: Vector3,
    reach: f64,
    body: Candidates,
    trail: Trail,
}

/// A wall plane, and as bits the body's planes that can matter on it; no bits if there are too many planes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct WallPlan {
    plane: u16,
    /// The body cannot cross the plane within the margin.
    outside: bool,
    reach: Reach,
}

/// A wall plane in the body's axes: the free side is {normal.y + distance >= 0}.
#[derive(Debug, Clone, Copy)]
struct PosedPlane {
    normal: Vector3,
    /// Signed distance of the body's centroid from the plane, m.
    distance: f64,
}

impl WallPlan {
    fn new(plane: u16, place: &Place, margin: f64, scratch: &mut PlanScratch) -> Self {
        let margins = Margins {
            field: margin,
            region: 0.0,
        };
        let bits = place.posed.len() <= MOST_PLANES;
        let found = bits.then(|| place.plan(None, margins, scratch)).flatten();
        Self {
            plane,
            outside: bits && found.is_none(),
            reach: found.unwrap_or_default(),
        }
    }
}

impl PosedPlane {
    /// Coordinates in the plane about the foot of the region's centre.
    fn frame(&self, centre: &Vector3) -> PlaneFrame {
        let height = self.normal.dot(centre) + self.distance;
        PlaneFrame::new(centre - self.normal * height, &self.normal)
    }

    /// The free side on the plane of a polygon.
    fn free_side(&self, frame: &PlaneFrame) -> Line {
        Line {
            a: -self.normal.dot(&frame.e1),
            b: -self.normal.dot(&frame.e2),
            c: self.distance + self.normal.dot(&frame.origin),
        }
    }
}

/// The wall's planes in the axes of the body.
struct View<'a> {
    wall: &'a Wall,
    /// From wall axes to body axes.
    rotation: Matrix3,
    /// Position of the body's centroid in the wall's axes.
    centre: Vector3,
}

impl View<'_> {
    fn plane(&self, k: usize) -> PosedPlane {
        let p = &self.wall.planes()[k];
        PosedPlane {
            normal: self.rotation * p.normal,
            distance: p.normal.dot(&self.centre) - p.offset,
        }
    }
}

impl CavityKernel {
    /// A kernel for bodies with penalty `p` in Pa among themselves.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is between 1e-100 and 1e100 Pa.
    pub fn new(penalty: f64) -> Result<Self, ContactError> {
        check_pressure("penalty", penalty)?;
        Ok(Self::of(penalty))
    }

    /// With a penalty that was checked.
    pub(crate) fn of(penalty: f64) -> Self {
        Self { penalty }
    }

    /// The contact of a wall (A) with a body (B). `None` if they do not overlap, or if there is no net force
    /// (the body wholly inside the wall).
    pub fn evaluate(
        &self,
        wall: &Wall,
        frame_wall: &Frame,
        body: &ConvexShape,
        frame_body: &Frame,
        scratch: &mut Scratch,
    ) -> Option<Overlap> {
        let mut cache = CavityCache::default();
        self.evaluate_cached(wall, frame_wall, body, frame_body, &mut cache, 0.0, scratch)
    }

    /// As [`evaluate`](Self::evaluate), with a cache and the motion bound of
    /// [`PairKernel::evaluate_cached`](super::PairKernel::evaluate_cached).
    #[expect(
        clippy::too_many_arguments,
        reason = "two bodies, each shape and frame"
    )]
    pub fn evaluate_cached(
        &self,
        wall: &Wall,
        frame_wall: &Frame,
        body: &ConvexShape,
        frame_body: &Frame,
        cache: &mut CavityCache,
        motion: f64,
        scratch: &mut Scratch,
    ) -> Option<Overlap> {
        let expired = motion >= cache.until;
        if cache.near.is_none() && !expired {
            return None;
        }
        let between = frame_body.position - frame_wall.position;
        let view = View {
            wall,
            rotation: frame_body.rotation.tr_mul(&frame_wall.rotation),
            centre: frame_wall.rotation.tr_mul(&between),
        };
        if expired {
            cache.renew(&view, body, motion, scratch);
        }
        let near = cache.near.as_deref_mut()?;
        std::mem::swap(&mut near.trail, &mut scratch.side.fast.trail);
        let sums = sections(&view, body, near, scratch);
        std::mem::swap(&mut near.trail, &mut scratch.side.fast.trail);
        near.trail.begin();
        self.assemble(&sums, near, &between, &frame_body.rotation)
    }

    /// The vector area of the body's skin in the wall where [`evaluate_cached`](Self::evaluate_cached) has just found a contact
    /// with this cache; none where it has found none.
    pub fn vector_area(
        &self,
        wall: &Wall,
        body: &ConvexShape,
        [frame_wall, frame_body]: [&Frame; 2],
        cache: &CavityCache,
        scratch: &mut Scratch,
    ) -> VectorArea {
        let Some(near) = cache.near.as_deref() else {
            return VectorArea::default();
        };
        let between = frame_body.position - frame_wall.position;
        let view = View {
            wall,
            rotation: frame_body.rotation.tr_mul(&frame_wall.rotation),
            centre: frame_wall.rotation.tr_mul(&between),
        };
        own_planes(body, &near.body, &mut scratch.planes);
        let planes = near.planes.iter();
        let planes: SmallVec<[PosedPlane; 4]> =
            planes.map(|p| view.plane(usize::from(p.plane))).collect();
        let bounding = usize::from(near.body.bounding);
        let mut of_wall = [Vector3::zeros(); 2];
        let mut field = PlaneField::new(&scratch.planes);
        let clipper = &mut scratch.side.clipper;
        for (k, plane) in planes.iter().enumerate() {
            let frame = plane.frame(&near.centre);
            clipper.load(&square(2.0 * near.reach));
            field.place(&frame);
            let mut others = planes.iter().enumerate().filter(|(j, _)| *j != k);
            if cut_by_field(clipper, &field, bounding)
                && others.all(|(_, other)| clipper.cut(&other.free_side(&frame)) != Cut::Empty)
            {
                let polygon = clipper.polygon();
                add_polygon(&mut of_wall, polygon, &frame, &plane.normal, &near.centre);
            }
        }
        let arm = frame_body.rotation * near.centre;
        VectorArea::of_sums(&frame_body.rotation, &arm, of_wall.map(|x| -x))
    }

    fn assemble(
        &self,
        sums: &SideSums,
        near: &Near,
        between: &Vector3,
        rotation: &Matrix3,
    ) -> Option<Overlap> {
        let p = WALL_FACTOR * self.penalty;
        let force = sums.force * p;
        let magnitude = force.norm();
        if !(sums.pressure > 0.0 && magnitude > 0.0) {
            return None;
        }
        let normal = force / magnitude;
        let centre = sums.pressure_moment / sums.pressure;
        let arm_b = rotation * (near.centre + centre);
        let spread = sums.pressure_second / sums.pressure - centre.norm_squared();
        let foundation = FoundationSums {
            total: p * sums.stiffness,
            first: sums.stiffness_moment * p,
            second: sums.stiffness_second * p,
        };
        let foundation = Foundation::new(&foundation, &normal, &centre);
        Some(Overlap {
            force: rotation * force,
            moment: rotation * (sums.torque * p - centre.cross(&force)),
            arm_a: arm_b + between,
            arm_b,
            normal: rotation * normal,
            energy: (p * sums.energy).max(0.0),
            volume: sums.volume.max(0.0),
            area: normal.dot(&sums.vector_area).max(0.0),
            torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
            foundation: foundation.rotated(rotation),
        })
    }
}

/// Integrals over the wall planes inside the body, in the body's axes about the region's centre.
fn sections(view: &View, body: &ConvexShape, near: &Near, scratch: &mut Scratch) -> SideSums {
    let mut sums = SideSums::default();
    scratch.side.fast.trail.begin();
    own_planes(body, &near.body, &mut scratch.planes);
    let planes: SmallVec<[PosedPlane; 4]> = near
        .planes
        .iter()
        .map(|p| view.plane(usize::from(p.plane)))
        .collect();
    let bounding = usize::from(near.body.bounding);
    for (k, plane) in planes.iter().enumerate() {
        let normal = &plane.normal;
        let frame = plane.frame(&near.centre);
        let lever = Lever {
            distance: normal.dot(&frame.origin),
            close: CLOSE * body.inradius(),
        };
        let section = Section {
            frame,
            lever,
            plane,
            others: &planes,
            number: k,
            near,
        };
        let (field, side) = (&scratch.planes, &mut scratch.side);
        if section.add_fast(field, side, &mut sums).is_err() {
            section.add_general(field, bounding, side, &mut sums);
        }
    }
    // What the centre of the field adds if it lies in the wall.
    if planes.iter().any(|plane| plane.distance < 0.0) {
        sums.volume += body.volume();
        sums.energy += 0.25 * body.volume();
    }
    if sums.singular {
        let frames: SmallVec<[_; 4]> = planes.iter().map(|p| p.frame(&near.centre)).collect();
        sums.volume = behind_planes(body, &planes, &frames, near.reach);
        // div ((x - c) phi) = 4 phi - 1, also at the centre.
        sums.energy = 0.25 * (sums.volume + sums.lever);
    }
    sums
}

/// Volume of the part of the body in the wall, m^3, where a plane passes close to the centre of the body's field.
fn behind_planes(
    body: &ConvexShape,
    planes: &[PosedPlane],
    frames: &[PlaneFrame],
    reach: f64,
) -> f64 {
    let mut clipper = Clipper::default();
    let mut polygons: SmallVec<[Vec<Point>; 4]> = SmallVec::new();
    for (k, frame) in frames.iter().enumerate() {
        clipper.load(&square(2.0 * reach));
        let others = planes.iter().enumerate().filter(|(j, _)| *j != k);
        let mut lines = others.map(|(_, plane)| plane.free_side(frame));
        let some = lines.all(|line| clipper.cut(&line) != Cut::Empty);
        polygons.push(if some {
            clipper.polygon().to_vec()
        } else {
            Vec::new()
        });
    }
    let faces = polygons.iter().zip(frames).zip(planes);
    let faces = faces.map(|((polygon, frame), plane)| (&polygon[..], *frame, plane.normal));
    let here = (Matrix3::identity(), Vector3::zeros());
    volume_behind(body, &here.0, &here.1, Inner::Any, faces)
}

/// The planes of the body's field, in its own axes.
fn own_planes(body: &ConvexShape, list: &Candidates, out: &mut Vec<FieldPlane>) {
    out.clear();
    out.extend(list.planes.iter().map(|&k| FieldPlane {
        gradient: body.planes[usize::from(k)].gauge,
        level: 1.0,
    }));
}

/// One wall plane across the body.
struct Section<'a> {
    frame: PlaneFrame,
    lever: Lever,
    plane: &'a PosedPlane,
    others: &'a [PosedPlane],
    number: usize,
    near: &'a Near,
}

impl Section<'_> {
    /// The free sides of the other planes of the wall.
    fn free_sides(&self) -> impl Iterator<Item = Line> {
        let others = self.others.iter().enumerate();
        let others = others.filter(|(j, _)| *j != self.number);
        others.map(|(_, p)| p.free_side(&self.frame))
    }

    fn corners(&self) -> [Point; 4] {
        square(2.0 * self.near.reach)
    }

    fn add_fast(
        &self,
        field: &[FieldPlane],
        side: &mut SideScratch,
        sums: &mut SideSums,
    ) -> Result<(), TooMany> {
        let plan = self.near.planes[self.number];
        if plan.reach.own == 0 {
            return if plan.outside { Ok(()) } else { Err(TooMany) };
        }
        let fast = &mut side.fast;
        let frame = &self.frame;
        if fast.cut_corners(&self.corners(), frame, field, plan.reach.cut)? == Cut::Empty {
            return Ok(());
        }
        for line in self.free_sides() {
            if fast.cut(&line)? == Cut::Empty {
                return Ok(());
            }
        }
        let normal = &self.plane.normal;
        let from = self.near.centre - frame.origin;
        let origin = frame.point(&self.near.centre);
        fast.place(frame, field, &plan.reach);
        let mut q = PlaneSums::default();
        fast.sum_cells(&plan.reach, field, normal, &origin, &mut q)?;
        sums.add_sums(&q, frame, normal, -from.dot(normal), self.lever);
        Ok(())
    }

    /// As [`add_fast`](Self::add_fast), for any number of planes and corners.
    fn add_general(
        &self,
        field: &[FieldPlane],
        bounding: usize,
        side: &mut SideScratch,
        sums: &mut SideSums,
    ) {
        let mut field = PlaneField::new(field);
        side.clipper.load(&self.corners());
        field.place(&self.frame);
        if cut_by_field(&mut side.clipper, &field, bounding)
            && self
                .free_sides()
                .all(|line| side.clipper.cut(&line) != Cut::Empty)
        {
            let origin = &self.near.centre;
            let normal = &self.plane.normal;
            sums.add_polygon(&self.frame, normal, self.lever, &mut field, origin, side);
        }
    }
}

/// A square of half-width `size` about the origin, counter-clockwise.
fn square(size: f64) -> [Point; 4] {
    [(-size, -size), (size, -size), (size, size), (-size, size)].map(|(x, y)| Point { x, y })
}

impl CavityCache {
    /// Whether the planes and facets that it names are those of a wall and a body.
    pub(crate) fn fits(&self, wall: &Wall, body: &ConvexShape) -> bool {
        self.near.as_deref().is_none_or(|near| {
            let planes = wall.planes().len();
            near.planes.iter().all(|p| usize::from(p.plane) < planes)
                && below(&near.body.planes, body.planes.len())
        })
    }

    /// Whether the cache alone shows that the pair is apart at this `motion`.
    pub fn is_clear(&self, motion: f64) -> bool {
        self.near.is_none() && motion < self.until
    }

    fn renew(&mut self, view: &View, body: &ConvexShape, motion: f64, scratch: &mut Scratch) {
        let margin = 2.0 * MARGIN * body.inradius();
        let mut clear = f64::INFINITY;
        let mut reach: SmallVec<[(f64, u16); 8]> = SmallVec::new();
        for k in 0..view.wall.planes().len() {
            let plane = view.plane(k);
            let mut gap = plane.distance - body.radius();
            if gap <= margin {
                gap = plane.distance - body.support(&-plane.normal);
                if gap <= margin {
                    reach.push((gap, k as u16));
                }
            }
            clear = clear.min(gap);
        }
        let before = self.near.take();
        if clear > 0.25 * margin {
            self.until = motion + clear;
            return;
        }
        reach.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let planes: SmallVec<[u16; 4]> = reach.iter().map(|r| r.1).collect();
        self.near = region(view, body, &planes, margin).and_then(|region| {
            let towards = -region.axes[0];
            let mut list = candidates(body, &region, 0.0, &towards)?;
            // The wall's planes are cut; the body's skin is not.
            list.facets.clear();
            own_planes(body, &list, &mut scratch.planes);
            let plan = |&k: &u16| {
                let posed = view.plane(usize::from(k));
                let place = Place {
                    corners: &square(2.0 * region.half.norm()),
                    frame: &posed.frame(&region.centre),
                    posed: &scratch.planes,
                    bounding: usize::from(list.bounding),
                };
                WallPlan::new(k, &place, margin, &mut scratch.plan)
            };
            Some(Box::new(Near {
                planes: planes.iter().map(plan).collect(),
                centre: region.centre,
                reach: region.half.norm(),
                body: list,
                trail: before.map(|near| near.trail).unwrap_or_default(),
            }))
        });
        self.until = motion + margin;
    }
}

/// The box, in the body's axes, of all parts of the body within `margin` of the planes.
fn region(view: &View, body: &ConvexShape, planes: &[u16], margin: f64) -> Option<ContactBox> {
    let axes = complete(&view.plane(usize::from(*planes.first()?)).normal);
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    let mut take = |x: &Vector3| {
        let c = Vector3::new(axes[0].dot(x), axes[1].dot(x), axes[2].dot(x));
        low = low.inf(&c);
        high = high.sup(&c);
    };
    for &k in planes {
        let plane = view.plane(usize::from(k));
        let depth = |x: &Vector3| margin - plane.distance - plane.normal.dot(x);
        body.vertices()
            .iter()
            .filter(|x| depth(x) >= 0.0)
            .for_each(&mut take);
        for edge in &body.edges {
            let [x, y] = edge.map(|v| body.vertices()[usize::from(v)]);
            let (dx, dy) = (depth(&x), depth(&y));
            if (dx >= 0.0) != (dy >= 0.0) {
                take(&(x + (y - x) * (dx / (dx - dy))));
            }
        }
    }
    let half = (high - low) * 0.5 + Vector3::repeat(1e-3 * margin);
    let mid = (high + low) * 0.5;
    (half.min() > 0.0).then(|| ContactBox {
        axes,
        centre: axes[0] * mid[0] + axes[1] * mid[1] + axes[2] * mid[2],
        half,
    })
}
