//! All boxes at once, fitted to the vertices: what every other method does, and what pays where nearly all of a tree is
//! looked at anyway.

use super::anchor::fit_bottom_up;
use super::posed::Posed;
use crate::bounds::{BoxLanes, with_simd};

impl Posed<'_> {
    /// Makes every group's boxes tight, from the leaves up; those that were blended are replaced. `O(n)`.
    pub(super) fn refit(&mut self) {
        let topology = self.topology;
        let mut boxes = vec![BoxLanes::default(); topology.group_count()];
        let mut corners = std::mem::take(&mut self.scratch.corners);
        fit_bottom_up(topology, &mut boxes, |leaf| {
            corners.clear();
            self.leaf_corners(leaf, &mut corners);
            with_simd!(self.level, simd => BoxLanes::around(simd, &corners))
        });
        self.scratch.corners = corners;
        self.boxes.next_epoch();
        for (group, boxes) in boxes.into_iter().enumerate() {
            self.boxes.insert(group, boxes);
            self.blended.volumes += topology.group(group).children().len() as u64;
        }
    }
}
