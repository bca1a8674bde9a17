//! A ball and a solid of tetrahedra, rigid: a wall without a field, or a body with one.
//!
//! The ball's field acts on the triangles of the skin within the ball, and the solid's, if it has one, [on the sphere
//! within it](super::field). Tetrahedra whose common face the ball cuts belong to one patch.

use super::disc::Disc;
use super::field::{ASIDE, Linear, OwnField};
use super::patch::{Face, Patch};
use super::sums::{FieldSums, SolidSums};
use crate::disjoint::{find, join};
use crate::kernel::Point;
use crate::tets::cells::{Cells, NONE};
use crate::tets::current::Current;
use femdem_mesh::Vector3;
use femdem_mesh::bvh::Aabb;
use femdem_mesh::tet::FACES;
use smallvec::SmallVec;

/// A connected part of the overlap, by its first tetrahedron that has skin in the ball, or its first.
#[derive(Debug)]
pub(super) struct Part {
    pub key: u32,
    pub patch: Patch,
    own: OwnField,
    has_skin: bool,
}

/// A face of a tetrahedron that cuts the ball.
struct Section {
    face: Face,
    disc: Disc,
    /// The places in the list of the tetrahedron and of the one across, which the skin does not have.
    of: usize,
    across: Option<usize>,
    field: FieldSums,
    solid: SolidSums,
}

/// The parts of the overlap with a ball at `centre` in the solid's axes, in the order of their keys. Only with
/// `has_field` does the solid's field count.
pub(super) fn parts(cells: &Cells, has_field: bool, centre: &Vector3, radius: f64) -> Vec<Part> {
    let near = Near::new(cells, centre, radius);
    let sections = near.sections(has_field);
    let mut root: SmallVec<[u32; 16]> = (0..near.list.len() as u32).collect();
    for section in &sections {
        if let Some(place) = section.across {
            join(&mut root, section.of as u32, place as u32);
        }
    }
    let mut found = Parts::default();
    for section in &sections {
        let part = found.part(find(&root, section.of as u32));
        let (i, face) = (near.list[section.of], &section.face);
        if section.across.is_none() {
            part.patch
                .add_face(&section.disc, face, &section.field, &section.solid);
            if !part.has_skin {
                (part.key, part.has_skin) = (i, true);
            }
        }
        if has_field {
            let across = section.across.map(|place| (near.list[place], -1.0));
            for (i, sign) in [(i, 1.0)].into_iter().chain(across) {
                let cell = part.own.cell(i, || near.field(i));
                cell.add(face, sign, &section.solid);
            }
        }
    }
    if let Some(of) = near.home() {
        let part = found.part(find(&root, of as u32));
        part.patch.add_centre(radius);
        if has_field {
            let i = near.list[of];
            part.own.cell(i, || near.field(i)).add_centre(radius);
        }
    }
    let mut parts: Vec<Part> = found.list.into_iter().map(|(_, part)| part).collect();
    for part in &mut parts {
        part.own.add_to(&mut part.patch, &near.centre, radius);
    }
    parts.sort_by_key(|part| part.key);
    parts
}

/// A ball and the tetrahedra that it may reach, ascending.
struct Near<'a> {
    cells: &'a Cells,
    list: SmallVec<[u32; 16]>,
    /// Off the faces between tetrahedra, m.
    centre: Vector3,
    radius: f64,
}

impl<'a> Near<'a> {
    fn new(cells: &'a Cells, centre: &Vector3, radius: f64) -> Self {
        let corner = Vector3::repeat(radius);
        let around = Aabb {
            low: (centre - corner).into(),
            high: (centre + corner).into(),
        };
        let mut list: SmallVec<[u32; 16]> = SmallVec::new();
        cells.tree.query(&around, |i| {
            let tet = &cells.list[i as usize].tet;
            if (0..4).all(|k| tet.height(k, centre) > -radius) {
                list.push(i);
            }
        });
        list.sort_unstable();
        let is_inside = list.iter().any(|&i| cells.list[i as usize].holds(centre));
        let aside = if is_inside { radius } else { 0.0 };
        Self {
            cells,
            list,
            centre: centre + Vector3::from(ASIDE) * aside,
            radius,
        }
    }

    fn tet(&self, i: u32) -> &Current {
        &self.cells.list[i as usize].tet
    }

    /// The place in the list of the tetrahedron that holds the ball's centre.
    fn home(&self) -> Option<usize> {
        let holds = |i: u32| (0..4).all(|k| self.tet(i).height(k, &self.centre) > 0.0);
        self.list.iter().position(|&i| holds(i))
    }

    /// The solid's field in a tetrahedron.
    fn field(&self, i: u32) -> Linear {
        let tet = self.tet(i);
        Linear {
            level: tet.values[0] - tet.gradient.dot(&tet.corners[0]),
            slope: tet.gradient,
        }
    }

    /// The faces that cut the ball, each once.
    fn sections(&self, has_field: bool) -> SmallVec<[Section; 16]> {
        let mut found = SmallVec::new();
        for (of, &i) in self.list.iter().enumerate() {
            for (k, &next) in self.cells.list[i as usize].neighbours.iter().enumerate() {
                let across = match next {
                    NONE => None,
                    next if next < i => continue,
                    next => match self.list.binary_search(&next) {
                        Ok(place) => Some(place),
                        Err(_) => continue,
                    },
                };
                let Some((face, disc, polygon)) = plane(self.tet(i), k, &self.centre, self.radius)
                else {
                    continue;
                };
                let mut sums = (FieldSums::default(), SolidSums::default());
                let cuts = match (across, has_field) {
                    (None, _) => disc.add_polygon(&polygon, &mut sums),
                    (Some(_), true) => disc.add_polygon(&polygon, &mut sums.1),
                    (Some(_), false) => disc.add_polygon(&polygon, &mut ()),
                };
                if cuts {
                    found.push(Section {
                        face,
                        disc,
                        of,
                        across,
                        field: sums.0,
                        solid: sums.1,
                    });
                }
            }
        }
        found
    }
}

/// Parts by the root of their tetrahedra.
#[derive(Default)]
struct Parts {
    list: SmallVec<[(u32, Part); 2]>,
}

impl Parts {
    fn part(&mut self, root: u32) -> &mut Part {
        let known = self.list.iter().position(|(of, _)| *of == root);
        let place = known.unwrap_or_else(|| {
            let part = Part {
                key: NONE,
                patch: Patch::default(),
                own: OwnField::default(),
                has_skin: false,
            };
            self.list.push((root, part));
            self.list.len() - 1
        });
        &mut self.list[place].1
    }
}

/// The plane of a face where it cuts the ball, and the face in it about the foot of the ball's centre.
fn plane(
    tet: &Current,
    k: usize,
    centre: &Vector3,
    radius: f64,
) -> Option<(Face, Disc, [Point; 3])> {
    let height = tet.height(k, centre);
    let disc = Disc::new(radius, height)?;
    let face = Face::new(tet.normal(k), height);
    let polygon = FACES[k].map(|corner| face.frame.point(&(tet.corners[corner] - centre)));
    Some((face, disc, polygon))
}
