//! One side of a contact: the skin of one body inside the pressure field of the other.

use super::candidates::{Candidates, ContactBox};
use super::clip::{Clipper, Cut, HalfSpace, area_moment, integrate};
use crate::shape::{ConvexShape, Plane};
use femdem_mesh::{Matrix3, Vector3};

/// A plane of the field body in the skin body's axes: phi = depth * scale.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FieldPlane {
    pub half_space: HalfSpace,
    pub scale: f64,
    /// Outward unit normal.
    pub normal: Vector3,
}

/// Integrals over the skin inside the field, in the skin body's axes about an origin,
/// for unit penalty.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SideSums {
    /// Sum of n int phi dS.
    pub force: Vector3,
    /// Sum of int phi x dS cross n.
    pub torque: Vector3,
    /// Sum of int phi dS, int x phi dS, int |x|^2 phi dS.
    pub pressure: f64,
    pub pressure_moment: Vector3,
    pub pressure_second: f64,
    /// Minus the trace of the contact Hessian, and its first and second moments.
    pub stiffness: f64,
    pub stiffness_moment: Vector3,
    pub stiffness_second: f64,
    /// Sum of n int dS: the vector area of the skin inside the field.
    pub vector_area: Vector3,
    /// Sum of s int phi dS with s the distance of the facet's plane from the field's centre.
    pub lever: f64,
    /// Sum of n (x) int x dS: the volume is u.T u for any unit u.
    pub volume_tensor: Matrix3,
}

/// Buffers of the side loop.
#[derive(Debug, Default)]
pub(crate) struct SideScratch {
    pub clipper: Clipper,
    cell: Clipper,
    values: Vec<f64>,
    lowest: Vec<f64>,
}

/// Planes of the field body expressed in the skin body's axes. The field body is posed
/// by `rotation`, `offset` in those axes.
pub(crate) fn pose_planes(
    field: &ConvexShape,
    list: &Candidates,
    rotation: &Matrix3,
    offset: &Vector3,
    out: &mut Vec<FieldPlane>,
) {
    out.clear();
    out.extend(list.planes.iter().map(|&k| {
        let Plane {
            normal,
            offset: distance,
        } = field.planes[usize::from(k)];
        let normal = rotation * normal;
        FieldPlane {
            half_space: HalfSpace {
                normal,
                offset: distance + normal.dot(offset),
            },
            scale: 1.0 / distance,
            normal,
        }
    }));
}

/// The box as half-spaces, so that nothing outside it is integrated.
pub(crate) fn box_planes(region: &ContactBox) -> [HalfSpace; 6] {
    let plane = |k: usize, sign: f64| {
        let normal = region.axes[k] * sign;
        HalfSpace {
            normal,
            offset: normal.dot(&region.centre) + region.half[k],
        }
    };
    [
        plane(1, 1.0),
        plane(1, -1.0),
        plane(2, 1.0),
        plane(2, -1.0),
        plane(0, 1.0),
        plane(0, -1.0),
    ]
}

/// Adds up the facets of `skin` inside the field.
pub(crate) fn integrate_side(
    skin: &ConvexShape,
    facets: &[u16],
    field: &[FieldPlane],
    field_centre: &Vector3,
    bounds: &[HalfSpace; 6],
    origin: &Vector3,
    scratch: &mut SideScratch,
) -> SideSums {
    let mut sums = SideSums::default();
    let Some((first, rest)) = field.split_first() else {
        return sums;
    };
    for &i in facets {
        let facet = &skin.facets[usize::from(i)];
        let clipper = &mut scratch.clipper;
        if clipper.load_cut(skin.polygon(facet), &first.half_space) == Cut::Empty
            || !clipper.cut_all(rest.iter().map(|p| &p.half_space))
            || !clipper.cut_all(bounds)
        {
            continue;
        }
        let plane = &skin.planes[usize::from(facet.plane)];
        let section = Section {
            normal: plane.normal,
            lever: plane.offset - plane.normal.dot(field_centre),
        };
        add_by_cells(&section, field, origin, scratch, &mut sums);
    }
    sums
}

/// A plane polygon in a pressure field: unit normal, and distance of its plane from the
/// field's centre.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section {
    pub normal: Vector3,
    pub lever: f64,
}

impl SideSums {
    /// Adds a polygon that lies in one gauge cell.
    pub fn add(
        &mut self,
        polygon: &[Vector3],
        section: &Section,
        cell: &FieldPlane,
        origin: &Vector3,
    ) {
        let n = section.normal;
        let q = integrate(polygon, &n, origin, &cell.half_space, cell.scale);
        self.force += n * q.pressure;
        self.torque += q.pressure_moment.cross(&n);
        self.pressure += q.pressure;
        self.pressure_moment += q.pressure_moment;
        self.pressure_second += q.pressure_second;
        let w = cell.scale * (-n.dot(&cell.normal)).max(0.0);
        self.stiffness += w * q.area;
        self.stiffness_moment += q.moment * w;
        self.stiffness_second += w * q.second;
        self.vector_area += n * q.area;
        self.lever += section.lever * q.pressure;
        self.volume_tensor += n * q.moment.transpose();
    }

    /// Adds a polygon on which the field vanishes: it only closes the volume.
    pub fn add_skin(&mut self, polygon: &[Vector3], normal: &Vector3, origin: &Vector3) {
        let (area_moment, _) = area_moment(polygon, normal, origin);
        self.volume_tensor += normal * area_moment.transpose();
    }
}

/// Splits the polygon in the clipper into the gauge cells it crosses and adds each piece.
pub(crate) fn add_by_cells(
    section: &Section,
    field: &[FieldPlane],
    origin: &Vector3,
    scratch: &mut SideScratch,
    sums: &mut SideSums,
) {
    let polygon = scratch.clipper.polygon();
    if let Some(k) = single_cell(polygon, field, &mut scratch.values, &mut scratch.lowest) {
        sums.add(polygon, section, &field[k], origin);
        return;
    }
    for (k, cell) in field.iter().enumerate() {
        scratch.cell.load(polygon);
        let owned = field.iter().enumerate().all(|(j, other)| {
            j == k || scratch.cell.cut(&higher_than(other, cell)) != Cut::Empty
        });
        if owned {
            sums.add(scratch.cell.polygon(), section, cell, origin);
        }
    }
}

/// The half-space where the phi of `other` is at least that of `cell`.
fn higher_than(other: &FieldPlane, cell: &FieldPlane) -> HalfSpace {
    let (o, c) = (&other.half_space, &cell.half_space);
    HalfSpace {
        normal: o.normal * other.scale - c.normal * cell.scale,
        offset: o.offset * other.scale - c.offset * cell.scale,
    }
}

/// The plane whose phi is lowest at every vertex, if there is one: then the polygon lies
/// in its cell, because the fields are linear.
#[inline]
fn single_cell(
    polygon: &[Vector3],
    field: &[FieldPlane],
    values: &mut Vec<f64>,
    lowest: &mut Vec<f64>,
) -> Option<usize> {
    /// Round-off of phi; a wrong cell within it changes nothing.
    const TIE: f64 = 1e-15;
    if field.len() == 1 {
        return Some(0);
    }
    values.clear();
    lowest.clear();
    lowest.resize(polygon.len(), f64::INFINITY);
    for p in field {
        for (x, low) in polygon.iter().zip(lowest.iter_mut()) {
            let phi = p.half_space.depth(x) * p.scale;
            *low = low.min(phi);
            values.push(phi);
        }
    }
    values
        .chunks_exact(polygon.len())
        .position(|phi| phi.iter().zip(lowest.iter()).all(|(p, l)| *p <= l + TIE))
}
