//! Notched plates under plane strain, one cell thick, in which cracks run fast.

use super::setting::{add_moving, damped_world, facets};
use femdem_contact::BodyId;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, Drive, MaterialRegion, Selection};
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_solve::{CrackFacet, Fracture, World};
use std::error::Error;

/// A plate in the plane of x and y. The notch runs from x = 0 along a line of y to its tip.
pub struct Plate {
    /// Places of the planes of nodes along x and y, m.
    planes: [Vec<f64>; 2],
    /// The plane along x in which the notch ends, and that along y in which it lies.
    notch: [usize; 2],
    /// m.
    pub thickness: f64,
    /// Whether it keeps its thickness (plane strain), or is free to change it (plane stress).
    pub is_strain: bool,
}

/// Linear elasticity of a material: Young's modulus (Pa), Poisson's ratio, density (kg/m³).
#[derive(Clone, Copy)]
pub struct Solid {
    pub young: f64,
    pub poisson: f64,
    pub density: f64,
}

/// A plate that runs.
pub struct Running {
    pub world: World,
    pub body: BodyId,
    pub tets: usize,
}

impl Plate {
    /// A plate of equal cells of an edge, with a notch to a tip, m; under plane strain.
    pub fn even(size: [f64; 2], tip: [f64; 2], edge: f64) -> Self {
        let planes = size.map(|length| {
            let cells = (length / edge).round() as u32;
            let place = |i| length * f64::from(i) / f64::from(cells);
            (0..=cells).map(place).collect()
        });
        Self::new(planes, tip, edge)
    }

    /// A plate with nodes on planes, with a notch to a tip, of a thickness, m; under plane strain.
    pub fn new(planes: [Vec<f64>; 2], tip: [f64; 2], thickness: f64) -> Self {
        let notch = [0, 1].map(|k: usize| planes[k].partition_point(|x| *x < tip[k] - 1e-9));
        Self {
            planes,
            notch,
            thickness,
            is_strain: true,
        }
    }

    /// The triangles of the plane, whose nodes are moved by up to a fifth of an edge, those on the skin along it. The diagonals of
    /// the cells go either way by chance, so that no direction is preferred.
    fn plane(&self) -> (Vec<[f64; 2]>, Vec<[usize; 3]>) {
        let [nx, ny] = [0, 1].map(|k: usize| self.planes[k].len());
        let [tip, line] = self.notch;
        let noise = |n: usize, k: usize| {
            let phase = 12.9898 * n as f64 + 78.233 * k as f64;
            (43.7585 * phase.sin()).sin()
        };
        let mut points = Vec::with_capacity(nx * ny + tip);
        for n in 0..nx * ny {
            let at = [n % nx, n / nx];
            let is_notch = at[1] == line && at[0] <= tip;
            points.push([0, 1].map(|k| {
                let (own, planes) = (at[k], &self.planes[k]);
                let is_inside = own > 0 && own + 1 < planes.len();
                if !is_inside || (is_notch && (k == 1 || at[0] == tip)) {
                    return planes[own];
                }
                let gap = (planes[own] - planes[own - 1]).min(planes[own + 1] - planes[own]);
                planes[own] + 0.2 * gap * noise(n, k)
            }));
        }
        // The nodes of the notch above it.
        points.extend_from_within(nx * line..nx * line + tip);
        let mut triangles = Vec::new();
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                let node = |i: usize, row: usize| {
                    let is_above = row == line && j == line && i < tip;
                    if is_above { nx * ny + i } else { i + nx * row }
                };
                let [a, b] = [node(i, j), node(i + 1, j)];
                let [c, d] = [node(i, j + 1), node(i + 1, j + 1)];
                triangles.extend(if noise(i + nx * j, 2) > 0.0 {
                    [[a, b, d], [a, d, c]]
                } else {
                    [[a, b, c], [b, d, c]]
                });
            }
        }
        (points, triangles)
    }

    /// The prisms over the triangles, three tetrahedra each, which share the diagonals of their sides.
    fn mesh(&self) -> Result<TetMesh, Box<dyn Error>> {
        let (plane, triangles) = self.plane();
        let count = plane.len();
        let points =
            [0.0, self.thickness].map(|z| plane.iter().map(move |[x, y]| Point3::new(*x, *y, z)));
        let points: Vec<Point3> = points.into_iter().flatten().collect();
        let mut tets = Vec::with_capacity(3 * triangles.len());
        for triangle in triangles {
            let mut lower = triangle;
            lower.sort_unstable();
            let [a, b, c] = lower;
            let [top_a, top_b, top_c] = lower.map(|n| n + count);
            for tet in [
                [a, b, c, top_c],
                [a, b, top_b, top_c],
                [a, top_a, top_b, top_c],
            ] {
                let [p, q, r, s] = tet.map(|n| points[n]);
                let is_positive = (q - p).cross(&(r - p)).dot(&(s - p)) > 0.0;
                let [p, q, r, s] = tet.map(|n| n as u32);
                tets.push(if is_positive {
                    [p, q, r, s]
                } else {
                    [q, p, r, s]
                });
            }
        }
        Ok(TetMesh::new(points, tets)?)
    }

    /// A world with the plate, at rest, loaded as the function says.
    pub fn start(
        &self,
        solid: Solid,
        fracture: Fracture,
        local_damping: f64,
        load: impl FnOnce(&DeformableModel, &mut Boundary) -> Result<Vec<Vector3>, Box<dyn Error>>,
    ) -> Result<Running, Box<dyn Error>> {
        let mesh = self.mesh()?;
        let region = MaterialRegion {
            material: NeoHookean::new(solid.young, solid.poisson)?.into(),
            density: solid.density,
        };
        let model = DeformableModel::new(&mesh, Element::T4, vec![region], None)?;
        let mut boundary = Boundary::default();
        let held = if self.is_strain {
            Selection::All
        } else {
            Selection::Plane {
                normal: Vector3::z(),
                offset: 0.0,
                tolerance: 1e-9,
            }
        };
        boundary.drive(&model, &held, [false, false, true], Drive::Fixed)?;
        let velocities = load(&model, &mut boundary)?;
        let mut world = damped_world(local_damping)?;
        let body = add_moving(&mut world, model, boundary, fracture, &velocities)?;
        // The sides of the notch do not press on each other, as if it had a width.
        world.set_self_contact(body, false)?;
        Ok(Running {
            world,
            body,
            tets: mesh.tets().len(),
        })
    }
}

impl Running {
    /// Steps until a time, s.
    pub fn until(&mut self, time: f64) -> Result<(), Box<dyn Error>> {
        while self.world.time() < time {
            self.world.step()?;
        }
        Ok(())
    }

    /// The broken facets by the time at which they broke, s, with their centres, m.
    pub fn broken(&self) -> Vec<(f64, Vector3, CrackFacet)> {
        let centre = |f: CrackFacet| ((f.place[0] + f.place[1] + f.place[2]) / 3.0, f);
        let all = facets(&self.world, self.body).into_iter().map(centre);
        let mut broken: Vec<_> = all.filter_map(|(c, f)| Some((f.end?, c, f))).collect();
        broken.sort_by(|a, b| a.0.total_cmp(&b.0));
        broken
    }
}

/// The direction in which points lie, degrees from the x axis, weighted: the principal axis of their second moments.
pub fn direction(points: impl Iterator<Item = (Vector3, f64)> + Clone) -> f64 {
    let weight: f64 = points.clone().map(|(_, w)| w).sum();
    let mean = points.clone().map(|(p, w)| p * w).sum::<Vector3>() / weight;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (p, w) in points {
        let d = p - mean;
        xx += w * d.x * d.x;
        xy += w * d.x * d.y;
        yy += w * d.y * d.y;
    }
    0.5 * (2.0 * xy).atan2(xx - yy).to_degrees()
}
