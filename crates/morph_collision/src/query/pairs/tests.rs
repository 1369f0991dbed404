//! Pair queries: their lists, limits, memory and statistics.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{PairMemory, PairQuery, SelfQuery, Start};
use crate::bounds::WorldFromModel;
use crate::exact::triangles_intersect;
use crate::model::MorphModel;
use crate::pose::Pose;
use crate::query::{Body, TrianglePair};
use crate::tree::{BuildOptions, MorphBvh};

/// One triangle at each of these places along x. Each is a leaf.
fn row(places: &[f32], corners: [[f32; 3]; 3]) -> Pose {
    let corners = corners.map(Vec3::from);
    let positions: Vec<_> = places
        .iter()
        .flat_map(|x| corners.map(|corner| corner + Vec3::X * *x))
        .collect();
    let triangles: Vec<_> = (0..places.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect();
    let model = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &triangles, &[]).unwrap();
    let one_a_leaf = BuildOptions::default().with_leaf_size(1).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &one_a_leaf)))
}

/// Triangles across the x axis.
fn fins(places: &[f32]) -> Pose {
    row(places, [[0.0, -1.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]])
}

/// Triangles along the x axis. Each intersects the fin at the same place.
fn needles(places: &[f32]) -> Pose {
    row(places, [[-0.5, 0.0, 0.0], [0.5, 0.1, 0.0], [0.5, -0.1, 0.0]])
}

fn pair(triangle_a: u32, triangle_b: u32) -> TrianglePair {
    TrianglePair { triangle_a, triangle_b }
}

/// Two bodies for queries: fins that stay in place, and needles that can be moved.
struct Bodies {
    fins: Pose,
    needles: Pose,
    place: WorldFromModel,
}

impl Bodies {
    fn new(of_fins: &[f32], of_needles: &[f32]) -> Self {
        let (fins, needles, place) = (fins(of_fins), needles(of_needles), WorldFromModel::IDENTITY);
        Self { fins, needles, place }
    }

    fn shift(&mut self, along_x: f32) {
        self.place = WorldFromModel::new(Affine3A::from_translation(Vec3::X * along_x)).unwrap();
    }

    fn both(&mut self) -> [Body<'_>; 2] {
        let (fins, needles) = (&mut self.fins, &mut self.needles);
        [
            Body::new(fins, &WorldFromModel::IDENTITY),
            Body::new(needles, &self.place),
        ]
    }
}

#[test]
fn every_intersecting_pair_is_listed() {
    let mut bodies = Bodies::new(&[0.0, 2.0, 4.0], &[4.0, 0.0, 9.0]);
    let mut query = PairQuery::new();
    let mut pairs = vec![pair(7, 7)];
    let [a, b] = bodies.both();
    query.all(a, b, &mut pairs);
    assert_eq!(pairs, [pair(7, 7), pair(0, 1), pair(2, 0)]);
    let [a, b] = bodies.both();
    assert!(query.any(a, b));
    bodies.shift(1.0);
    let [a, b] = bodies.both();
    assert!(!query.any(a, b));
}

#[test]
fn a_limit_cuts_the_list_and_says_so() {
    let mut bodies = Bodies::new(&[0.0, 2.0], &[0.0, 2.0]);
    for (limit, is_truncated) in [(0, true), (1, true), (2, false), (3, false)] {
        let mut pairs = Vec::new();
        let [a, b] = bodies.both();
        assert_eq!(PairQuery::new().up_to(a, b, limit, &mut pairs), is_truncated);
        assert_eq!(pairs, [pair(0, 0), pair(1, 1)][..limit.min(2)]);
    }
}

#[test]
fn a_visitor_ends_the_query() {
    let mut bodies = Bodies::new(&[0.0, 2.0], &[0.0, 2.0]);
    let mut visited = Vec::new();
    let [a, b] = bodies.both();
    PairQuery::new().visit(a, b, |pair| {
        visited.push(pair);
        ControlFlow::Break(())
    });
    assert_eq!(visited, [pair(0, 0)]);
}

#[test]
fn the_work_of_the_last_call_is_counted() {
    let mut bodies = Bodies::new(&[0.0, 2.0, 4.0], &[0.0, 4.0]);
    let mut query = PairQuery::new();
    let [a, b] = bodies.both();
    query.all(a, b, &mut Vec::new());
    let stats = query.stats();
    // The roots, then the children of one root with the other root, then all children with each other.
    assert_eq!(stats.node_tests, 1 + 3 + 3 * 2);
    assert_eq!(stats.triangle_tests, 2);
    assert!(stats.vertices_blended > 0 && stats.nodes_blended > 0);
    bodies.shift(100.0);
    let [a, b] = bodies.both();
    query.all(a, b, &mut Vec::new());
    let stats = query.stats();
    assert_eq!(
        (stats.node_tests, stats.triangle_tests, stats.vertices_blended),
        (1, 0, 0)
    );
}

#[test]
fn a_remembered_pair_is_found_without_a_walk_and_forgotten_when_it_parts() {
    let mut bodies = Bodies::new(&[0.0, 2.0], &[0.0, 5.0]);
    let (mut query, mut memory) = (PairQuery::new(), PairMemory::new());
    let mut ask = |memory: &mut PairMemory, along_x: f32| {
        bodies.shift(along_x);
        let [a, b] = bodies.both();
        (query.first_with(memory, a, b), query.stats())
    };
    for (along_x, expected) in [(0.0, pair(0, 0)), (-3.0, pair(1, 1))] {
        let (_, plain) = ask(&mut PairMemory::new(), along_x);
        let (found, stats) = ask(&mut memory, along_x);
        assert_eq!(found, Some(expected));
        assert_eq!(stats.node_tests, plain.node_tests);
        // The remembered pair, which no longer intersects, is tried first.
        assert_eq!(stats.triangle_tests, plain.triangle_tests + u64::from(along_x != 0.0));
        let (again, stats) = ask(&mut memory, along_x);
        assert_eq!((again, stats.node_tests, stats.triangle_tests), (found, 0, 1));
    }
    assert_eq!(ask(&mut memory, 1.0).0, None);
    assert!(ask(&mut memory, 0.0).1.node_tests > 0);
}

#[test]
fn the_pairs_below_a_front_are_all_pairs_in_their_order() {
    let places: Vec<_> = (0..40).map(|i| i as f32).collect();
    let mut bodies = Bodies::new(&places, &places);
    let mut query = PairQuery::new();
    let mut expected = Vec::new();
    let [a, b] = bodies.both();
    query.all(a, b, &mut expected);
    assert_eq!(expected.len(), places.len());
    let [a, b] = bodies.both();
    let front = query.front(a, b, 10);
    assert!(front.len() >= 10);
    let mut pairs = Vec::new();
    for part in &front {
        let [a, b] = bodies.both();
        let start = Start::Part {
            front: &[*part],
            resume: false,
        };
        query.run(a, b, start, &mut |pair| {
            pairs.push(pair);
            ControlFlow::Continue(())
        });
    }
    assert_eq!(pairs, expected);
}

#[test]
fn bodies_are_collapsed_where_rounding_is_as_large_as_they_are() {
    let mut bodies = Bodies::new(&[0.0], &[0.0]);
    let query = PairQuery::new();
    let [a, b] = bodies.both();
    assert!(!query.are_collapsed(a, b));
    let far = Affine3A::from_scale(Vec3::splat(1e-12));
    let far = WorldFromModel::new(Affine3A::from_translation(Vec3::X * 1e6) * far).unwrap();
    let (a, b) = (Body::new(&mut bodies.fins, &far), Body::new(&mut bodies.needles, &far));
    assert!(query.are_collapsed(a, b));
}

/// Leaves of several patches: of 1 to 20 triangles, some of which share a vertex.
#[test]
fn pairs_of_leaves_of_any_size_are_those_found_one_by_one() {
    for leaf_size in [1, 3, 9, 20] {
        for share in [false, true] {
            let mut pose = crossing(leaf_size, share);
            let place = WorldFromModel::IDENTITY;
            let count = pose.bvh().model().triangle_count() as u32;
            let corners: Vec<_> = (0..count).map(|t| pose.bvh().model().corners(t)).collect();
            let mut body = Body::new(&mut pose, &place);
            let triangles: Vec<_> = (0..count).map(|t| body.triangle(t).unwrap()).collect();
            let (mut expected, mut within) = (Vec::new(), Vec::new());
            for (a, p) in (0..).zip(&triangles) {
                for (b, q) in (0..).zip(&triangles) {
                    if triangles_intersect(p, q) {
                        expected.push(pair(a, b));
                        let [x, y] = [a, b].map(|t: u32| corners[t as usize]);
                        if a < b && !x.iter().any(|corner| y.contains(corner)) {
                            within.push(pair(a, b));
                        }
                    }
                }
            }
            let mut found = Vec::new();
            let mut query = PairQuery::default();
            query.all(
                Body::new(&mut pose.clone(), &place),
                Body::new(&mut pose, &place),
                &mut found,
            );
            found.sort_unstable();
            assert_eq!(found, expected);
            let tests = query.stats().triangle_tests;
            assert!(
                (expected.len() as u64..=u64::from(count * count)).contains(&tests),
                "{tests}"
            );
            let (mut found, mut query) = (Vec::new(), SelfQuery::default());
            query.all(&mut pose, &mut found);
            let tests = query.stats().triangle_tests;
            let in_order = |p: TrianglePair| pair(p.triangle_a.min(p.triangle_b), p.triangle_a.max(p.triangle_b));
            let mut found: Vec<_> = found.into_iter().map(in_order).collect();
            found.sort_unstable();
            assert_eq!(found, within);
            let all = u64::from(count * (count - 1) / 2);
            assert!((within.len() as u64..=all).contains(&tests), "{tests} of {all}");
            assert_eq!(query.any(&mut pose), !within.is_empty());
        }
    }
}

/// Twenty triangles in two heaps, in which most cross each other; in strips if they are to share vertices. Two more are in one plane, side by side
/// and with boxes that overlap.
fn crossing(leaf_size: usize, share: bool) -> Pose {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut point = |x: f32| Vec3::from_array([(); 3].map(|()| rng.random_range(-1.0..1.0))) + Vec3::X * x;
    let mut positions: Vec<_> = (0..60).map(|i| point(if i < 30 { 0.0 } else { 1.5 })).collect();
    positions.extend(
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.1], [0.1, 1.0]].map(|[x, y]| Vec3::new(x, y, 5.0)),
    );
    let corner = |i: u32| if share { 2 * i } else { 3 * i };
    let mut triangles: Vec<_> = (0..20).map(|i| [corner(i), corner(i) + 1, corner(i) + 2]).collect();
    triangles.extend([[60, 61, 62], [63, 64, 65]]);
    let model = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &triangles, &[]).unwrap();
    let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
    Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &options)))
}
