//! Cracks along the facets of tetrahedral meshes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem_mesh::tet::{CrackedMesh, Facet};
use femdem_mesh::{Point3, TetMesh, Vector3};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

fn block(cells: [u32; 3]) -> TetMesh {
    let size = Vector3::from(cells.map(f64::from));
    TetMesh::block(cells, &size).unwrap()
}

/// Facets whose points all satisfy a condition.
fn where_all(mesh: &TetMesh, cracked: &CrackedMesh, holds: impl Fn(&Point3) -> bool) -> Vec<u32> {
    let inside = |facet: &Facet| {
        facet
            .points
            .iter()
            .all(|&i| holds(&mesh.points()[i as usize]))
    };
    let facets = cracked.facets().all().iter().zip(0..);
    facets
        .filter(|(facet, _)| inside(facet))
        .map(|(_, i)| i)
        .collect()
}

/// Vertices less edges plus triangles of the skin, in which every edge runs once in either direction.
fn euler(cracked: &CrackedMesh) -> i64 {
    let skin = cracked.skin();
    let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    let edges: Vec<[u32; 2]> = skin.iter().flat_map(sides).collect();
    let once: BTreeSet<[u32; 2]> = edges.iter().copied().collect();
    assert_eq!(once.len(), edges.len());
    assert!(once.iter().all(|&[a, b]| once.contains(&[b, a])));
    let nodes: BTreeSet<u32> = skin.iter().flatten().copied().collect();
    nodes.len() as i64 - edges.len() as i64 / 2 + skin.len() as i64
}

#[test]
fn facets_are_between_their_tetrahedra() {
    let mesh = block([2, 3, 1]);
    let cracked = CrackedMesh::new(&mesh);
    let centre = |t: u32| {
        let corners = mesh.tets()[t as usize].map(|i| mesh.points()[i as usize].coords);
        corners.iter().sum::<Vector3>() / 4.0
    };
    let facets = cracked.facets();
    assert_eq!(
        2 * facets.all().len() + mesh.skin().len(),
        4 * mesh.tets().len()
    );
    for (number, facet) in (0..).zip(facets.all()) {
        let [a, b, c] = facet.points.map(|i| mesh.points()[i as usize]);
        let normal = (b - a).cross(&(c - a));
        assert!(normal.dot(&(centre(facet.tets[1]) - centre(facet.tets[0]))) > 0.0);
        assert!(facet.tets[0] < facet.tets[1]);
        for t in facet.tets {
            let faces = facets.of_tets()[t as usize];
            assert_eq!(faces.iter().filter(|f| **f == Some(number)).count(), 1);
        }
        assert_eq!(cracked.sides(number), Some([facet.points; 2]));
    }
}

/// A crack through the whole section makes two bodies, one inside opens a hollow that its rim closes, and a slit from the
/// side leaves one body without a hollow.
#[test]
fn cracks_open_where_nothing_holds_them_together() {
    let mesh = block([4, 4, 4]);
    let at = |p: &Point3, low: f64, high: f64| p.x == 2.0 && p.y >= low && p.y <= high;
    let deep = |p: &Point3, low: f64, high: f64| p.z >= low && p.z <= high;
    // Surfaces: two of two bodies; one outside and one of the two lips; one.
    for ([y, z], nodes, parts, surfaces) in [
        ([[0.0, 4.0], [0.0, 4.0]], 25, 2, 2),
        ([[1.0, 3.0], [1.0, 3.0]], 1, 1, 2),
        ([[0.0, 2.0], [0.0, 4.0]], 10, 1, 1),
    ] {
        let mut cracked = CrackedMesh::new(&mesh);
        let crack = where_all(&mesh, &cracked, |p| {
            at(p, y[0], y[1]) && deep(p, z[0], z[1])
        });
        let splits = cracked.cut(&crack).unwrap();
        assert_eq!(splits.len(), nodes);
        assert_eq!(
            cracked.parts().into_iter().collect::<BTreeSet<_>>().len(),
            parts
        );
        assert_eq!(euler(&cracked), 2 * surfaces);
        for split in splits {
            let point = cracked.points()[split.new as usize];
            assert_eq!(cracked.points()[split.node as usize], point);
            assert!(cracked.around(split.node)[0] < cracked.around(split.new)[0]);
        }
    }
}

#[test]
fn what_is_no_facet_is_refused_and_cuts_nothing() {
    let mut cracked = CrackedMesh::new(&block([1, 1, 1]));
    let before = cracked.clone();
    let error = cracked.cut(&[0, 99]).unwrap_err().to_string();
    assert!(error.contains("facet") && error.contains("99"), "{error}");
    assert_eq!(cracked, before);
    assert!(cracked.sides(99).is_none() && cracked.around(99).is_empty());
}

/// Which corners of tetrahedra share a node, whatever the nodes' numbers.
fn shared(cracked: &CrackedMesh) -> Vec<[(u32, u32); 4]> {
    let mut first = BTreeMap::new();
    let corners = (0..).zip(cracked.tets());
    corners
        .map(|(t, nodes)| {
            let mut place = 0;
            nodes.map(|node| {
                place += 1;
                *first.entry(node).or_insert((t, place))
            })
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// A node is exactly one fan of tetrahedra that uncut facets join; the order of cuts does not matter, and neither do cuts
    /// given twice.
    #[test]
    fn nodes_are_what_facets_hold_together(
        chosen in prop::collection::vec(any::<u16>(), 0..200),
        at in 0.0..1.0,
    ) {
        let mesh = block([3, 2, 2]);
        let count = CrackedMesh::new(&mesh).facets().all().len() as u32;
        let cuts: Vec<u32> = chosen.iter().map(|&x| u32::from(x) % count).collect();
        let mut cracked = CrackedMesh::new(&mesh);
        let splits = cracked.cut(&cuts).unwrap();
        prop_assert_eq!(cracked.points().len(), mesh.points().len() + splits.len());

        let mut other = CrackedMesh::new(&mesh);
        let backwards: Vec<u32> = cuts.iter().rev().copied().collect();
        prop_assert_eq!(&other.cut(&backwards).unwrap(), &splits);
        prop_assert_eq!(&other, &cracked);
        prop_assert!(other.cut(&cuts).unwrap().is_empty());
        let mut halves = CrackedMesh::new(&mesh);
        let (early, late) = cuts.split_at((at * cuts.len() as f64) as usize);
        halves.cut(early).unwrap();
        halves.cut(late).unwrap();
        prop_assert_eq!(shared(&halves), shared(&cracked));

        for ((nodes, corners), t) in cracked.tets().iter().zip(mesh.tets()).zip(0..) {
            prop_assert_eq!(nodes.map(|n| cracked.points()[n as usize]), *corners);
            prop_assert!(nodes.iter().all(|&n| cracked.around(n).contains(&t)));
        }
        // Oracle: merge the corners of tetrahedra over uncut facets, beginning with all apart.
        let mut group: Vec<usize> = (0..4 * mesh.tets().len()).collect();
        let facets = cracked.facets().all();
        for _ in 0..mesh.tets().len() {
            for (facet, _) in facets.iter().zip(cracked.is_cut()).filter(|(_, cut)| !**cut) {
                for point in facet.points {
                    let [a, b] = facet.tets.map(|t| {
                        let corners = mesh.tets()[t as usize];
                        4 * t as usize + corners.iter().position(|&i| i == point).unwrap()
                    });
                    let low = group[a].min(group[b]);
                    (group[a], group[b]) = (low, low);
                }
            }
        }
        let nodes: Vec<u32> = cracked.tets().iter().flatten().copied().collect();
        for a in 0..nodes.len() {
            for b in 0..a {
                prop_assert_eq!(nodes[a] == nodes[b], group[a] == group[b]);
            }
        }
        let parts = cracked.parts();
        for (facet, cut) in facets.iter().zip(cracked.is_cut()) {
            let [a, b] = facet.tets.map(|t| parts[t as usize]);
            prop_assert!(*cut || a == b);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// What hangs together by nodes is parted into meshes of their own, which share what they shared, and crack on as the whole
    /// does.
    #[test]
    fn parts_of_a_cracked_mesh_crack_on_as_the_whole(
        chosen in prop::collection::vec(any::<u16>(), 100..400),
        more in prop::collection::vec(any::<u16>(), 0..60),
    ) {
        let mut whole = CrackedMesh::new(&block([3, 2, 2]));
        let count = whole.facets().all().len() as u32;
        let facet = |x: &u16| u32::from(*x) % count;
        whole.cut(&chosen.iter().map(facet).collect::<Vec<_>>()).unwrap();
        let later: BTreeSet<u32> = more.iter().map(facet).collect();
        let hanging = whole.hanging(&[]);
        let mut cut_on = whole.clone();
        cut_on.cut(&later.iter().copied().collect::<Vec<_>>()).unwrap();
        let mut facets = 0;
        for number in 0..=hanging.iter().copied().max().unwrap() {
            let own = (0_u32..).zip(&hanging).filter(|(_, part)| **part == number);
            let tets: Vec<u32> = own.map(|(t, _)| t).collect();
            let found = whole.part(&tets).unwrap();
            let mut part = found.mesh;
            facets += found.facets.len();
            for (own, t) in part.tets().iter().zip(&tets) {
                prop_assert_eq!(own.map(|node| found.nodes[node as usize]), whole.tets()[*t as usize]);
            }
            // Points of the part are nodes of it, and one each of the whole's.
            for (node, point) in (0_u32..).zip(part.points()) {
                prop_assert!(part.points()[*point as usize] == *point && *point <= node);
                let of = |i: u32| whole.points()[found.nodes[i as usize] as usize];
                prop_assert_eq!(of(node), of(*point));
            }
            let closed: Vec<[u32; 4]> = part.whole_tets().collect();
            for ((own, f), g) in part.facets().all().iter().zip(&found.facets).zip(0_u32..) {
                let other = whole.facets().all()[*f as usize];
                prop_assert_eq!(own.tets.map(|t| tets[t as usize]), other.tets);
                prop_assert_eq!(part.is_cut()[g as usize], whole.is_cut()[*f as usize]);
                let sides = part.sides(g).unwrap();
                let named = sides.map(|side| side.map(|node| found.nodes[node as usize]));
                prop_assert_eq!(Some(named), whole.sides(*f));
            }
            let uncut = part.cut_along(&[]).unwrap();
            prop_assert_eq!(uncut.tets(), &closed[..]);
            let on = |(f, _): &(&u32, u32)| later.contains(f);
            let mapped: Vec<u32> = found.facets.iter().zip(0_u32..).filter(on).map(|(_, g)| g).collect();
            part.cut(&mapped).unwrap();
            let of_part = shared(&part);
            let of_whole = shared(&cut_on);
            for (own, t) in of_part.iter().zip(&tets) {
                let named = own.map(|(t, place)| (tets[t as usize], place));
                prop_assert_eq!(named, of_whole[*t as usize]);
            }
        }
        // Facets between parts are cut.
        let between = whole.facets().all().iter().filter(|f| {
            let [a, b] = f.tets.map(|t| hanging[t as usize]);
            a != b
        });
        prop_assert_eq!(between.count(), count as usize - facets);
        prop_assert!(whole.part(&[]).is_err() && whole.part(&[1, 0]).is_err());
    }
}
