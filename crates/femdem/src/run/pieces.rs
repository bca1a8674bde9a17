//! The pieces of bodies that may break.

use std::collections::{BTreeMap, BTreeSet};

use femdem_analysis::{
    Fragment, FragmentExtent, FragmentSizes, Fragmentation, FragmentationOptions, fragmentation,
    measure_fragments,
};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_solve::{Cracks, Deformable};
use femdem_view::FragmentRow;

use super::{Member, Simulation};
use crate::Error;

/// A deformable body that may break.
pub(super) struct BreakableBody<'a> {
    /// Number among the members.
    pub member: usize,
    pub entry: &'a Member,
    /// Number of the body that broke first: its own, or that of which it is a fragment.
    pub first: u32,
    pub body: Deformable<'a>,
    pub cracks: Cracks<'a>,
}

/// What broken facets separate from the rest of a body, or all of it.
pub(super) struct Piece {
    /// Its tetrahedra.
    pub tets: Vec<u32>,
    /// Volume without loads \[m³\].
    pub volume: f64,
    /// Without the mass that scaling has added \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\], and its velocity \[m/s\].
    pub centre: Vector3,
    pub velocity: Vector3,
}

impl Simulation {
    /// The bodies that may break.
    pub(super) fn breakable_bodies(&self) -> impl Iterator<Item = BreakableBody<'_>> {
        self.deformables().filter_map(|(member, entry, body)| {
            Some(BreakableBody {
                member,
                entry,
                first: entry.of.unwrap_or(member as u32),
                cracks: body.cracks()?,
                body,
            })
        })
    }

    /// Whether there are bodies that may break.
    pub(super) fn has_breakable(&self) -> bool {
        self.has_adaptive() || self.breakable_bodies().next().is_some()
    }

    /// Number of the pieces of the bodies that may break and belong to no other rank.
    pub(super) fn piece_count(&self) -> usize {
        let bodies = self.breakable_bodies();
        let bodies = bodies.filter(|body| !self.world.is_guest(body.entry.id));
        bodies.map(|body| body.piece_count()).sum::<usize>() + self.adaptive_rigid().count()
    }

    /// The rows of `fragments.csv`, and the sizes of the pieces.
    ///
    /// # Errors
    ///
    /// [`Error::Analysis`] for a piece that cannot be measured.
    pub(super) fn fragments(&self) -> Result<(Vec<FragmentRow>, FragmentSizes), Error> {
        let (mut rows, mut all) = (Vec::new(), FragmentSizes::default());
        for body in self.breakable_bodies() {
            let pieces = body.pieces();
            let sizes = body.measure(&pieces)?;
            let measured = pieces.iter().zip(&sizes.fragments);
            rows.extend(measured.map(|(piece, size)| FragmentRow {
                body: body.first,
                volume: size.volume,
                mass: size.mass,
                sieve_size: size.sieve_size(),
                sphericity: size.sphericity,
                centre: piece.centre.into(),
                velocity: piece.velocity,
            }));
            all.fragments.extend(sizes.fragments);
        }
        for (number, member, mesh) in self.adaptive_rigid() {
            let Some(whole) = self.intact(member, mesh) else {
                continue;
            };
            let sizes = measure_fragments(&[whole.as_fragment()])?;
            rows.extend(sizes.fragments.iter().map(|size| FragmentRow {
                body: number as u32,
                volume: size.volume,
                mass: size.mass,
                sieve_size: size.sieve_size(),
                sphericity: size.sphericity,
                centre: whole.centre.into(),
                velocity: whole.velocity,
            }));
            all.fragments.extend(sizes.fragments);
        }
        Ok((rows, all))
    }

    /// The distribution of the sizes of the pieces, with the size of the bodies when they were whole if all had one; `None`
    /// without bodies that may break.
    ///
    /// # Errors
    ///
    /// [`Error::Analysis`] for a piece that cannot be measured.
    pub fn fragmentation(&self) -> Result<Option<Fragmentation>, Error> {
        let pieces = self.fragments()?.1.by_sieve();
        if pieces.is_empty() {
            return Ok(None);
        }
        // The hull of a body that broke is that of its fragments.
        let mut wholes: BTreeMap<u32, (f64, f64, Vec<Point3>)> = BTreeMap::new();
        for body in self.breakable_bodies() {
            let (volume, mass, points) = wholes.entry(body.first).or_default();
            let all = body.piece(0..body.body.model().volumes().len() as u32);
            *volume += all.volume;
            *mass += all.mass;
            points.extend(body.hull_points(&all));
        }
        for (number, member, mesh) in self.adaptive_rigid() {
            let whole = self.intact(member, mesh);
            wholes.extend(whole.map(|of| (number as u32, (of.volume, of.mass, of.points))));
        }
        let wholes: Vec<Fragment> = wholes
            .values()
            .map(|(volume, mass, points)| Fragment {
                volume: *volume,
                mass: *mass,
                area: None,
                extent: FragmentExtent::Points(points),
            })
            .collect();
        let sizes = measure_fragments(&wholes)?.fragments;
        let parents: Vec<f64> = sizes.iter().map(|size| size.sieve_size()).collect();
        let first = parents.first().copied();
        let same = |first: &f64| parents.iter().all(|size| (size / first - 1.0).abs() < SAME);
        let options = FragmentationOptions {
            parent_size: first.filter(same),
            ..FragmentationOptions::default()
        };
        Ok(Some(fragmentation(&pieces, &options)?))
    }
}

/// An adaptive body that is rigid.
struct Intact {
    volume: f64,
    mass: f64,
    area: f64,
    /// The points of its skin, in its coordinates.
    points: Vec<Point3>,
    centre: Vector3,
    velocity: Vector3,
}

impl Intact {
    fn as_fragment(&self) -> Fragment<'_> {
        Fragment {
            volume: self.volume,
            mass: self.mass,
            area: Some(self.area),
            extent: FragmentExtent::Points(&self.points),
        }
    }
}

impl Simulation {
    fn intact(&self, member: &Member, mesh: &TetMesh) -> Option<Intact> {
        let nodes = mesh.points();
        let skin = mesh.skin();
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|i| nodes[i as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        let own: BTreeSet<u32> = skin.iter().flatten().copied().collect();
        Some(Intact {
            volume: mesh.volume(),
            mass: self.world.mass(member.id)?,
            area: skin.iter().map(area).sum(),
            points: own.into_iter().map(|i| nodes[i as usize]).collect(),
            centre: self.world.position(member.id)?,
            velocity: self.world.velocity(member.id)?,
        })
    }
}

/// Sizes of bodies that differ by less are one.
const SAME: f64 = 1e-6;

impl BreakableBody<'_> {
    fn piece_count(&self) -> usize {
        let last = self.cracks.fragments().into_iter().max();
        last.map_or(1, |last| last as usize + 1)
    }

    /// Its pieces, by number.
    pub fn pieces(&self) -> Vec<Piece> {
        let of = self.cracks.fragments();
        if of.is_empty() {
            return vec![self.piece(0..self.body.model().volumes().len() as u32)];
        }
        let mut tets = vec![Vec::new(); self.piece_count()];
        for (piece, t) in of.iter().zip(0_u32..) {
            tets[*piece as usize].push(t);
        }
        tets.into_iter().map(|tets| self.piece(tets)).collect()
    }

    fn piece(&self, tets: impl IntoIterator<Item = u32>) -> Piece {
        let model = self.body.model();
        let tets: Vec<u32> = tets.into_iter().collect();
        let (mut volume, mut mass) = (0.0, 0.0);
        let (mut centre, mut velocity) = (Vector3::zeros(), Vector3::zeros());
        for &t in &tets {
            let own = model.volumes()[t as usize];
            let region = model.region_of_tet()[t as usize];
            let of_tet = own * model.regions()[region as usize].density;
            volume += own;
            mass += of_tet;
            // The mass of a linear element is in equal parts at its nodes.
            for node in model.mesh().tets()[t as usize] {
                centre += self.body.positions()[node as usize] * (0.25 * of_tet);
                velocity += self.body.velocities()[node as usize] * (0.25 * of_tet);
            }
        }
        Piece {
            tets,
            volume,
            mass,
            centre: centre / mass,
            velocity: velocity / mass,
        }
    }

    /// The points of the skin of a piece without loads.
    fn hull_points(&self, piece: &Piece) -> Vec<Point3> {
        let faces = self.skin(piece).into_iter();
        let mut points: Vec<u32> = faces
            .flat_map(|(t, k)| FACES[k].map(|i| self.point(t, i)))
            .collect();
        points.sort_unstable();
        points.dedup();
        let nodes = self.body.model().nodes();
        let place = |point: u32| Point3::from(nodes[point as usize]);
        points.into_iter().map(place).collect()
    }

    /// Measures pieces of it without loads.
    fn measure(&self, pieces: &[Piece]) -> Result<FragmentSizes, Error> {
        let nodes = self.body.model().nodes();
        let skins: Vec<(Vec<Point3>, f64)> = pieces
            .iter()
            .map(|piece| {
                let faces = self.skin(piece);
                let of_face = |&(t, k): &(u32, usize)| FACES[k].map(|i| self.point(t, i));
                let triangles: Vec<[u32; 3]> = faces.iter().map(of_face).collect();
                let area = |triangle: &[u32; 3]| {
                    let [a, b, c] = triangle.map(|point| nodes[point as usize]);
                    0.5 * (b - a).cross(&(c - a)).norm()
                };
                let area = triangles.iter().map(area).sum();
                (self.hull_points(piece), area)
            })
            .collect();
        let fragments: Vec<Fragment> = pieces
            .iter()
            .zip(&skins)
            .map(|(piece, (points, area))| Fragment {
                volume: piece.volume,
                mass: piece.mass,
                area: Some(*area),
                extent: FragmentExtent::Points(points),
            })
            .collect();
        Ok(measure_fragments(&fragments)?)
    }

    /// The point of the mesh without cracks at corner `i` of a tetrahedron: where it is without loads, the node of this number is.
    pub fn point(&self, tet: u32, i: usize) -> u32 {
        let node = self.body.model().mesh().tets()[tet as usize][i];
        let mesh = self.cracks.mesh();
        mesh.map_or(node, |mesh| mesh.points()[node as usize])
    }

    /// The tetrahedron across face `k` of another, cut or not.
    pub fn across(&self, tet: u32, k: usize) -> Option<u32> {
        let Some(mesh) = self.cracks.mesh() else {
            return self.body.model().mesh().neighbours()[tet as usize][k];
        };
        let facet = mesh.facets().of_tets()[tet as usize][k]?;
        let [a, b] = mesh.facets().all()[facet as usize].tets;
        Some(if a == tet { b } else { a })
    }

    /// The faces of a piece that are not between two of its tetrahedra, as tetrahedra and numbers in [`FACES`].
    pub fn skin(&self, piece: &Piece) -> Vec<(u32, usize)> {
        let is_own = |t: u32| piece.tets.binary_search(&t).is_ok();
        let faces = piece.tets.iter().flat_map(|&t| (0..4).map(move |k| (t, k)));
        faces
            .filter(|&(t, k)| !self.across(t, k).is_some_and(is_own))
            .collect()
    }
}
