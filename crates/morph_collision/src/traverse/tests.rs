//! Compares the walks over one tree, over a tree against itself, and to the nearest nodes of two trees with brute force over the
//! boxes of all leaves.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::Vec3;

use super::probe::{blob, cubes, leaves, row, triangle};
use super::{NearestStack, Queue, SelfStack, walk_nearest, walk_one, walk_within};
use crate::bounds::{Aabb, Box64, ByBox, LowerBounds};
use crate::pose::Pose;

/// The visited pairs of a body's leaves, without those that share a vertex, and the number of boxes tested.
fn within(pose: &mut Pose, flow: ControlFlow<()>) -> (Vec<(u32, u32)>, u64) {
    let (mut pairs, mut stack) = (Vec::new(), SelfStack::new());
    let bvh = Arc::clone(pose.bvh());
    let tests = walk_within(
        &mut pose.posed(),
        &bvh.self_front().apart,
        &mut stack,
        u64::MAX,
        |posed, a, b| {
            pairs.push((triangle(posed, a), triangle(posed, b)));
            flow
        },
    );
    (pairs, tests)
}

#[test]
fn every_pair_of_leaves_of_a_body_with_overlapping_boxes_is_visited_once() {
    let leaves_of = |pose: &mut Pose| leaves(&mut pose.posed());
    let long = cubes(&Vec::from_iter((0..60).map(|i| Vec3::X * 0.7 * i as f32)), 1.0);
    for mut pose in [blob(Vec3::ZERO, 1.0), long] {
        let boxes = leaves_of(&mut pose);
        let mut expected = Vec::new();
        let corners = |triangle: &u32| pose.bvh().model().corners(*triangle);
        for (i, (triangle, bounds)) in boxes.iter().enumerate() {
            let is_apart = |other| !corners(triangle).iter().any(|vertex| corners(other).contains(vertex));
            let overlapping = boxes[i + 1..]
                .iter()
                .filter(|(other, bounds_of_other)| is_apart(other) && bounds.overlaps(bounds_of_other));
            expected.extend(overlapping.map(|(other, _)| (*triangle.min(other), *triangle.max(other))));
        }
        let (pairs, tests) = within(&mut pose, ControlFlow::Continue(()));
        let all = boxes.len() * (boxes.len() - 1) / 2;
        assert!((pairs.len() as u64..all as u64).contains(&tests));
        let mut pairs = Vec::from_iter(pairs.into_iter().map(|(a, b)| (a.min(b), a.max(b))));
        pairs.sort_unstable();
        expected.sort_unstable();
        assert_eq!(pairs, expected);
    }
}

#[test]
fn siblings_are_compared_once_and_visited_in_their_order() {
    let (pairs, tests) = within(&mut row(&[0.0, 0.5, 3.0, 3.5]), ControlFlow::Continue(()));
    assert_eq!(pairs, [(1, 0), (3, 2)]);
    assert_eq!(tests, 3 + 2 + 1);
}

#[test]
fn a_walk_over_a_tree_and_itself_ends_where_it_is_told_to() {
    let (pairs, _) = within(&mut row(&[0.0, 0.5]), ControlFlow::Break(()));
    assert_eq!(pairs, [(1, 0)]);
}

/// What a walk over one tree did and how it ended.
struct OneByOne {
    visited: Vec<u32>,
    node_tests: u64,
    is_broken: bool,
}

/// Visits leaves in the order of their lower ends along x. `next` is what the callback returns at each leaf.
fn one_by_one(pose: &mut Pose, limit: f64, next: ControlFlow<(), f64>) -> OneByOne {
    let mut visited = Vec::new();
    let mut node_tests = 0;
    let is_ahead = |bounds: &Box64| bounds.center.x + bounds.half.x >= 0.0;
    let bounds = ByBox(|bounds: &Box64| is_ahead(bounds).then_some(bounds.center.x - bounds.half.x));
    let (tree, queue) = (&mut pose.posed(), &mut Queue::default());
    let flow = walk_one(
        tree,
        queue,
        bounds.key(limit),
        &bounds,
        &mut node_tests,
        |tree, leaf, _| {
            visited.push(triangle(tree, leaf));
            next.map_continue(|limit| bounds.key(limit))
        },
    );
    OneByOne {
        visited,
        node_tests,
        is_broken: flow.is_break(),
    }
}

#[test]
fn leaves_are_visited_in_the_order_of_their_bounds_up_to_the_limit() {
    let mut pose = blob(Vec3::X * 0.5, 1.0);
    let mut boxes = leaves(&mut pose.posed());
    boxes.retain(|(_, bounds)| bounds.max.x >= 0.0);
    boxes.sort_by(|(_, a), (_, b)| a.min.x.total_cmp(&b.min.x));
    let begins: Vec<_> = boxes.iter().map(|(_, bounds)| bounds.min.x).collect();
    let limit = begins[begins.len() / 2];
    let walked = one_by_one(&mut pose, limit.into(), ControlFlow::Continue(limit.into()));
    let begin_of = |triangle: &u32| {
        boxes
            .iter()
            .find(|(of, _)| of == triangle)
            .map(|(_, bounds)| bounds.min.x)
    };
    let visited: Vec<_> = walked.visited.iter().filter_map(begin_of).collect();
    assert_eq!(
        visited,
        Vec::from_iter(begins.into_iter().filter(|begin| *begin <= limit))
    );
    assert!(!walked.is_broken);
}

#[test]
fn a_walk_over_one_tree_heeds_a_new_limit_and_a_break() {
    let mut pose = row(&[6.0, 2.0, 4.0, -2.0]);
    let all = one_by_one(&mut pose, 9.0, ControlFlow::Continue(9.0));
    assert_eq!(
        (all.visited, all.node_tests, all.is_broken),
        (vec![1, 2, 0], 1 + 4, false)
    );
    let some = one_by_one(&mut pose, 9.0, ControlFlow::Continue(5.0));
    assert_eq!((some.visited, some.is_broken), (vec![1, 2], false));
    let first = one_by_one(&mut pose, 9.0, ControlFlow::Break(()));
    assert_eq!((first.visited, first.is_broken), (vec![1], true));
}

/// The largest gap between two boxes along a coordinate axis; 0 if they overlap.
fn gap(a: &Aabb, b: &Aabb) -> f64 {
    (a.min - b.max).max(b.min - a.max).max(Vec3::ZERO).max_element().into()
}

/// The leaf pairs visited within a limit, and the number of node pairs tested. `next` is what the callback returns at each pair.
fn nearest(a: &mut Pose, b: &mut Pose, limit: f64, next: ControlFlow<(), f64>) -> (Vec<(u32, u32)>, u64) {
    let (mut pairs, mut stack) = (Vec::new(), NearestStack::new());
    let (a, b) = (&mut a.posed(), &mut b.posed());
    let tests = walk_nearest(a, b, 1.0, &mut stack, limit, gap, |a, b, of_a, of_b| {
        pairs.push((triangle(a, of_a), triangle(b, of_b)));
        next
    });
    (pairs, tests)
}

#[test]
fn every_pair_of_leaves_within_the_limit_is_visited_once() {
    let bodies = || [blob(Vec3::ZERO, 1.0), blob(Vec3::X * 2.0, 0.3), cubes(&[Vec3::Y], 1.0)];
    for a in &mut bodies() {
        for b in &mut bodies() {
            let (boxes_a, boxes_b) = (leaves(&mut a.posed()), leaves(&mut b.posed()));
            let of_a = |(a, box_a): &(u32, Aabb)| {
                Vec::from_iter(boxes_b.iter().map(|(b, box_b)| (gap(box_a, box_b), (*a, *b))))
            };
            let mut pairs: Vec<_> = boxes_a.iter().flat_map(of_a).collect();
            pairs.sort_by(|(x, _), (y, _)| x.total_cmp(y));
            let limit = pairs[pairs.len() / 2].0;
            let mut expected: Vec<_> = pairs
                .into_iter()
                .filter(|(gap, _)| *gap <= limit)
                .map(|(_, pair)| pair)
                .collect();
            let (mut visited, _) = nearest(a, b, limit, ControlFlow::Continue(limit));
            expected.sort_unstable();
            visited.sort_unstable();
            assert_eq!(visited, expected);
        }
    }
}

#[test]
fn the_nearest_leaves_are_visited_first_and_among_equals_the_first() {
    let mut many = row(&[0.0, 10.0, 20.0, 30.0]);
    let mut one = row(&[14.0]);
    let on = ControlFlow::Continue(99.0);
    assert_eq!(
        nearest(&mut many, &mut one, 99.0, on),
        (vec![(1, 0), (2, 0), (0, 0), (3, 0)], 1 + 4)
    );
    assert_eq!(
        nearest(&mut one, &mut many, 99.0, on),
        (vec![(0, 1), (0, 2), (0, 0), (0, 3)], 1 + 4)
    );
    let mut between = row(&[15.0]);
    let (pairs, _) = nearest(&mut many, &mut between, 4.0, on);
    assert_eq!(pairs, [(1, 0), (2, 0)]);
}

#[test]
fn a_walk_to_the_nearest_heeds_a_new_limit_and_a_break() {
    let (mut many, mut one) = (row(&[0.0, 10.0, 20.0, 30.0]), row(&[14.0]));
    let (pairs, _) = nearest(&mut many, &mut one, 99.0, ControlFlow::Continue(5.0));
    assert_eq!(pairs, [(1, 0), (2, 0)]);
    let (pairs, _) = nearest(&mut many, &mut one, 99.0, ControlFlow::Break(()));
    assert_eq!(pairs, [(1, 0)]);
}

/// A body in the gap of another one that is larger in the world but looks smaller in its own space, whose unit is ten times as
/// long.
#[test]
fn the_larger_of_two_nodes_is_opened_on_the_way_to_the_nearest() {
    const SCALE: f32 = 10.0;
    let scaled = |bounds: &Aabb| Aabb {
        min: bounds.min * SCALE,
        max: bounds.max * SCALE,
    };
    let (mut small, mut large) = (row(&[13.0, 35.0]), row(&[0.0, 4.0]));
    let (stack, limit) = (&mut NearestStack::new(), 1.0);
    let tests = walk_nearest(
        &mut small.posed(),
        &mut large.posed(),
        SCALE,
        stack,
        limit,
        |a, b| gap(a, &scaled(b)),
        |_, _, _, _| unreachable!(),
    );
    assert_eq!(tests, 1 + 2);
    let tests = walk_nearest(
        &mut large.posed(),
        &mut small.posed(),
        1.0 / SCALE,
        stack,
        limit,
        |a, b| gap(&scaled(a), b),
        |_, _, _, _| unreachable!(),
    );
    assert_eq!(tests, 1 + 2);
}
