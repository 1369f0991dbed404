//! All volumes at once, fitted to the vertices: what every other method does, and what pays where nearly all of a tree is
//! looked at anyway.

use std::mem;

use super::posed::Posed;
use crate::bounds::{Volume, with_simd};
use crate::tree::ChildKind;

impl<V: Volume> Posed<'_, V> {
    /// Makes every group's volumes tight, from the leaves up; those that were blended are replaced. `O(n)`.
    pub(super) fn refit(&mut self) {
        let topology = self.topology;
        let mut corners = mem::take(&mut self.scratch.corners);
        self.volumes.next_epoch();
        // Groups are in preorder: children come later, and slots are numbered from the last group on.
        let groups = topology.group_count();
        let slot_of = |group: usize| groups - 1 - group;
        for group in (0..groups).rev() {
            let mut volumes = V::default();
            for (lane, child) in topology.group(group).children().iter().enumerate() {
                match child.kind() {
                    ChildKind::Group(below) => {
                        let mask = topology.group(below).mask();
                        volumes.set(lane, &self.volumes.get(slot_of(below)).hull(mask));
                    }
                    ChildKind::Leaf(leaf) => {
                        corners.clear();
                        self.leaf_corners(leaf, &mut corners);
                        with_simd!(self.level, simd => volumes.fit_corners(simd, lane, &corners));
                    }
                }
            }
            self.volumes.insert(group, volumes);
            self.blended.volumes += topology.group(group).children().len() as u64;
        }
        self.scratch.corners = corners;
    }
}
