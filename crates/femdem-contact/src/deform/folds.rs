//! Where a body may touch itself.
//!
//! Tetrahedra with the same node lie side by side, whatever the body does, as long as none of them is inverted and
//! the skin around the node does not fold over. What can overlap is therefore
//!
//! - tetrahedra without a common node, which come near each other only where two parts of the skin do, and
//! - tetrahedra all of whose common nodes are [creases](Skin::creases): nodes of the skin whose triangles do not show that
//!   it lies flat around them, such as those at the front of a crack.
//!
//! Each pair is one of a part A and a part B of the body. Which is which is the same in all of a contact, so that
//! its normals point one way: pairs with a common tetrahedron whose other tetrahedra share a face are parts of one contact.

use super::near::{Failure, Members, Near, Sides};
use super::operand::Operand;
use super::parts::orient;
use super::shape::DeformableShape;
use crate::tets::near_list::{Candidate, Search, place};
use crate::tets::posed::Posed;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};

/// Parts of the skin that are farther apart than this, over the mean edge of its triangles, are not looked at: where nothing
/// was near before, and where something was.
const REACH: [f64; 2] = [0.5, 0.05];

/// Number of evaluations at the present speed that a list should last.
const LASTS: f64 = 16.0;

/// The search for the parts of a body that may touch each other. Both sides are this body.
pub(crate) struct Folds<'a> {
    sides: &'a Sides<'a>,
    /// Pairs of tetrahedra of A and B on the last list, by the lower and the higher number, and whether A has the lower one.
    before: Vec<([u32; 2], bool)>,
}

impl<'a> Folds<'a> {
    /// `before` is the last list.
    pub fn new(sides: &'a Sides<'a>, before: Option<&Near>) -> Self {
        let mut known = Vec::new();
        if let Some(Near {
            sides: [a, b],
            pairs,
            ..
        }) = before
        {
            if let Operand::Deformable(shape, _) = sides.operands[1] {
                let whole = |i: u32| shape.parent(i).map(|(whole, _)| whole);
                known.extend(pairs.iter().filter_map(|pair| {
                    let i = whole(a.tets[pair.places[0] as usize])?;
                    let j = whole(b.tets[pair.places[1] as usize])?;
                    Some(([i.min(j), i.max(j)], i < j))
                }));
            }
            known.sort_unstable();
        }
        Self {
            sides,
            before: known,
        }
    }

    fn skin(&self) -> Option<Skin<'_>> {
        match self.sides.operands[1] {
            Operand::Deformable(shape, x) => Some(Skin { shape, x }),
            _ => None,
        }
    }

    /// Pairs of tetrahedra of the mesh, the lower number first, whose boxes come within `margin` of each other and that may overlap.
    fn pairs(&self, skin: &Skin, margin: f64) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        let creases = skin.creases(margin);
        let shape = skin.shape;
        let tree = &self.sides.trees[1];
        let mut boxes = vec![Aabb::EMPTY; shape.wholes().len()];
        let whole = |part: u32| shape.parent(part).map_or(0, |(whole, _)| whole);
        for (own, part) in tree.boxes.iter().zip(0..) {
            let of_whole = &mut boxes[whole(part) as usize];
            *of_whole = of_whole.union(own);
        }
        // For which tetrahedron each was found last: it may have several parts.
        let mut seen = vec![u32::MAX; boxes.len()];
        for (own, i) in boxes.iter().zip(0..) {
            let wide = own.grown(margin);
            let first = pairs.len();
            tree.tree.query(&wide, |part| {
                let j = whole(part);
                if j > i
                    && std::mem::replace(&mut seen[j as usize], i) != i
                    && boxes[j as usize].overlaps(&wide)
                    && shape.may_overlap([i, j], &creases)
                {
                    pairs.push([i, j]);
                }
            });
            pairs[first..].sort_unstable();
        }
        pairs
    }

    /// Those of `pairs` that are no farther apart than `margin` along the normals of their faces, with lower bounds of their
    /// distances, m.
    fn near(&self, skin: &Skin, pairs: &[[u32; 2]], margin: f64) -> Vec<([u32; 2], f64)> {
        let origin = self.sides.trees[1].tree.bounds().center().coords;
        let shape = skin.shape;
        let posed = |i: u32| shape.posed_whole(i, skin.x, &origin);
        let posed: Vec<Option<Posed>> = (0..shape.wholes().len() as u32).map(posed).collect();
        let near = |pair: &[u32; 2]| {
            let [Some(a), Some(b)] = pair.map(|i| posed[i as usize].as_ref()) else {
                return None;
            };
            let gap = shape.gap_of_wholes(*pair, [a, b], margin).max(0.0);
            (gap <= margin).then_some((*pair, gap))
        };
        pairs.iter().filter_map(near).collect()
    }

    /// The list of pairs with the tetrahedron of A first, and bounds of their distances, m.
    fn list(&self, skin: &Skin, mut pairs: Vec<([u32; 2], f64)>, motion: f64) -> Near {
        let shape = skin.shape;
        pairs.sort_unstable_by_key(|(pair, _)| *pair);
        let sides = [0, 1].map(|side| {
            let mut wholes: Vec<u32> = pairs.iter().map(|(pair, _)| pair[side]).collect();
            wholes.sort_unstable();
            wholes.dedup();
            let parts = wholes.iter().filter_map(|i| shape.child(*i));
            let all =
                parts.flat_map(|(first, is_split)| first..first + if is_split { 4 } else { 1 });
            Members::new(shape, all.collect())
        });
        let first = |side: usize, whole: u32| {
            let first = shape.child(whole).map_or(0, |(first, _)| first);
            place(&sides[side].tets, first) as u32
        };
        let candidate = |(pair, gap): &([u32; 2], f64)| Candidate {
            places: [first(0, pair[0]), first(1, pair[1])],
            clear: motion + gap,
        };
        let boxes = &self.sides.trees[1].boxes;
        let of_b = sides[1].tets.iter().map(|i| boxes[*i as usize]);
        let around = of_b.reduce(|a, b| a.union(&b)).unwrap_or(Aabb::EMPTY);
        Near {
            origin: around.center().coords,
            pairs: pairs.iter().map(candidate).collect(),
            sides,
        }
    }
}

impl DeformableShape {
    /// Whether two tetrahedra of the mesh can overlap, by their nodes.
    fn may_overlap(&self, pair: [u32; 2], creases: &[bool]) -> bool {
        let [a, b] = pair.map(|i| &self.wholes()[i as usize]);
        let mut common = 0;
        for node in a.nodes.iter().filter(|node| b.nodes.contains(node)) {
            if !creases[*node as usize] {
                return false;
            }
            common += 1;
        }
        // Two with a common face lie on both sides of it.
        common < 3
    }
}

impl Search for Folds<'_> {
    type List = Near;
    type Failure = Failure;

    /// Margins are small compared with the elements, whose neighbours but one are always near.
    fn length(&self) -> f64 {
        self.skin().map_or(0.0, |skin| skin.shape.edge())
    }

    /// Around open cracks, much is near: a list that lasts longer costs more than it saves.
    fn lasts(&self) -> f64 {
        LASTS
    }

    /// With wider margins neighbours but one are near everywhere.
    fn widest(&self) -> f64 {
        0.0
    }

    fn gap(&self) -> f64 {
        let reach = REACH[usize::from(!self.before.is_empty())];
        self.skin().map_or(0.0, |skin| skin.gap(reach))
    }

    fn find(&self, margin: f64, motion: f64) -> Result<Option<Box<Near>>, Failure> {
        let Some(skin) = self.skin() else {
            return Ok(None);
        };
        let near = self.near(&skin, &self.pairs(&skin, margin), margin);
        let mut pairs: Vec<[u32; 2]> = near.iter().map(|(pair, _)| *pair).collect();
        orient(&mut pairs, skin.shape, &self.before);
        let gaps = near.iter().map(|(_, gap)| *gap);
        let near: Vec<_> = pairs.into_iter().zip(gaps).collect();
        Ok((!near.is_empty()).then(|| Box::new(self.list(&skin, near, motion))))
    }
}

/// The skin of a body in its present shape.
struct Skin<'a> {
    shape: &'a DeformableShape,
    x: &'a [Vector3],
}

impl Skin<'_> {
    fn corners(&self, triangle: &[u32; 3]) -> [Vector3; 3] {
        // No node of the skin is a slave, and there is a position for every other one.
        triangle.map(|node| self.x.get(node as usize).copied().unwrap_or_default())
    }

    /// The motion, m, up to which no tetrahedra of the body overlap: no part of it moves farther than this towards another.
    /// 0 if some may overlap now. No more than `reach` times the mean edge is looked for.
    fn gap(&self, reach: f64) -> f64 {
        let mut reach = reach * self.shape.edge();
        for flat in self.flatness() {
            reach = if flat < reach { flat } else { reach };
        }
        let skin = self.shape.skin();
        let corners: Vec<[Vector3; 3]> = skin.iter().map(|t| self.corners(t)).collect();
        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|t| Aabb::of_points(t.map(Point3::from)))
            .collect();
        let mut tree: Bvh = self.shape.skin_tree().clone();
        tree.refit(&boxes);
        for (i, own) in boxes.iter().enumerate() {
            if reach <= 0.0 {
                return 0.0;
            }
            tree.query(&own.grown(reach), |j| {
                let j = j as usize;
                let apart = j <= i || skin[i].iter().any(|node| skin[j].contains(node));
                if !apart && own.grown(reach).overlaps(&boxes[j]) {
                    let gap = gap(&corners[i], &corners[j], reach);
                    reach = if gap < reach { gap } else { reach };
                }
            });
        }
        reach.max(0.0)
    }

    /// By node, whether the skin may fold over around it before the body has moved by `margin`, m.
    fn creases(&self, margin: f64) -> Vec<bool> {
        let flatness = self.flatness();
        flatness.iter().map(|flat| *flat <= margin).collect()
    }

    /// By node, the motion up to which the skin around it lies flat, m: seen along some direction, its triangles cover
    /// their surroundings once, with the body behind them and not in front. 0 if they do not now, and infinite for nodes
    /// that are not on the skin.
    fn flatness(&self) -> Vec<f64> {
        let skin = self.shape.skin();
        let mut around: Vec<(u32, u32)> = Vec::with_capacity(3 * skin.len());
        let mut faces = Vec::with_capacity(skin.len());
        for (triangle, i) in skin.iter().zip(0..) {
            around.extend(triangle.map(|node| (node, i)));
            faces.push(Face::new(self.corners(triangle)));
        }
        around.sort_unstable();
        let mut flatness = vec![(f64::INFINITY, Vector3::zeros()); self.shape.node_count()];
        for fan in around.chunk_by(|a, b| a.0 == b.0) {
            let node = fan[0].0;
            if let Some(flat) = flatness.get_mut(node as usize) {
                *flat = self.flatness_of(node, fan, &faces);
            }
        }
        // What is outside of the skin must not be covered by the body from the other side.
        for (tet, i) in self.shape.tets().iter().zip(0..) {
            let Some(corners) = self.shape.corners(i, self.x) else {
                continue;
            };
            for (k, node) in tet.nodes.into_iter().enumerate() {
                let flat = flatness.get_mut(node as usize);
                if let Some((flat, up)) = flat.filter(|(flat, _)| *flat > 0.0 && flat.is_finite())
                    && sees(&corners, k, up)
                {
                    *flat = 0.0;
                }
            }
        }
        flatness.into_iter().map(|(flat, _)| flat).collect()
    }

    /// The same for one node, by its triangles alone, and the direction along which it is seen. `fan` holds these triangles.
    fn flatness_of(&self, node: u32, fan: &[(u32, u32)], faces: &[Face]) -> (f64, Vector3) {
        let faces_of = || fan.iter().map(|(_, i)| &faces[*i as usize]);
        let up = uppermost(faces_of().map(|face| face.normal));
        // Where the corners of a triangle move apart by m, its plane turns by less than m over half its height.
        let flat = faces_of()
            .map(|face| 0.5 * face.height * face.normal.dot(&up))
            .fold(
                f64::INFINITY,
                |least, flat| if flat < least { flat } else { least },
            );
        if flat.is_nan() || flat <= 0.0 {
            return (0.0, up);
        }
        // Each triangle turns the same way about the direction; together they turn once.
        let across = up.cross(&axis_across(&up));
        let passes = fan.iter().filter(|(_, i)| {
            let triangle = &self.shape.skin()[*i as usize];
            let own = triangle
                .iter()
                .position(|corner| *corner == node)
                .unwrap_or(0);
            let at = self.x[triangle[own] as usize];
            let side = |k: usize| {
                let corner = triangle[(own + k) % 3];
                across.dot(&(self.x[corner as usize] - at))
            };
            side(1) < 0.0 && side(2) >= 0.0
        });
        (if passes.count() == 1 { flat } else { 0.0 }, up)
    }
}

/// Whether a tetrahedron lies in the direction `up` from its corner `k`.
fn sees(corners: &[Vector3; 4], k: usize, up: &Vector3) -> bool {
    let [a, b, c] = [1, 2, 3].map(|step| corners[(k + step) % 4] - corners[k]);
    // The three follow each other round one way from corners 0 and 2, and the other way from 1 and 3.
    let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    [a.cross(&b), b.cross(&c), c.cross(&a)]
        .iter()
        .all(|side| sign * side.dot(up) >= 0.0)
}

/// A triangle of the skin.
struct Face {
    normal: Vector3,
    /// The least of its heights, m.
    height: f64,
}

impl Face {
    fn new([a, b, c]: [Vector3; 3]) -> Self {
        let area = (b - a).cross(&(c - a));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let twice = area.norm();
        Self {
            normal: area / twice,
            height: twice / longest,
        }
    }
}

/// Rounds in which a direction is turned towards the normal farthest from it.
const ROUNDS: usize = 8;

/// A cosine that is large enough.
const STEEP: f64 = 0.5;

/// A direction that makes as large a least product with all of `normals` as a few rounds find.
fn uppermost(normals: impl Iterator<Item = Vector3> + Clone) -> Vector3 {
    let mut up = normals.clone().sum::<Vector3>();
    let mut best = (f64::NEG_INFINITY, up);
    for _ in 0..ROUNDS {
        up.try_normalize_mut(1e-12);
        let mut lowest = (f64::INFINITY, up);
        for normal in normals.clone() {
            let product = normal.dot(&up);
            if product < lowest.0 {
                lowest = (product, normal);
            }
        }
        if lowest.0 > best.0 {
            best = (lowest.0, up);
        }
        if lowest.0 > STEEP {
            break;
        }
        up += lowest.1 * 0.5;
    }
    best.1
}

/// The coordinate axis most across a direction.
fn axis_across(x: &Vector3) -> Vector3 {
    Vector3::ith(x.iamin(), 1.0)
}

/// A lower bound of the distance of two triangles, m: along their normals, in their planes across their edges, and across
/// an edge of each. More than `enough` is not looked for.
fn gap(a: &[Vector3; 3], b: &[Vector3; 3], enough: f64) -> f64 {
    let mut gap = 0.0;
    let edges = |t: &[Vector3; 3]| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let (of_a, of_b) = (edges(a), edges(b));
    let mut try_along = |axis: Vector3| {
        let square = axis.norm_squared();
        if square > 0.0 {
            let ([p, q], [r, s]) = (along(a, &axis), along(b, &axis));
            let apart = if p - s > r - q { p - s } else { r - q } / square.sqrt();
            gap = if apart > gap { apart } else { gap };
        }
        gap >= enough
    };
    for edges in [&of_a, &of_b] {
        let normal = edges[0].cross(&edges[1]);
        if try_along(normal) || edges.iter().any(|edge| try_along(edge.cross(&normal))) {
            return gap;
        }
    }
    for e in &of_a {
        for f in &of_b {
            if try_along(e.cross(f)) {
                return gap;
            }
        }
    }
    gap
}

/// Least and largest n.x of three points.
fn along(points: &[Vector3; 3], n: &Vector3) -> [f64; 2] {
    let [a, b, c] = points.map(|x| n.dot(&x));
    [a.min(b).min(c), a.max(b).max(c)]
}
