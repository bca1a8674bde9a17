//! Measurements in periodic space, against the same with all images spelt out.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem_analysis::mesh::catalogue::CatalogueShape;
use femdem_analysis::mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_analysis::mesh::{PeriodicCell, Point3, Polyhedron, Pose, Vector3};
use femdem_analysis::{
    BlockBootstrap, ChainOptions, CoreOptions, ForceBody, ForceContact, ForceNetwork, InsetLimit,
    Pack, Partner, PeriodicSpace, PosedBody, Region, SetVoronoiOptions, StressRule, WithImages,
    body_stresses, chains_by_stress, choose_core, contact_fabric, exact_density, mean_coordination,
    region_stress, set_voronoi, stress_profile, top_plane,
};

/// Number of bodies.
const COUNT: u32 = 14;

/// Copies of the cell on each side of it in the oracle.
const AROUND: i32 = 2;

/// Numbers in [0, 1).
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| self.next() - 0.5)
    }
}

/// A cell of 3 m x 2.8 m whose edge y leans, endless along z or 3.1 m high, away from the origin.
fn space(endless: bool) -> PeriodicSpace {
    let cell = PeriodicCell::new([Some(3.0), Some(2.8), endless.then_some(3.1)]).unwrap();
    let mut edges = *cell.edges();
    edges[(0, 1)] = 0.7;
    if endless {
        edges[(0, 2)] = -0.4;
    }
    PeriodicSpace {
        cell: cell.with_edges(edges).unwrap(),
        lower: Point3::new(-1.3, 0.4, 0.0),
    }
}

fn cube() -> [Polyhedron; 1] {
    let cube: CatalogueShape = "P5".parse().unwrap();
    [cube.polyhedron(1.0).unwrap()]
}

fn inside() -> Region {
    Region::Box {
        min: Point3::new(-1.3, 0.4, 0.0),
        max: Point3::new(1.7, 3.2, 3.1),
    }
}

/// Bodies in the box of the cell's sides, some of them over its edges.
fn bodies(space: &PeriodicSpace, stream: &mut Stream) -> Vec<PosedBody> {
    let mut body = || {
        let at = Vector3::new(
            3.0 * stream.next(),
            2.8 * stream.next(),
            3.1 * stream.next(),
        );
        let turn = Quaternion::from(stream.vector().push(stream.next()));
        PosedBody {
            shape: 0,
            pose: Pose::from_parts(
                (space.lower.coords + at).into(),
                UnitQuaternion::from_quaternion(turn),
            ),
        }
    };
    (0..COUNT).map(|_| body()).collect()
}

/// The ways to the copies of the cell, its own place first.
fn copies(space: &PeriodicSpace) -> Vec<[i32; 3]> {
    let range = |axis: usize| match space.cell.repeats(axis) {
        true => -AROUND..=AROUND,
        false => 0..=0,
    };
    let all = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| [x, y, z])));
    let mut all: Vec<[i32; 3]> = all.collect();
    all.sort_by_key(|image| image != &[0; 3]);
    all
}

/// The bodies, and then those of all copies.
fn spelt_out(space: &PeriodicSpace, bodies: &[PosedBody]) -> Vec<PosedBody> {
    let copy = |image: [i32; 3]| {
        bodies.iter().map(move |body| {
            let mut copy = *body;
            copy.pose.translation.vector += space.cell.offset(image);
            copy
        })
    };
    copies(space).into_iter().flat_map(copy).collect()
}

#[test]
fn volumes_are_those_with_all_images() {
    let mut stream = Stream(7);
    for endless in [false, true] {
        let space = space(endless);
        let (shapes, own) = (cube(), bodies(&space, &mut stream));
        let all = spelt_out(&space, &own);
        let oracle = Pack::new(&shapes, &all).unwrap();
        let images = WithImages::new(&shapes, &own, &space, &inside(), 0.0).unwrap();
        let pack = images.pack(&shapes).unwrap();
        assert_eq!(pack.own(), own.len());
        assert!(pack.len() > own.len() && pack.len() < all.len());
        let [found, expected] = [&pack, &oracle].map(|p| exact_density(p, &inside()).unwrap());
        assert!((found.density - expected.density).abs() < 1e-12);
        // A cell holds as much of all bodies as each of them has, whatever hangs over its edges.
        if endless {
            let cubes = f64::from(COUNT) * (1.0 / 3_f64.sqrt()).powi(3);
            assert!((found.body_volume - cubes).abs() < 1e-9, "{found:?}");
        }
        if !endless {
            let [found, expected] = [&pack, &oracle].map(|p| top_plane(p, &inside(), 0.1).unwrap());
            assert!((found.mean - expected.mean).abs() < 1e-12);
            assert_eq!(found.empty_columns, expected.empty_columns);
        }

        let core = choose_core(&pack, &inside(), &CoreOptions::default()).unwrap();
        let (low, high) = core.region.corners();
        let (min, max) = inside().corners();
        assert_eq!((low.x, low.y, high.x, high.y), (min.x, min.y, max.x, max.y));
        assert_eq!(endless, core.inset == 0.0);
        assert!(!endless || (core.limit == InsetLimit::None && high.z == max.z));
    }
}

/// The cells of bodies at the edges are those between them and the images.
#[test]
fn voronoi_cells_go_over_the_edges() {
    let mut stream = Stream(3);
    let space = space(false);
    let (shapes, own) = (cube(), bodies(&space, &mut stream));
    let (min, max) = inside().corners();
    let by = Vector3::new(2.5, 2.5, 0.0);
    let wide = Region::Box {
        min: min - by,
        max: max + by,
    };
    let images = WithImages::new(&shapes, &own, &space, &inside(), 5.0).unwrap();
    let all = spelt_out(&space, &own);
    let options = SetVoronoiOptions {
        leaf_over_d: 0.4,
        ..SetVoronoiOptions::default()
    };
    let packs = [
        images.pack(&shapes).unwrap(),
        Pack::new(&shapes, &all).unwrap(),
    ];
    let [found, expected] = packs.map(|pack| set_voronoi(&pack, &wide, &options).unwrap());
    let mut sum = 0.0;
    for cell in &expected.cells[..own.len()] {
        let mut cells = found.cells.iter();
        let own = cells.find(|other| other.body == cell.body).unwrap();
        assert!((own.volume / cell.volume - 1.0).abs() < 1e-9, "{cell:?}");
        sum += own.volume;
    }
    // All of space belongs to one of them.
    assert!((sum / inside().volume() - 1.0).abs() < 0.01, "{sum}");
}

/// Pairs of near bodies with forces, from the lower to the higher number, told by the image of the contact in the box.
fn contacts(space: &PeriodicSpace, centres: &[Point3], stream: &mut Stream) -> Vec<ForceContact> {
    let mut contacts = Vec::new();
    for (i, a) in (0_u32..).zip(centres) {
        for (j, b) in (0_u32..).zip(centres).skip(i as usize + 1) {
            let way = space.cell.shortest(&(b - a));
            if way.norm() < 1.3 {
                contacts.push(ForceContact {
                    first: i,
                    second: Partner::Body(j),
                    point: space.wrapped(&(a + way * 0.4 + 0.1 * stream.vector())),
                    normal: way.normalize(),
                    normal_force: 1.0 + stream.next(),
                    tangential: stream.vector(),
                    moment: stream.vector(),
                    class: None,
                });
            }
        }
    }
    contacts
}

#[test]
fn forces_are_those_with_all_images() {
    let mut stream = Stream(11);
    for endless in [false, true] {
        let space = space(endless);
        let (shapes, own) = (cube(), bodies(&space, &mut stream));
        let pack = Pack::new(&shapes, &own).unwrap();
        let centres = pack.centroids();
        let few = contacts(&space, &centres, &mut stream);
        let over = few.iter().filter(|contact| {
            let Partner::Body(second) = contact.second else {
                return false;
            };
            let way = centres[second as usize] - centres[contact.first as usize];
            way.norm() > 1.3
        });
        assert!(over.count() > 3, "contacts over the edges");

        // Every copy of a contact, between the copies of its bodies.
        let copies = copies(&space);
        let number = |image: [i32; 3]| copies.iter().position(|copy| *copy == image);
        let mut many = Vec::new();
        for (place, image) in copies.iter().enumerate() {
            for contact in &few {
                let Partner::Body(second) = contact.second else {
                    continue;
                };
                let first = centres[contact.first as usize];
                let shift = space
                    .cell
                    .minimum_image(&(centres[second as usize] - first));
                let Some(other) = number([0, 1, 2].map(|k| image[k] - shift[k])) else {
                    continue;
                };
                let lever = space.cell.shortest(&(contact.point - first));
                many.push(ForceContact {
                    first: contact.first + place as u32 * COUNT,
                    second: Partner::Body(second + other as u32 * COUNT),
                    point: first + lever + space.cell.offset(*image),
                    ..*contact
                });
            }
        }
        let all = spelt_out(&space, &own);
        let big = ForceBody::of_pack(&Pack::new(&shapes, &all).unwrap(), 1.0);
        let small = ForceBody::of_pack(&pack, 1.0);
        let oracle = ForceNetwork::new(&big, &many, 0.0).unwrap();
        let network = ForceNetwork::new(&small, &few, 0.0)
            .unwrap()
            .in_space(Some(space));

        let [found, expected] = [&network, &oracle].map(body_stresses);
        for (a, b) in found.bodies.iter().zip(&expected.bodies) {
            let difference = (a.stress.pressure - b.stress.pressure).abs();
            assert!(difference < 1e-9 * (1.0 + b.stress.pressure.abs()));
            for k in 0..3 {
                assert!((a.net_moment[k] - b.net_moment[k]).abs() < 1e-9);
            }
        }
        let bootstrap = BlockBootstrap::default();
        let [found, expected] =
            [&network, &oracle].map(|n| region_stress(n, &inside(), bootstrap).unwrap().stress);
        for (a, b) in found.tensor.iter().zip(&expected.tensor) {
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
            }
        }
        // A part of the cell has no stress of its own there.
        assert!(region_stress(&network, &inside().inset(0.1).unwrap(), bootstrap).is_err());
        if endless {
            assert!(stress_profile(&network, &inside(), 4).is_err());
        } else {
            for slab in stress_profile(&network, &inside(), 4).unwrap().slabs {
                let part = inside().slab(slab.z_min, slab.z_max).unwrap();
                let expected = region_stress(&oracle, &part, bootstrap).unwrap();
                let difference = slab.stress.pressure - expected.stress.pressure;
                assert!(difference.abs() < 1e-9, "{slab:?}");
            }
        }
        let fabric = contact_fabric(&network);
        let mut lengths = few.iter().map(|contact| match contact.second {
            Partner::Body(second) => {
                let way = centres[second as usize] - centres[contact.first as usize];
                space.cell.shortest(&way).norm()
            }
            Partner::Wall(_) => f64::NAN,
        });
        assert!(lengths.all(|length| length < 1.3) && fabric.mean_branch < 1.3);
        let coordination = mean_coordination(&network, None, bootstrap).unwrap();
        let expected = 2.0 * few.len() as f64 / f64::from(COUNT);
        assert!((coordination.mean - expected).abs() < 1e-12);
    }
}

/// A row of three bodies that goes round the cell: no link is longer than the shortest way.
#[test]
fn chains_go_over_the_edges() {
    let space = PeriodicSpace {
        cell: PeriodicCell::new([Some(3.0), None, None]).unwrap(),
        lower: Point3::origin(),
    };
    let body = |x: f64| ForceBody {
        centre: Point3::new(x, 0.0, 0.0),
        volume: 1.0,
        diameter: 1.0,
        weight: 1.0,
    };
    let bodies = [body(0.2), body(1.2), body(2.2), body(1.7), body(0.7)];
    let contact = |first, second, x| ForceContact {
        first,
        second: Partner::Body(second),
        point: Point3::new(x, 0.0, 0.0),
        normal: Vector3::x(),
        normal_force: 10.0,
        tangential: Vector3::zeros(),
        moment: Vector3::zeros(),
        class: None,
    };
    // The last two carry nothing to speak of.
    let weak = |first, second, x| ForceContact {
        normal: Vector3::y(),
        normal_force: 0.01,
        ..contact(first, second, x)
    };
    let contacts = [
        contact(2, 0, 2.7),
        contact(0, 1, 0.7),
        weak(2, 3, 1.9),
        weak(1, 4, 1.0),
    ];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0)
        .unwrap()
        .in_space(Some(space));
    let options = ChainOptions {
        least_bodies: 2,
        ..ChainOptions::default()
    };
    let found = chains_by_stress(&network, StressRule::default(), &options).unwrap();
    let lengths: Vec<f64> = found.chains.iter().map(|chain| chain.length).collect();
    assert!(!lengths.is_empty(), "{found:?}");
    for chain in &found.chains {
        assert!(
            (chain.length - chain.length_links as f64).abs() < 1e-12,
            "{chain:?}"
        );
        assert!((chain.straightness - 1.0).abs() < 1e-12);
    }
}
