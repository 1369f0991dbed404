//! Fits the boxes of a subtree to its posed vertices, from the leaves up.

use fearless_simd::f32x4;
use fearless_simd::prelude::*;

use super::cache::EpochCache;
use crate::bounds::{Aabb, BoxLanes, Corners, LANES};
use crate::tree::{ChildKind, Topology};

/// The boxes of the groups that have been fitted, as their parents need them. Memory that the next subtree reuses.
#[derive(Clone, Debug, Default)]
pub(super) struct FittedBoxes {
    /// By group, counted from the first one of the subtree.
    hulls: Vec<Corners>,
}

impl FittedBoxes {
    /// Stores the boxes of all groups of a subtree. `vertices` are the positions of all vertices of the mesh; those of the subtree must be
    /// posed. Boxes are larger by `widening` on all sides, and unbounded if it is infinite.
    #[inline(always)]
    pub(super) fn fit<S: Simd>(
        &mut self,
        simd: S,
        topology: &Topology,
        groups: std::ops::Range<usize>,
        vertices: &[[f32; 4]],
        widening: f32,
        boxes: &mut EpochCache<BoxLanes>,
    ) {
        if widening == f32::INFINITY {
            for group in groups {
                unbounded(boxes, group);
            }
            return;
        }
        self.hulls.clear();
        self.hulls.resize(groups.len(), Corners::default());
        // Groups are in preorder, so children come after their parents.
        for group in groups.clone().rev() {
            let slot = boxes.claim(group);
            let mut lanes = [Corners::default(); LANES];
            let mut hull = empty(simd);
            let children = topology.group(group).children();
            for (child, lane) in children.iter().zip(&mut lanes) {
                let [low, high] = match child.kind() {
                    ChildKind::Group(below) => {
                        let [low, high] = &self.hulls[below - groups.start];
                        [f32x4::from_slice(simd, low), f32x4::from_slice(simd, high)]
                    }
                    ChildKind::Leaf(leaf) => around(simd, topology.leaf_vertices(leaf), vertices, widening),
                };
                hull = [hull[0].min(low), hull[1].max(high)];
                low.store_slice(&mut lane[0]);
                high.store_slice(&mut lane[1]);
            }
            let of_group = &mut self.hulls[group - groups.start];
            hull[0].store_slice(&mut of_group[0]);
            hull[1].store_slice(&mut of_group[1]);
            boxes.get_mut(slot).set_corners(simd, &lanes);
        }
    }
}

/// Gives a group boxes without ends, because coordinates are too large to compute with. Returns their slot.
pub(super) fn unbounded(boxes: &mut EpochCache<BoxLanes>, group: usize) -> usize {
    let slot = boxes.claim(group);
    boxes.get_mut(slot).set_all(&Aabb::UNBOUNDED);
    slot
}

#[inline(always)]
fn empty<S: Simd>(simd: S) -> [f32x4<S>; 2] {
    [f32x4::splat(simd, f32::INFINITY), f32x4::splat(simd, f32::NEG_INFINITY)]
}

/// The corners of a box around some vertices.
#[inline(always)]
pub(super) fn around<S: Simd>(simd: S, indices: &[u32], vertices: &[[f32; 4]], widening: f32) -> [f32x4<S>; 2] {
    let [mut low, mut high] = empty(simd);
    for &vertex in indices {
        let position = f32x4::from_slice(simd, &vertices[vertex as usize]);
        low = low.min(position);
        high = high.max(position);
    }
    let by = f32x4::splat(simd, widening);
    [low - by, high + by]
}
