//! Pairs of bodies that are tiny compared with their distance from the origin, or with their own rest shape.
//!
//! Rounding errors are then as large as the bodies. No bounds can tell their parts apart, and a walk over their trees would test every
//! pair of triangles. But few of their triangles are different. So this places all triangles in the world, merges those with
//! equal corners, and walks trees of exact `f64` boxes over the rest.

use std::cmp::Ordering;
use std::ops::{ControlFlow, Range};

use glam::DVec3;

use super::body::world_triangle;
use super::pairs::TrianglePair;
use super::placements::Placements;
use super::stats::QueryStats;
use crate::exact::{Facet, Triangle, facets_intersect_counting};
use crate::pose::Posed;

/// The placed triangles of two collapsed bodies. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Collapsed {
    a: DistinctTriangles,
    b: DistinctTriangles,
    stack: Vec<(Node, Node)>,
}

impl Collapsed {
    /// Places both bodies' triangles. Blends every vertex; `O(n log n)`.
    pub(super) fn place(&mut self, a: &mut Posed<'_>, b: &mut Posed<'_>, placements: &Placements<'_>) {
        let (world_from_a, world_from_b) = (placements.world_from_a, placements.world_from_b);
        self.a
            .fill(a.topology.triangle_count(), |n| world_triangle(a, world_from_a, n));
        self.b
            .fill(b.topology.triangle_count(), |n| world_triangle(b, world_from_b, n));
    }

    /// Calls `visitor` for every pair of intersecting triangles until it breaks. Tests triangles with equal corners once.
    pub(super) fn intersecting(
        &mut self,
        stats: &mut QueryStats,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut undecided = 0;
        let flow = self.walk(0.0, stats, |a, b| {
            let facets = [&a, &b].map(|same| Facet::new(same.corners));
            if facets_intersect_counting(&facets[0], &facets[1], &mut undecided) {
                for &triangle_a in a.numbers {
                    for &triangle_b in b.numbers {
                        visitor(TrianglePair { triangle_a, triangle_b })?;
                    }
                }
            }
            ControlFlow::Continue(0.0)
        });
        stats.undecided_by_filter += undecided;
        flow
    }

    /// Calls `visitor` for pairs of triangles whose boxes are at most `limit` apart, nearest boxes first, until it breaks. It
    /// returns the new limit. Limits are squared distances. Of triangles with equal corners it visits the one with the lowest index.
    pub(super) fn nearest(
        &mut self,
        limit: f64,
        stats: &mut QueryStats,
        mut visitor: impl FnMut(TrianglePair, &Triangle, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        self.walk(limit, stats, |a, b| {
            let (triangle_a, triangle_b) = (a.numbers[0], b.numbers[0]);
            visitor(TrianglePair { triangle_a, triangle_b }, &a.corners, &b.corners)
        })
    }

    fn walk(
        &mut self,
        mut limit: f64,
        stats: &mut QueryStats,
        mut at_pair: impl FnMut(SameTriangles<'_>, SameTriangles<'_>) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let Self { a, b, stack } = self;
        let gap = |at_a: &Node, at_b: &Node| a.boxes[at_a.index].squared_distance(&b.boxes[at_b.index]);
        stack.clear();
        stack.extend(a.root().zip(b.root()));
        while let Some((node_a, node_b)) = stack.pop() {
            stats.node_tests += 1;
            if gap(&node_a, &node_b) > limit {
                continue;
            }
            match node_a.split_with(&node_b) {
                Some(mut pairs) => {
                    pairs.sort_by(|(a, b), (c, d)| gap(c, d).total_cmp(&gap(a, b)));
                    stack.extend(pairs);
                }
                None => {
                    stats.triangle_tests += 1;
                    limit = at_pair(a.same(&node_a), b.same(&node_b))?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Triangles with equal corners.
struct SameTriangles<'a> {
    corners: Triangle,
    /// Their indices, ascending.
    numbers: &'a [u32],
}

/// A body's triangles in world space, merged where corners are equal, and a tree of boxes over them.
#[derive(Debug, Default)]
struct DistinctTriangles {
    placed: Vec<(Triangle, u32)>,
    /// In the order of the tree's leaves.
    triangles: Vec<Same>,
    /// Triangle indices, merged triangles side by side.
    numbers: Vec<u32>,
    /// The nodes' boxes in preorder.
    boxes: Vec<ExactBox>,
}

/// Triangles with equal sorted corners.
#[derive(Clone, Debug)]
struct Same {
    corners: Triangle,
    /// Their range in [`DistinctTriangles::numbers`].
    numbers: Range<usize>,
}

impl DistinctTriangles {
    fn fill(&mut self, count: usize, mut corners: impl FnMut(u32) -> Triangle) {
        let Self {
            placed,
            triangles,
            numbers,
            boxes,
        } = self;
        placed.clear();
        placed.extend((0..count as u32).map(|number| {
            let mut corners = corners(number);
            corners.sort_unstable_by(lexicographic);
            (corners, number)
        }));
        placed.sort_unstable_by(|(s, i), (t, j)| compare(s, t).then(i.cmp(j)));
        triangles.clear();
        numbers.clear();
        for (corners, number) in placed.iter() {
            let place = numbers.len();
            numbers.push(*number);
            match triangles.last_mut() {
                Some(same) if compare(&same.corners, corners).is_eq() => same.numbers.end = place + 1,
                _ => triangles.push(Same {
                    corners: *corners,
                    numbers: place..place + 1,
                }),
            }
        }
        boxes.clear();
        if !triangles.is_empty() {
            build(triangles, boxes);
        }
    }

    /// The triangles of a leaf.
    fn same(&self, node: &Node) -> SameTriangles<'_> {
        let Same { corners, numbers } = &self.triangles[node.first];
        SameTriangles {
            corners: *corners,
            numbers: &self.numbers[numbers.clone()],
        }
    }

    fn root(&self) -> Option<Node> {
        let len = self.triangles.len();
        (len > 0).then_some(Node {
            index: 0,
            first: 0,
            len,
        })
    }
}

/// Halves the triangles recursively, along the longest side of their box.
fn build(triangles: &mut [Same], boxes: &mut Vec<ExactBox>) {
    let bounds = triangles
        .iter()
        .map(|same| ExactBox::of(&same.corners))
        .fold(ExactBox::EMPTY, ExactBox::union);
    boxes.push(bounds);
    if triangles.len() < 2 {
        return;
    }
    let axis = (bounds.max - bounds.min).max_position();
    let place = |same: &Same| same.corners.iter().map(|corner| corner[axis]).sum::<f64>();
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |s, t| {
        place(s)
            .total_cmp(&place(t))
            .then(s.numbers.start.cmp(&t.numbers.start))
    });
    let (lower, upper) = triangles.split_at_mut(middle);
    build(lower, boxes);
    build(upper, boxes);
}

/// A node of a binary tree in preorder, over a range of triangles that each node halves.
#[derive(Clone, Copy, Debug)]
struct Node {
    index: usize,
    first: usize,
    len: usize,
}

impl Node {
    fn children(&self) -> [Self; 2] {
        let middle = self.len / 2;
        [
            Self {
                index: self.index + 1,
                first: self.first,
                len: middle,
            },
            Self {
                // A tree over `n` triangles has `2 n - 1` nodes.
                index: self.index + 2 * middle,
                first: self.first + middle,
                len: self.len - middle,
            },
        ]
    }

    /// The pairs that replace two nodes when the larger one is split; `None` for two leaves.
    fn split_with(&self, other: &Self) -> Option<[(Self, Self); 2]> {
        if self.len == 1 && other.len == 1 {
            None
        } else if self.len >= other.len {
            Some(self.children().map(|child| (child, *other)))
        } else {
            Some(other.children().map(|child| (*self, child)))
        }
    }
}

/// A closed `f64` box. Comparing coordinates is exact.
#[derive(Clone, Copy, Debug)]
struct ExactBox {
    min: DVec3,
    max: DVec3,
}

impl ExactBox {
    const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    fn of([a, b, c]: &Triangle) -> Self {
        Self {
            min: a.min(*b).min(*c),
            max: a.max(*b).max(*c),
        }
    }

    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The squared distance, from below but for a few roundings; 0 for boxes that overlap.
    fn squared_distance(&self, other: &Self) -> f64 {
        let gap = (self.min - other.max).max(other.min - self.max).max(DVec3::ZERO);
        gap.length_squared()
    }
}

fn lexicographic(p: &DVec3, q: &DVec3) -> Ordering {
    let [p, q] = [p, q].map(DVec3::to_array);
    p.partial_cmp(&q).unwrap_or(Ordering::Equal)
}

/// Compares sorted corners.
fn compare(s: &Triangle, t: &Triangle) -> Ordering {
    let key = |triangle: &Triangle| triangle.map(|corner| corner.to_array());
    key(s).partial_cmp(&key(t)).unwrap_or(Ordering::Equal)
}
