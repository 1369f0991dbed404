//! Compares the walk over two trees with brute force over the boxes of all leaves.

use std::ops::ControlFlow;

use glam::{Affine3A, DMat3, DVec3, Quat, Vec3};

use super::walk::{LEAF_PAIRS, Order, OverlapWalk};
use crate::bounds::{Aabb, BoxMap, Frame, FrameLanes, WorldFromModel, visit_frames, with_simd};
use crate::pose::{Pose, Posed};
use crate::traverse::probe::{blob, cubes, leaves, row, triangle};
use crate::tree::NodeId;

/// A walk over two bodies, and the leaf pairs that it passed on, named by their triangles.
struct Walk<'p> {
    walk: OverlapWalk,
    a: Posed<'p>,
    b: Posed<'p>,
    lists: Vec<Vec<(u32, u32)>>,
}

/// Maps from each body's own space, as [`OverlapWalk::push_frame`] takes them.
type Frames = [Option<Frame>; 2];

const OWN: Frames = [None, None];

impl<'p> Walk<'p> {
    /// A walk without frames: nothing is culled.
    fn unculled(a: &'p mut Pose, b: &'p mut Pose) -> Self {
        let (mut a, mut b) = (a.posed(), b.posed());
        let mut walk = OverlapWalk::default();
        walk.begin([a.placed_body(), b.placed_body()], 1.0);
        let lists = Vec::new();
        Self { walk, a, b, lists }
    }

    /// Both bodies in the same space.
    fn new(a: &'p mut Pose, b: &'p mut Pose) -> Self {
        let mut walk = Self::unculled(a, b);
        walk.push(&OWN);
        walk
    }

    fn push(&mut self, [of_a, of_b]: &Frames) -> bool {
        let (a, b) = (self.a.bounds(), self.b.bounds());
        with_simd!(self.a.level, simd => {
            let [of_a, of_b] = [of_a, of_b].map(|frame| frame.map(|frame| FrameLanes::load(simd, &frame)));
            self.walk.push_frame(simd, [of_a.as_ref(), of_b.as_ref()], &a, &b)
        })
    }

    fn run_from(&mut self, front: &[(NodeId, NodeId)], order: Order, flow: ControlFlow<()>) -> ControlFlow<()> {
        self.lists.clear();
        let Self { walk, a, b, lists } = self;
        walk.run(a, b, front, order, &mut |a, b, leaves| {
            lists.push(
                leaves
                    .iter()
                    .map(|(of_a, of_b)| (triangle(a, *of_a), triangle(b, *of_b)))
                    .collect(),
            );
            flow
        })
    }

    /// The leaf pairs in the order of the walk.
    fn pairs(&mut self, order: Order) -> Vec<(u32, u32)> {
        self.pairs_from(&[], order)
    }

    fn pairs_from(&mut self, front: &[(NodeId, NodeId)], order: Order) -> Vec<(u32, u32)> {
        assert!(self.run_from(front, order, ControlFlow::Continue(())).is_continue());
        self.lists.concat()
    }

    fn sorted(&mut self, order: Order) -> Vec<(u32, u32)> {
        let mut pairs = self.pairs(order);
        pairs.sort_unstable();
        pairs
    }

    /// Brute force: the leaves whose boxes overlap in every frame.
    fn overlapping(&mut self, frames: &[Frames]) -> Vec<(u32, u32)> {
        let seen =
            |map: &Option<Frame>, bounds: &Aabb| map.map_or(*bounds, |map| BoxMap::new(&map).unwrap().one(bounds));
        let mut pairs = Vec::new();
        for (of_a, box_a) in leaves(&mut self.a) {
            for (of_b, box_b) in leaves(&mut self.b) {
                if frames.iter().all(|[a, b]| seen(a, &box_a).overlaps(&seen(b, &box_b))) {
                    pairs.push((of_a, of_b));
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }
}

/// A map for B, which reaches up to 16 units.
fn frame(linear: DMat3, translation: DVec3) -> Frames {
    let magnitude = DVec3::splat(16.0);
    let error = DVec3::ZERO;
    let map = Frame {
        linear,
        translation,
        magnitude,
        error,
    };
    [None, Some(map)]
}

#[test]
fn every_pair_of_leaves_with_overlapping_boxes_is_passed_on_once() {
    let bodies = || {
        [
            blob(Vec3::ZERO, 1.0),
            blob(Vec3::X * 0.5, 1.0),
            blob(Vec3::X, 0.2),
            cubes(&[Vec3::ZERO], 1.0),
        ]
    };
    let mut found = 0;
    for a in &mut bodies() {
        for b in &mut bodies() {
            let mut walk = Walk::new(a, b);
            let expected = walk.overlapping(&[OWN]);
            for order in [Order::Any, Order::DeepestFirst] {
                assert_eq!(walk.sorted(order), expected);
            }
            found += expected.len();
        }
    }
    assert!(found > 1000);
}

#[test]
fn pairs_overlap_in_the_frames_of_both_bodies() {
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_z(0.6), Vec3::new(0.9, 0.3, 0.0));
    let turned = WorldFromModel::new(turned).unwrap();
    let (mut a, mut b) = (blob(Vec3::ZERO, 1.0), blob(Vec3::ZERO, 0.5));
    let mut walk = Walk::unculled(&mut a, &mut b);
    walk.b.world_from_model = &turned;
    let (a, b) = (walk.a.placed_body().placed, walk.b.placed_body().placed);
    let mut frames = Vec::new();
    with_simd!(walk.a.level, simd => visit_frames(simd, &a, &b, |maps| {
        frames.push(maps.map(|map| map.map(FrameLanes::store)));
        true
    }));
    assert_eq!(frames.len(), 2);
    assert!(frames.iter().all(|frames| walk.push(frames)));
    let expected = walk.overlapping(&frames);
    assert!(
        expected.len() < walk.overlapping(&frames[..1]).len() && expected.len() < walk.overlapping(&frames[1..]).len()
    );
    assert_eq!(walk.sorted(Order::Any), expected);
}

/// The leaf pairs of two rows of cubes in the same places, which are 2 apart.
fn pairs_in(frames: &[Frames]) -> Vec<(u32, u32)> {
    let (mut a, mut b) = (row(&[0.0, 2.0]), row(&[0.0, 2.0]));
    let mut walk = Walk::unculled(&mut a, &mut b);
    assert!(walk.push(&frames[0]));
    for frame in &frames[1..] {
        walk.push(frame);
    }
    walk.sorted(Order::Any)
}

#[test]
fn a_third_frame_takes_the_place_of_the_second() {
    let all_at = |x: f64| frame(DMat3::ZERO, DVec3::X * x);
    let (first, second) = (all_at(0.5), all_at(2.5));
    assert_eq!(pairs_in(&[OWN, first, second]), [(1, 1)]);
    assert_eq!(pairs_in(&[second, OWN, first]), []);
    assert_eq!(pairs_in(&[first, second, OWN]), [(0, 0)]);
}

#[test]
fn a_frame_that_f32_cannot_hold_culls_nothing() {
    let beyond = frame(DMat3::IDENTITY, DVec3::X * 1e39);
    assert_eq!(pairs_in(&[beyond]).len(), 4);
    assert_eq!(pairs_in(&[beyond, OWN]), [(0, 0), (1, 1)]);
    assert_eq!(pairs_in(&[OWN, beyond]), [(0, 0), (1, 1)]);
}

#[test]
fn every_comparison_of_a_node_is_counted() {
    let tests = |places_a: &[f32], places_b: &[f32]| {
        let (mut a, mut b) = (row(places_a), row(places_b));
        let mut walk = Walk::new(&mut a, &mut b);
        walk.pairs(Order::Any);
        walk.walk.node_tests
    };
    // The roots, then the children of the larger root with the other root, then the children of the other root with each of
    // them.
    assert_eq!(tests(&[0.0, 2.0, 4.0], &[0.5, 4.5]), 1 + 3 + 3 * 2);
    assert_eq!(tests(&[0.0, 2.0, 4.0], &[2.0]), 1 + 3);
    assert_eq!(tests(&[2.0], &[0.0, 2.0, 4.0]), 1 + 3);
}

/// A small body in the gap between two children of a large one. Two levels of the large body are opened, none of the small one.
#[test]
fn the_larger_of_two_nodes_is_opened() {
    let two = |x: f32| [Vec3::X * x, Vec3::X * (x + 0.08)];
    let mut large = cubes(&Vec::from_iter((0..8).flat_map(|i| two(0.2 * i as f32))), 0.02);
    let mut small = cubes(&[Vec3::X * 0.04, Vec3::X * 0.044], 0.002);
    let mut tests = |is_swapped| {
        let (a, b) = if is_swapped {
            (&mut small, &mut large)
        } else {
            (&mut large, &mut small)
        };
        let mut walk = Walk::new(a, b);
        assert_eq!(walk.pairs(Order::Any), []);
        walk.walk.node_tests
    };
    assert_eq!([false, true].map(&mut tests), [1 + 8 + 2; 2]);
}

/// The second body is larger only in the units of the first.
#[test]
fn sizes_are_compared_in_the_units_of_the_first_body() {
    let (mut a, mut b) = (row(&[20.0, 25.0]), row(&[0.0, 4.0]));
    let mut walk = Walk::unculled(&mut a, &mut b);
    walk.walk.begin([walk.a.placed_body(), walk.b.placed_body()], 10.0);
    assert!(walk.push(&frame(DMat3::from_diagonal(DVec3::splat(10.0)), DVec3::ZERO)));
    assert_eq!(walk.pairs(Order::Any), []);
    assert_eq!(walk.walk.node_tests, 1 + 2);
}

/// Unit cubes, spaced along x, that reach down into a slab or into other cubes by the given depths.
#[test]
fn the_deepest_pair_comes_first_and_among_equals_the_last() {
    let depths = [
        [0.25, 0.5, 0.75],
        [0.5, 0.25, 0.75],
        [0.75, 0.5, 0.25],
        [0.75, 0.25, 0.5],
        [0.5, 0.5, 0.5],
    ];
    for depths in depths.iter().flat_map(|depths| [&depths[..], &depths[..2]]) {
        let places: Vec<_> = (0..depths.len()).map(|i| Vec3::X * 2.0 * i as f32).collect();
        let lifted: Vec<_> = places
            .iter()
            .zip(depths)
            .map(|(place, depth)| *place + Vec3::Y * (1.0 - depth))
            .collect();
        let (mut many, mut below) = (cubes(&lifted, 1.0), cubes(&places, 1.0));
        let mut slab = cubes(&[Vec3::new(-4.0, -15.0, -8.0)], 16.0);
        let mut expected: Vec<_> = (0..depths.len()).rev().collect();
        expected.sort_by(|&i, &j| depths[j].total_cmp(&depths[i]));
        let expected: Vec<_> = expected.into_iter().map(|i| i as u32).collect();
        let both = Walk::new(&mut many, &mut below).pairs(Order::DeepestFirst);
        let of_a = Walk::new(&mut many, &mut slab).pairs(Order::DeepestFirst);
        let of_b = Walk::new(&mut slab, &mut many).pairs(Order::DeepestFirst);
        assert_eq!(both, Vec::from_iter(expected.iter().map(|&i| (i, i))));
        assert_eq!(of_a, Vec::from_iter(expected.iter().map(|&i| (i, 0))));
        assert_eq!(of_b, Vec::from_iter(expected.iter().map(|&i| (0, i))));
    }
}

#[test]
fn pairs_are_passed_on_one_at_a_time_or_many() {
    let close: Vec<_> = (0..30).map(|i| i as f32 / 30.0).collect();
    let (mut a, mut b) = (row(&close), row(&close));
    let mut walk = Walk::new(&mut a, &mut b);
    let count = walk.pairs(Order::DeepestFirst).len();
    assert_eq!(walk.lists.len(), count);
    assert!(walk.lists.iter().all(|list| list.len() == 1));
    walk.pairs(Order::Any);
    let (last, full) = walk.lists.split_last().unwrap();
    assert!(full.len() > 1 && full.iter().all(|list| list.len() >= LEAF_PAIRS));
    assert!(last.len() < LEAF_PAIRS);
}

#[test]
fn a_walk_ends_where_it_is_told_to() {
    let (mut a, mut b) = (row(&[0.0, 2.0]), row(&[0.0, 2.0]));
    let mut walk = Walk::new(&mut a, &mut b);
    for order in [Order::Any, Order::DeepestFirst] {
        assert!(walk.run_from(&[], order, ControlFlow::Break(())).is_break());
        assert_eq!(walk.lists.len(), 1);
    }
}

#[test]
fn a_front_has_as_many_pairs_as_asked_for_in_the_order_of_the_walk() {
    for radii in [[1.0, 0.4], [0.4, 1.0]] {
        let (mut a, mut b) = (blob(Vec3::ZERO, radii[0]), blob(Vec3::X, radii[1]));
        let mut walk = Walk::new(&mut a, &mut b);
        let expected = walk.pairs(Order::Any);
        let root = (NodeId::ROOT, NodeId::ROOT);
        assert_eq!(walk.walk.front(&mut walk.a, &mut walk.b, 1), [root]);
        for least in [2, 20, 200, usize::MAX] {
            let front = walk.walk.front(&mut walk.a, &mut walk.b, least);
            assert!(front.len() >= least.min(expected.len()));
            assert_eq!(walk.pairs_from(&front, Order::Any), expected);
            let parts = front.iter().map(|part| walk.pairs_from(&[*part], Order::Any));
            assert_eq!(Vec::from_iter(parts).concat(), expected);
        }
    }
}

#[test]
fn pairs_of_a_front_that_do_not_overlap_are_passed_over() {
    let (mut a, mut b) = (row(&[0.0, 2.0, 4.0]), row(&[0.0, 2.0, 4.0]));
    let mut walk = Walk::new(&mut a, &mut b);
    let lanes = |lane| NodeId { group: 1, lane };
    let front: Vec<_> = (0..9).map(|i| (lanes(i / 3), lanes(i % 3))).collect();
    let mut pairs = walk.pairs_from(&front, Order::Any);
    pairs.sort_unstable();
    assert_eq!(pairs, [(0, 0), (1, 1), (2, 2)]);
    assert_eq!(walk.walk.node_tests, 9);
}
