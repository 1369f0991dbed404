//! What a query about distances looks for.

use std::ops::ControlFlow;

use crate::exact::Triangle;
use crate::query::stats::QueryStats;
use crate::query::two_bodies::Collapsed;
use crate::tree::Leaf;

/// A search among the triangles of two bodies. Limits are squared distances.
pub(super) trait Search {
    /// Pairs of nodes farther apart than this are skipped.
    fn limit(&self) -> f64;

    /// Compares the triangles of two leaves; returns the new limit, or breaks. Counts the pairs that it measures.
    fn at_leaves(&mut self, a: LeafTriangles<'_>, b: LeafTriangles<'_>, tests: &mut u64) -> ControlFlow<(), f64>;

    /// Compares the triangles of two bodies that are too small for a walk over their trees.
    fn at_collapsed(&mut self, bodies: &mut Collapsed, stats: &mut QueryStats);
}

/// A leaf, and its triangles in world space, each with its index.
#[derive(Clone, Copy)]
pub(super) struct LeafTriangles<'l> {
    pub(super) leaf: Leaf,
    pub(super) triangles: &'l [(u32, Triangle)],
}
