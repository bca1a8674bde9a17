//! What weighs on the rigid bodies of a scene as it is placed, and how fast they can become.

use femdem_contact::{MaterialId, Wall, WallShape};
use femdem_mesh::{Point3, Pose, Vector3};
use femdem_solve::World;

use super::flow::{Kind, Supply};
use super::{Scenario, Simulation};

/// Directions over half a turn in which the width of a body is measured.
const DIRECTIONS: usize = 16;

/// Bodies whose gap is at most this part of the smaller one's height stand on one another.
const STACKED: f64 = 0.01;

/// A wall whose normal is this near to level bounds the space, and one this near to vertical bears.
const LEVEL: f64 = 0.99;
const BEARS: f64 = 0.1;

/// A rigid body that contacts move, as it is placed.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// Number among the members, or of the source after the last member.
    pub member: usize,
    pub material: MaterialId,
    /// kg.
    pub mass: f64,
    /// m³.
    pub volume: f64,
    /// Circumscribed diameter \[m\].
    pub diameter: f64,
    /// Depth over which the field rises from 0 at the surface to 1 \[m\].
    pub field_depth: f64,
    /// Largest speed of its points at the start \[m/s\].
    pub speed: f64,
    /// Extents along gravity and two level directions \[m\].
    pub extents: [[f64; 2]; 3],
    /// Smallest level width \[m\].
    pub width: f64,
    /// How far it can fall \[m\].
    pub drop: f64,
}

impl Placed {
    pub fn height(&self) -> f64 {
        self.extents[0][1] - self.extents[0][0]
    }

    /// Area of its level extents \[m²\].
    pub fn footprint(&self) -> f64 {
        self.extents[1..]
            .iter()
            .map(|[low, high]| high - low)
            .product()
    }

    fn stands_on(&self, below: &Self) -> bool {
        let gap = self.extents[0][0] - below.extents[0][1];
        let beside = |k: usize| {
            let ([a, b], [c, d]) = (self.extents[k], below.extents[k]);
            a < d && c < b
        };
        gap.abs() <= STACKED * self.height().min(below.height()) && beside(1) && beside(2)
    }
}

/// A body or several bodies that stand on one another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tower {
    /// A body in it, numbered in the same way.
    pub member: usize,
    pub bodies: usize,
    /// m.
    pub height: f64,
    /// Smallest level width \[m\].
    pub width: f64,
    /// Mass over volume \[kg/m³\].
    pub density: f64,
}

/// The loads of a scene.
#[derive(Clone, Debug)]
pub(super) struct Loads {
    pub placed: Vec<Placed>,
    /// Size of gravity \[m/s²\].
    pub gravity: f64,
    /// Weight of all bodies \[N\].
    pub weight: f64,
    /// The larger of that weight over the level area that the bodies have, and of the stresses of controlled walls \[Pa\].
    pub stress: f64,
    /// Fastest prescribed motion \[m/s\].
    pub driven: f64,
    /// Least thickness of a wall of tetrahedra \[m\]; infinite without one.
    pub thinnest_wall: f64,
}

impl Loads {
    pub fn of(scenario: &Scenario, simulation: &Simulation) -> Self {
        let gravity = simulation.world.parameters().gravity;
        let axes = axes(&gravity);
        let mut loads = Self {
            placed: simulation.placed(&axes),
            gravity: gravity.norm(),
            weight: gravity.norm() * (simulation.free_mass() + simulation.flow.mass_to_come()),
            stress: 0.0,
            driven: scenario.fastest_drive(simulation),
            thinnest_wall: f64::INFINITY,
        };
        let over = |low: f64, high: f64, k: usize| {
            let each = loads.placed.iter().map(|body| body.extents[k]);
            each.fold([low, high], |[a, b], [c, d]| [a.min(c), b.max(d)])
        };
        let mut space = [0, 1, 2].map(|k| over(f64::INFINITY, f64::NEG_INFINITY, k));
        for [low, high] in simulation.flow.boxes() {
            for (k, axis) in axes.iter().enumerate().skip(1) {
                for at in [axis.dot(&low), axis.dot(&high)] {
                    space[k] = [space[k][0].min(at), space[k][1].max(at)];
                }
            }
        }
        let mut bearing = Vec::new();
        for (wall, shape) in simulation.world.walls() {
            let pose = simulation.world.wall_pose(wall).unwrap_or_default();
            match shape {
                WallShape::Planes(planes) => {
                    bound(&mut space, planes, &pose, &axes);
                    bearing.push((planes, pose));
                }
                WallShape::Mesh(mesh) => {
                    loads.thinnest_wall = loads.thinnest_wall.min(mesh.thickness());
                    let (low, high) = mesh.bounds();
                    let up = pose.inverse_transform_vector(&axes[0]);
                    let lowest: f64 = (0..3).map(|k| (up[k] * low[k]).min(up[k] * high[k])).sum();
                    let lowest = lowest + axes[0].dot(&pose.translation.vector);
                    space[0][0] = space[0][0].min(lowest);
                }
            }
        }
        let [across, along] = [1, 2].map(|k| space[k][1] - space[k][0]);
        // Bodies outside of the walls leave no space.
        if across > 0.0 && along > 0.0 {
            loads.stress = loads.weight / (across * along);
            let area = across * along;
            let pressed = scenario
                .controls()
                .map(|control| control.largest_stress(area));
            loads.stress = pressed.fold(loads.stress, f64::max);
        }
        for body in &mut loads.placed {
            let floor = floor_under(body, &bearing, &axes, space[0][0]);
            body.drop = (body.extents[0][0] - floor).max(0.0);
        }
        loads
    }

    /// The bodies by the towers that they form: every body alone, and those that stand on one another.
    pub fn towers(&self) -> Vec<Tower> {
        let alone = |body: &Placed| Tower {
            member: body.member,
            bodies: 1,
            height: body.height(),
            width: body.width,
            density: body.mass / body.volume,
        };
        let mut towers: Vec<Tower> = self.placed.iter().map(alone).collect();
        let mut order: Vec<usize> = (0..self.placed.len()).collect();
        order.sort_by(|&a, &b| {
            let low = |i: usize| self.placed[i].extents[1][0];
            low(a).total_cmp(&low(b))
        });
        let mut group: Vec<usize> = (0..self.placed.len()).collect();
        for (rank, &i) in order.iter().enumerate() {
            let reach = self.placed[i].extents[1][1];
            let beside = order[rank + 1..].iter();
            for &j in beside.take_while(|&&j| self.placed[j].extents[1][0] < reach) {
                let (a, b) = (&self.placed[i], &self.placed[j]);
                if a.stands_on(b) || b.stands_on(a) {
                    let (one, other) = (root(&group, i), root(&group, j));
                    group[one.max(other)] = one.min(other);
                }
            }
        }
        let mut members: Vec<Vec<usize>> = vec![Vec::new(); group.len()];
        for i in 0..group.len() {
            members[root(&group, i)].push(i);
        }
        for stack in members.iter().filter(|stack| stack.len() > 1) {
            let each = || stack.iter().map(|&i| &self.placed[i]);
            let extent = |k: usize| {
                let low = each()
                    .map(|b| b.extents[k][0])
                    .fold(f64::INFINITY, f64::min);
                let high = each()
                    .map(|b| b.extents[k][1])
                    .fold(f64::NEG_INFINITY, f64::max);
                high - low
            };
            let mass: f64 = each().map(|b| b.mass).sum();
            towers.push(Tower {
                member: self.placed[stack[0]].member,
                bodies: stack.len(),
                height: extent(0),
                width: extent(1).min(extent(2)),
                density: mass / each().map(|b| b.volume).sum::<f64>(),
            });
        }
        towers
    }
}

fn root(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}

/// Up, against gravity, and two level directions. Without gravity up is z.
fn axes(gravity: &Vector3) -> [Vector3; 3] {
    let up = gravity
        .try_normalize(0.0)
        .map_or(Vector3::z(), |down| -down);
    let least = up.iamin();
    let mut beside = Vector3::zeros();
    beside[least] = 1.0;
    let first = up.cross(&beside).normalize();
    [up, first, up.cross(&first)]
}

/// Narrows the space to the side of level walls that the bodies are on.
fn bound(space: &mut [[f64; 2]; 3], wall: &Wall, pose: &Pose, axes: &[Vector3; 3]) {
    for plane in wall.planes() {
        let normal = pose * plane.normal;
        let offset = plane.offset + normal.dot(&pose.translation.vector);
        for k in 1..3 {
            let along = normal.dot(&axes[k]);
            let place = offset / along;
            if along > LEVEL {
                space[k][0] = space[k][0].max(place);
            } else if along < -LEVEL {
                space[k][1] = space[k][1].min(place);
            }
        }
    }
}

/// Height of the highest plane under the middle of a body, and at least of the lowest point of the scene \[m\].
fn floor_under(body: &Placed, bearing: &[(&Wall, Pose)], axes: &[Vector3; 3], lowest: f64) -> f64 {
    let middle = |k: usize| 0.5 * (body.extents[k][0] + body.extents[k][1]);
    let below = axes[1] * middle(1) + axes[2] * middle(2);
    let planes = bearing.iter().flat_map(|(wall, pose)| {
        wall.planes().iter().map(move |plane| {
            let normal = pose * plane.normal;
            (normal, plane.offset + normal.dot(&pose.translation.vector))
        })
    });
    let heights = planes.filter_map(|(normal, offset)| {
        let up = normal.dot(&axes[0]);
        (up > BEARS).then(|| (offset - normal.dot(&below)) / up)
    });
    let highest = heights.fold(f64::NEG_INFINITY, f64::max);
    if highest.is_finite() { highest } else { lowest }
}

/// A body of a source: at the highest place at which it may come, above the middle of the box.
fn of_source(
    (supply, kind): (&Supply, &Kind),
    member: usize,
    axes: &[Vector3; 3],
    world: &World,
) -> Option<Placed> {
    let [low, high] = [supply.lower, supply.upper].map(Vector3::from);
    let middle = |axis: &Vector3| 0.5 * axis.dot(&(low + high));
    let half = 0.5 * (high - low).abs().dot(&axes[0].abs());
    let shape = world.shape(kind.shape)?;
    let centre = [middle(&axes[0]) + half, middle(&axes[1]), middle(&axes[2])];
    Some(Placed {
        member,
        material: supply.material,
        mass: kind.mass,
        volume: shape.volume,
        diameter: 2.0 * kind.radius,
        field_depth: world.field_depth(kind.shape)?,
        speed: Vector3::from(supply.velocity).norm(),
        extents: centre.map(|at| [at - kind.radius, at + kind.radius]),
        width: 2.0 * kind.radius,
        drop: 0.0,
    })
}

impl Simulation {
    /// Mass of all bodies that contacts move \[kg\].
    pub(super) fn free_mass(&self) -> f64 {
        let ids = self.world.body_ids();
        let free = ids.filter(|&id| self.world.follows_drive(id) != Some(true));
        free.filter_map(|id| self.world.mass(id)).sum()
    }

    fn placed(&self, axes: &[Vector3; 3]) -> Vec<Placed> {
        let each = self.members.iter().enumerate().filter_map(|(member, of)| {
            let (world, id) = (&self.world, of.id);
            if world.follows_drive(id)? {
                return None;
            }
            let shape_id = world.shape_of(id)?;
            let (shape, pose) = (world.shape(shape_id)?, world.pose(id)?);
            let points: Vec<Vector3> = shape
                .polyhedron
                .vertices()
                .iter()
                .map(|p| (pose * p).coords)
                .collect();
            let extent = |axis: &Vector3| {
                let each = points.iter().map(|p| axis.dot(p));
                each.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                    [a.min(x), b.max(x)]
                })
            };
            let diameter = 2.0 * shape.polyhedron.bounding_radius();
            let width = (0..DIRECTIONS).map(|k| {
                let (sin, cos) = (std::f64::consts::PI * k as f64 / DIRECTIONS as f64).sin_cos();
                let [low, high] = extent(&(axes[1] * cos + axes[2] * sin));
                high - low
            });
            Some(Placed {
                member,
                material: world.material(id)?,
                mass: world.mass(id)?,
                volume: shape.volume,
                diameter,
                field_depth: world.field_depth(shape_id)?,
                speed: world.velocity(id)?.norm()
                    + 0.5 * diameter * world.angular_velocity(id)?.norm(),
                extents: axes.map(|axis| extent(&axis)),
                width: width.fold(f64::INFINITY, f64::min),
                drop: 0.0,
            })
        });
        let sources = (self.members.len()..).zip(&self.flow.supplies);
        let open = sources.filter(|(_, supply)| !supply.is_done());
        // The smallest and the largest are the extremes in all that matters here.
        let extremes = open.flat_map(|(member, supply)| {
            let last = supply.kinds.len() - 1;
            let both = [0, last].into_iter().take(1 + last.min(1));
            both.map(move |k| (member, (supply, &supply.kinds[k])))
        });
        let come = extremes.filter_map(|(member, of)| of_source(of, member, axes, &self.world));
        each.chain(come).collect()
    }

    /// Name of a body, or of a source, by its number in the loads.
    pub(super) fn name_of_placed(&self, member: usize) -> &str {
        let of_source = || {
            let supply = self.flow.supplies.get(member - self.members.len());
            supply.map(|supply| supply.name.as_str())
        };
        let known = self.members.get(member);
        let known = known.map(|member| member.name.as_str());
        known.or_else(of_source).unwrap_or_default()
    }

    /// Largest distance of a corner of a body from an axis \[m\].
    fn reach(&self, axis: &[f64; 3], point: &[f64; 3]) -> f64 {
        let axis = Vector3::from(*axis).try_normalize(0.0).unwrap_or_default();
        let point = Point3::from(*point);
        let each = self.world.rigid_ids().filter_map(|id| {
            let arm = self.world.position(id)? - point.coords;
            let (low, high) = self.world.bounds(id)?;
            Some((arm - axis * axis.dot(&arm)).norm() + 0.5 * (high - low).norm())
        });
        each.fold(0.0, f64::max)
    }
}

impl Scenario {
    /// Speed of the fastest prescribed motion \[m/s\].
    fn fastest_drive(&self, simulation: &Simulation) -> f64 {
        let reach = |axis: &[f64; 3], point: &[f64; 3]| simulation.reach(axis, point);
        let speeds = self.motions().map(|motion| motion.fastest(reach));
        let controlled = self.wall.iter().filter_map(|wall| {
            let sides = wall.r#box.map_or([0.0; 3], |space| {
                [0, 1, 2].map(|k| space.upper[k] - space.lower[k])
            });
            Some(wall.control.as_ref()?.fastest(sides))
        });
        let cell = self.cell.iter();
        let deformed = cell.filter_map(|cell| Some(cell.control.as_ref()?.fastest(cell.sides())));
        speeds.chain(controlled).chain(deformed).fold(0.0, f64::max)
    }
}
