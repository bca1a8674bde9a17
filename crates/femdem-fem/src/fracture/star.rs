//! The tetrahedra around a node, and how a plane divides them.

use super::minimum_cut::{Edge, minimum_cut};
use crate::error::{FemError, check};
use crate::model::ElementStress;
use femdem_mesh::Vector3;
use femdem_mesh::nalgebra::Unit;
use femdem_mesh::tet::{CrackedMesh, FACES};

/// Distance from the plane, over the local size, beyond which a tetrahedron belongs to its side; at most half of the
/// farthest in the star, since all may be flat.
const FREE: f64 = 0.35;

/// How much dearer than one in the plane a facet across it is, over its area.
const TURNED: f64 = 1.5;

/// Volume of a tetrahedron, m^3.
pub(super) fn volume(corners: [u32; 4], positions: &[Vector3]) -> Result<f64, FemError> {
    let [a, b, c, d] = corners.map(|node| positions[node as usize]);
    let volume = (b - a).dot(&(c - a).cross(&(d - a))) / 6.0;
    let allowed = "positive: the body has turned a tetrahedron inside out";
    check("volume of a tetrahedron", volume, volume > 0.0, allowed)?;
    Ok(volume)
}

/// Whether a facet with a node, open or not, is cut.
pub(super) fn is_on_cut(cracked: &CrackedMesh, node: u32) -> bool {
    cracked.around(node).iter().any(|&t| {
        let corners = cracked.tets()[t as usize];
        let facets = cracked.facets().of_tets()[t as usize];
        let mut faces = corners.iter().zip(facets);
        faces.any(|(across, facet)| {
            *across != node && facet.is_some_and(|facet| cracked.is_cut()[facet as usize])
        })
    })
}

/// A facet with the node, between two of its tetrahedra.
struct Link {
    facet: u32,
    /// The two, by their places in the star.
    ends: [usize; 2],
    area: f64,
    normal: Vector3,
    is_cut: bool,
}

/// The tetrahedra around a node.
pub(super) struct Star {
    links: Vec<Link>,
    /// Centroids seen from the node, over the local size.
    centroids: Vec<Vector3>,
    /// Per tetrahedron its volume, m^3, and the nodal force of its stress, V sigma grad N = - sigma A n / 3 with the face across
    /// from the node, N.
    forces: Vec<(f64, Vector3)>,
}

/// The facets to cut to divide a star.
pub(super) struct Division {
    pub cost: f64,
    pub facets: Vec<u32>,
    /// The normal of the mean plane of all facets between the two sides.
    pub normal: Vector3,
    /// What pulls across that plane and shears along it at least, Pa: the force R between the two halves of the star over the node's
    /// part of the facets, Σ A n / 3, with n out of the first; under a uniform stress and with free skins R = σ Σ A n / 3.
    ///
    /// Halves with volumes V and nodal forces F of stress move alike if R = (V₂ F₁ − V₁ F₂)/(V₁ + V₂). Their sum F₁ + F₂ is motion, or
    /// balanced by other bodies, glue or supports, on one half or on both: R may be wrong by that sum times the larger part of V,
    /// which is taken off.
    pub traction: [f64; 2],
}

impl Star {
    /// The star of a node in the current positions.
    pub(super) fn new(
        cracked: &CrackedMesh,
        node: u32,
        positions: &[Vector3],
        stresses: &[ElementStress],
    ) -> Result<Self, FemError> {
        let tets = cracked.around(node);
        let at = |i: u32| positions[i as usize];
        let mut star = Self {
            links: Vec::new(),
            centroids: Vec::new(),
            forces: Vec::new(),
        };
        let mut total = 0.0;
        for (place, &t) in tets.iter().enumerate() {
            let corners = cracked.tets()[t as usize];
            let own = volume(corners, positions)?;
            total += own;
            star.centroids
                .push(corners.map(at).iter().sum::<Vector3>() / 4.0 - at(node));
            let facets = cracked.facets().of_tets()[t as usize];
            for (k, facet) in facets.into_iter().enumerate() {
                if corners[k] == node {
                    let [a, b, c] = FACES[k].map(|i| at(corners[i]));
                    let opposite = (b - a).cross(&(c - a)) * 0.5;
                    let force = stresses[t as usize].cauchy * opposite / -3.0;
                    star.forces.push((own, force));
                }
                let Some(facet) = facet.filter(|_| corners[k] != node) else {
                    continue;
                };
                let is_cut = cracked.is_cut()[facet as usize];
                let [first, second] = cracked.facets().all()[facet as usize].tets;
                // Each link once, from its first tetrahedron.
                let other = tets.binary_search(&second).ok().filter(|_| first == t);
                let Some(other) = other else { continue };
                let [a, b, c] = FACES[k].map(|i| at(corners[i]));
                let across = (b - a).cross(&(c - a)) * 0.5;
                let area = across.norm();
                star.links.push(Link {
                    facet,
                    ends: [place, other],
                    area,
                    normal: across / area,
                    is_cut,
                });
            }
        }
        let size = (6.0 * total / tets.len() as f64).cbrt();
        star.centroids.iter_mut().for_each(|c| *c /= size);
        Ok(star)
    }

    /// The cheapest division along a plane through the node; `None` if no tetrahedron is on one side of it, or none
    /// clearly and the division is not forced. A forced one takes the farthest on a side for clear.
    pub(super) fn divide(&self, normal: &Vector3, is_forced: bool) -> Option<Division> {
        let heights: Vec<f64> = self.centroids.iter().map(|c| c.dot(normal)).collect();
        let highest = heights.iter().copied().fold(0.0, f64::max);
        let lowest = heights.iter().copied().fold(0.0, f64::min);
        let free = FREE.min(0.5 * highest.max(-lowest));
        if highest.min(-lowest) <= if is_forced { 0.0 } else { free } {
            return None;
        }
        let (above, below) = (highest.min(free), lowest.max(-free));
        let side = |&height: &f64| match height {
            z if z >= above => Some(true),
            z if z <= below => Some(false),
            _ => None,
        };
        let sides: Vec<_> = heights.iter().map(side).collect();
        let edge = |link: &Link| Edge {
            ends: link.ends,
            cost: if link.is_cut {
                0.0
            } else {
                link.area * (1.0 + TURNED * (1.0 - link.normal.dot(normal).abs()))
            },
        };
        let edges: Vec<Edge> = self.links.iter().map(edge).collect();
        let parts = minimum_cut(&sides, &edges);
        let between = self.links.iter().zip(&edges);
        let between = between.filter(|(link, _)| parts[link.ends[0]] != parts[link.ends[1]]);
        let between: Vec<(&Link, &Edge)> = between.collect();
        let area = area_between(between.iter().map(|(link, _)| *link), &parts);
        let mut halves = [(0.0, Vector3::zeros()); 2];
        for ((volume, force), part) in self.forces.iter().zip(&parts) {
            let half = &mut halves[usize::from(*part)];
            half.0 += volume;
            half.1 += force;
        }
        let [(second, pushed), (first, pulled)] = halves;
        let exchanged = (pulled * second - pushed * first) / (first + second);
        let unknown = (pulled + pushed).norm() * first.max(second) / (first + second);
        let mut division = Division {
            cost: 0.0,
            facets: Vec::new(),
            normal: *normal,
            traction: [0.0; 2],
        };
        if let Some((normal, size)) = Unit::try_new_and_get(area, 0.0) {
            division.normal = normal.into_inner();
            let pull = exchanged.dot(&normal);
            let shear = (exchanged - division.normal * pull).norm();
            division.traction = [pull, shear].map(|force| (force - unknown) * 3.0 / size);
        }
        for (link, edge) in between {
            division.cost += edge.cost;
            if !link.is_cut {
                division.facets.push(link.facet);
            }
        }
        Some(division)
    }
}

/// The area of the facets between two sides, Σ A n out of the first, m^2: it is that of any surface with the same rim.
fn area_between<'a>(between: impl Iterator<Item = &'a Link>, parts: &[bool]) -> Vector3 {
    let outward = |link: &Link| {
        let area = link.normal * link.area;
        if parts[link.ends[0]] { area } else { -area }
    };
    between.map(outward).sum()
}
