//! A body's triangles in world space, with equal ones merged, and a binary tree of exact `f64` boxes over them.
//!
//! For bodies that are as small as the rounding errors of their positions. No bounds in `f32` can tell their parts apart, and a walk over
//! their trees would test every pair of triangles. But many of their triangles are equal, and `f64` tells the others apart.

use std::cmp::Ordering;
use std::ops::{ControlFlow, Range};

use crate::bounds::Extent;
use crate::exact::Triangle;
use crate::query::stats::QueryStats;

/// A triangle at `E` moments: at one, or at the start and at the end of a motion.
pub(in crate::query) type AtMoments<const E: usize> = [Triangle; E];

/// A body's triangles, at `E` moments each.
#[derive(Debug)]
pub(in crate::query) struct DistinctTriangles<const E: usize> {
    /// Triangles and their numbers, in ascending order, so that equal triangles are adjacent.
    placed: Vec<(AtMoments<E>, u32)>,
    /// Ranges of equal triangles in `placed`. Each is a leaf of the tree.
    leaves: Vec<Range<usize>>,
    /// In preorder. A tree over `n` leaves has `2 n - 1` nodes.
    nodes: Vec<Node<E>>,
}

impl<const E: usize> Default for DistinctTriangles<E> {
    fn default() -> Self {
        Self {
            placed: Vec::new(),
            leaves: Vec::new(),
            nodes: Vec::new(),
        }
    }
}

#[derive(Debug)]
struct Node<const E: usize> {
    bounds: [Extent; E],
    leaves: Range<usize>,
}

impl<const E: usize> DistinctTriangles<E> {
    /// Replaces the triangles. `O(n log n)`.
    pub(in crate::query) fn fill(&mut self, triangles: impl Iterator<Item = AtMoments<E>>) {
        self.placed.clear();
        self.placed.extend(triangles.zip(0..));
        let key = |(corners, number): &(AtMoments<E>, u32)| {
            let coordinates = corners.map(|triangle| triangle.map(|corner| corner.to_array()));
            (coordinates, *number)
        };
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

    /// Halves the leaves recursively, along the longest side of their box at any moment.
    fn build(&mut self, leaves: Range<usize>) {
        let corners = |leaf: &Range<usize>| &self.placed[leaf.start].0;
        let own = &mut self.leaves[leaves.clone()];
        let mut bounds = [Extent::EMPTY; E];
        for leaf in own.iter() {
            for (bounds, triangle) in bounds.iter_mut().zip(corners(leaf)) {
                *bounds = bounds.union(Extent::of_triangle(triangle));
            }
        }
        let middle = own.len() / 2;
        if middle > 0 {
            let side = |moment: usize| (bounds[moment].max - bounds[moment].min).max_element();
            let moment = (0..E).max_by(|&a, &b| side(a).total_cmp(&side(b))).unwrap_or(0);
            let axis = (bounds[moment].max - bounds[moment].min).max_position();
            let along = |leaf: &Range<usize>| corners(leaf)[moment].iter().map(|corner| corner[axis]).sum::<f64>();
            own.select_nth_unstable_by(middle, |s, t| along(s).total_cmp(&along(t)).then(s.start.cmp(&t.start)));
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
    fn equal(&self, node: usize) -> &[(AtMoments<E>, u32)] {
        &self.placed[self.leaves[self.nodes[node].leaves.start].clone()]
    }
}

/// Walks over the trees of two bodies. The next walk reuses the memory.
#[derive(Debug, Default)]
pub(in crate::query) struct DistinctWalk {
    stack: Vec<(usize, usize)>,
    /// The bound of the pair that was visited last.
    bound: f64,
}

impl DistinctWalk {
    /// Calls `at_pair` for pairs of leaves whose boxes have at most a bound of `limit`, those with lower bounds first, with the equal
    /// triangles of each leaf. `at_pair` returns the new limit, or breaks. Breaks after more than `most` tests of nodes.
    pub(in crate::query) fn run<const E: usize>(
        &mut self,
        [a, b]: [&DistinctTriangles<E>; 2],
        bound: impl Fn(&[Extent; E], &[Extent; E]) -> f64,
        mut limit: f64,
        most: u64,
        stats: &mut QueryStats,
        mut at_pair: impl FnMut(&[(AtMoments<E>, u32)], &[(AtMoments<E>, u32)], &mut QueryStats) -> ControlFlow<(), f64>,
    ) -> ControlFlow<()> {
        let bound = |(i, j): (usize, usize)| bound(&a.nodes[i].bounds, &b.nodes[j].bounds);
        self.stack.clear();
        self.stack
            .extend((!a.nodes.is_empty() && !b.nodes.is_empty()).then_some((0, 0)));
        while let Some((i, j)) = self.stack.pop() {
            stats.node_tests += 1;
            self.bound = bound((i, j));
            if self.bound > limit {
                continue;
            }
            if stats.node_tests > most {
                return ControlFlow::Break(());
            }
            let (len_a, len_b) = (a.nodes[i].leaves.len(), b.nodes[j].leaves.len());
            if len_a == 1 && len_b == 1 {
                stats.triangle_tests += 1;
                limit = at_pair(a.equal(i), b.equal(j), stats)?;
                continue;
            }
            let mut pairs = if len_a >= len_b {
                a.children(i).map(|i| (i, j))
            } else {
                b.children(j).map(|j| (i, j))
            };
            pairs.sort_by(|&p, &q| bound(q).total_cmp(&bound(p)));
            self.stack.extend(pairs);
        }
        ControlFlow::Continue(())
    }

    /// After a walk that broke: the lowest bound of the pair at which it broke and all those that it did not visit.
    pub(in crate::query) fn lowest_left<const E: usize>(
        &self,
        [a, b]: [&DistinctTriangles<E>; 2],
        bound: impl Fn(&[Extent; E], &[Extent; E]) -> f64,
    ) -> f64 {
        let left = self
            .stack
            .iter()
            .map(|&(i, j)| bound(&a.nodes[i].bounds, &b.nodes[j].bounds));
        left.fold(self.bound, f64::min)
    }
}
