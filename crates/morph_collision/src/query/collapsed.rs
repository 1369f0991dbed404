//! Queries for pairs of bodies that are tiny compared with their distance from the origin, or with their own rest shape.
//!
//! Rounding errors are then as large as the bodies. No bounds can tell their parts apart, and a walk over their trees would test every
//! pair of triangles. But many of their triangles are equal. So this module places all triangles in the world, merges those with equal
//! corners, and walks trees of exact `f64` boxes over the rest.

use std::cmp::Ordering;
use std::ops::{ControlFlow, Range};

use super::pairs::TrianglePair;
use super::stats::QueryStats;
use crate::bounds::Extent;
use crate::exact::{Facet, Triangle, facets_intersect_counting, sorted};
use crate::pose::Posed;

/// The placed triangles of two collapsed bodies. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct Collapsed {
    a: DistinctTriangles,
    b: DistinctTriangles,
    stack: Vec<(usize, usize)>,
}

impl Collapsed {
    /// Places both bodies' triangles. Blends every vertex; `O(n log n)`.
    pub(super) fn place(&mut self, a: &mut Posed<'_>, b: &mut Posed<'_>) {
        self.a.fill(a);
        self.b.fill(b);
    }

    /// Calls `visitor` for every pair of intersecting triangles until it breaks. Tests triangles with equal corners only once.
    pub(super) fn intersecting(
        &mut self,
        stats: &mut QueryStats,
        visitor: &mut dyn FnMut(TrianglePair) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let mut undecided = 0;
        let flow = self.walk(0.0, stats, |a, b| {
            if facets_intersect_counting(&Facet::new(a[0].0), &Facet::new(b[0].0), &mut undecided) {
                for &(_, triangle_a) in a {
                    for &(_, triangle_b) in b {
                        visitor(TrianglePair { triangle_a, triangle_b })?;
                    }
                }
            }
            ControlFlow::Continue(0.0)
        });
        stats.undecided_by_filter += undecided;
        flow
    }

    /// Calls `visitor` for pairs of triangles whose boxes are at most `limit` apart, nearest boxes first, until it breaks. `visitor`
    /// returns the new limit. Limits are squared distances. Of triangles with equal corners, only the one with the lowest index is
    /// visited.
    pub(super) fn nearest(
        &mut self,
        limit: f64,
        stats: &mut QueryStats,
        mut visitor: impl FnMut(TrianglePair, &Triangle, &Triangle) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        self.walk(limit, stats, |a, b| {
            let ((corners_a, triangle_a), (corners_b, triangle_b)) = (a[0], b[0]);
            visitor(TrianglePair { triangle_a, triangle_b }, &corners_a, &corners_b)
        })
    }

    /// Calls `at_pair` for pairs of leaves, with the equal triangles of each leaf. `at_pair` returns the new limit.
    fn walk(
        &mut self,
        mut limit: f64,
        stats: &mut QueryStats,
        mut at_pair: impl FnMut(&[(Triangle, u32)], &[(Triangle, u32)]) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let Self { a, b, stack } = self;
        let gap = |(i, j): (usize, usize)| a.nodes[i].bounds.squared_distance(&b.nodes[j].bounds);
        stack.clear();
        stack.extend((!a.nodes.is_empty() && !b.nodes.is_empty()).then_some((0, 0)));
        while let Some((i, j)) = stack.pop() {
            stats.node_tests += 1;
            if gap((i, j)) > limit {
                continue;
            }
            let (len_a, len_b) = (a.nodes[i].leaves.len(), b.nodes[j].leaves.len());
            if len_a == 1 && len_b == 1 {
                stats.triangle_tests += 1;
                limit = at_pair(a.equal(i), b.equal(j))?;
                continue;
            }
            let mut pairs = if len_a >= len_b {
                a.children(i).map(|i| (i, j))
            } else {
                b.children(j).map(|j| (i, j))
            };
            pairs.sort_by(|&p, &q| gap(q).total_cmp(&gap(p)));
            stack.extend(pairs);
        }
        ControlFlow::Continue(())
    }
}

/// A body's triangles in world space, with equal ones merged, and a binary tree over them.
#[derive(Debug, Default)]
struct DistinctTriangles {
    /// The triangles' sorted corners and indices, in ascending order, so that equal triangles are adjacent.
    placed: Vec<(Triangle, u32)>,
    /// Ranges of equal triangles in `placed`. Each is a leaf of the tree.
    leaves: Vec<Range<usize>>,
    /// In preorder. A tree over `n` leaves has `2 n - 1` nodes.
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    bounds: Extent,
    leaves: Range<usize>,
}

impl DistinctTriangles {
    fn fill(&mut self, tree: &mut Posed<'_>) {
        self.placed.clear();
        let triangles = 0..tree.topology.triangle_count() as u32;
        self.placed
            .extend(triangles.map(|number| (sorted(tree.world_triangle(number)), number)));
        let key = |(corners, number): &(Triangle, u32)| (corners.map(|corner| corner.to_array()), *number);
        let ascending = |s: &_, t: &_| key(s).partial_cmp(&key(t)).unwrap_or(Ordering::Equal);
        self.placed.sort_unstable_by(ascending);
        self.leaves.clear();
        for equal in self.placed.chunk_by(|s, t| s.0 == t.0) {
            let start = self.leaves.last().map_or(0, |leaf| leaf.end);
            self.leaves.push(start..start + equal.len());
        }
        self.nodes.clear();
        if !self.leaves.is_empty() {
            self.build(0..self.leaves.len());
        }
    }

    /// Halves the leaves recursively, along the longest side of their box.
    fn build(&mut self, leaves: Range<usize>) {
        let corners = |leaf: &Range<usize>| &self.placed[leaf.start].0;
        let own = &mut self.leaves[leaves.clone()];
        let extents = own.iter().map(|leaf| Extent::of_triangle(corners(leaf)));
        let bounds = extents.fold(Extent::EMPTY, Extent::union);
        let axis = (bounds.max - bounds.min).max_position();
        let middle = own.len() / 2;
        if middle > 0 {
            let place = |leaf: &Range<usize>| corners(leaf).iter().map(|corner| corner[axis]).sum::<f64>();
            own.select_nth_unstable_by(middle, |s, t| place(s).total_cmp(&place(t)).then(s.start.cmp(&t.start)));
        }
        self.nodes.push(Node {
            bounds,
            leaves: leaves.clone(),
        });
        if middle > 0 {
            let split = leaves.start + middle;
            self.build(leaves.start..split);
            self.build(split..leaves.end);
        }
    }

    /// The children of a node, which must have at least two leaves.
    fn children(&self, node: usize) -> [usize; 2] {
        let middle = self.nodes[node].leaves.len() / 2;
        [node + 1, node + 2 * middle]
    }

    /// The equal triangles of a leaf.
    fn equal(&self, node: usize) -> &[(Triangle, u32)] {
        &self.placed[self.leaves[self.nodes[node].leaves.start].clone()]
    }
}
