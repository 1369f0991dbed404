//! Up to eight triangles side by side in `f32`, tested against those of another patch with error bounds.
//!
//! A pair is rejected if the triangles are apart along some axis by more than the error bound. Any axis is valid; a well-chosen one
//! only saves time. The axes are:
//!
//! - the coordinate axes;
//! - both normals;
//! - two cross products of edges. If the triangles cross each other's planes but are disjoint, one of the two separates them
//!   (Guigue and Devillers 2003).
//!
//! If all signs involved are certain, they say whether the triangles intersect. The caller decides the pairs that are still open.

use std::ops::ControlFlow;

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use self::vectors::{Corners, cross, dot, load, splat, sub};
use self::verdict::ErrorBounds;
use crate::bounds::{Aabb, BoxLanes, LANES, Lanes};
use crate::tree::CornerLanes;

mod vectors;
mod verdict;

/// Up to eight triangles as structure of arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Patch {
    boxes: BoxLanes,
    hull: Aabb,
    /// Indexed by corner and coordinate.
    pub(super) corners: CornerLanes,
    /// A normal of each triangle, scaled so that its largest coordinate is about 1; zero for degenerate triangles.
    normals: [Lanes; 3],
    /// Each triangle's interval along its own normal.
    low: Lanes,
    high: Lanes,
    /// The longest side of each triangle's box.
    span: Lanes,
    /// `span`, divided by the largest coordinate of the normal before it was scaled.
    tilt: Lanes,
    /// The largest absolute coordinate; infinite if products could overflow `f32`.
    reach: f32,
    /// One bit per triangle.
    lanes: u8,
    pub(super) triangles: u8,
    /// The first triangle's position in the order of the tree's leaves.
    pub(super) first: u32,
}

/// The result for one triangle of a patch against the triangles of another patch, as bit masks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) lane: usize,
    /// Triangles that might intersect it.
    pub(super) near: u8,
    /// Those of `near` that certainly intersect it.
    pub(super) meet: u8,
}

impl Patch {
    /// Computes boxes, hull, normals and intervals from the placed corners. Unused lanes must repeat one of the triangles.
    #[inline(always)]
    pub(super) fn measure<S: Simd>(&mut self, simd: S, triangles: usize) {
        self.triangles = triangles.min(LANES) as u8;
        self.lanes = u8::MAX >> (LANES - triangles.clamp(1, LANES));
        // Products of four coordinates above this could overflow.
        const LARGEST: f32 = 1e6;
        let [a, b, c] = self.load(simd);
        let (mut least, mut most) = (a, a);
        for i in 0..3 {
            least[i] = a[i].min(b[i]).min(c[i]);
            most[i] = a[i].max(b[i]).max(c[i]);
        }
        let size = sub(most, least);
        let span = size[0].max(size[1]).max(size[2]);
        self.boxes.store(least, most);
        self.hull = self.boxes.hull_of_all(simd);
        let Aabb { min, max } = self.hull;
        let reach = (-min).max(max).max_element().max(0.0);
        self.reach = if reach <= LARGEST { reach } else { f32::INFINITY };
        let normal = cross(sub(b, a), sub(c, a));
        let largest = normal[0].abs().max(normal[1].abs()).max(normal[2].abs());
        let known = largest.simd_gt(f32x8::splat(simd, f32::MIN_POSITIVE));
        let zero = f32x8::splat(simd, 0.0);
        let inverse = known.select(f32x8::splat(simd, 1.0) / largest, zero);
        let normal = [normal[0] * inverse, normal[1] * inverse, normal[2] * inverse];
        let heights = [dot(normal, a), dot(normal, b), dot(normal, c)];
        for (row, value) in self.normals.iter_mut().zip(normal) {
            value.store_slice(&mut row.0);
        }
        heights[0].min(heights[1]).min(heights[2]).store_slice(&mut self.low.0);
        heights[0].max(heights[1]).max(heights[2]).store_slice(&mut self.high.0);
        span.store_slice(&mut self.span.0);
        (span * inverse).store_slice(&mut self.tilt.0);
    }

    /// Bit masks of the triangles of this patch whose boxes overlap the other's hull, and the reverse. If one mask is 0, both are.
    #[inline(always)]
    pub(super) fn overlaps<S: Simd>(&self, simd: S, other: &Self) -> [u8; 2] {
        if !self.hull.overlaps(&other.hull) {
            return [0; 2];
        }
        let own = self.boxes.overlap_mask(simd, &other.hull) & self.lanes;
        if own == 0 {
            return [0; 2];
        }
        let others = other.boxes.overlap_mask(simd, &self.hull) & other.lanes;
        if others == 0 { [0; 2] } else { [own, others] }
    }

    /// Filters the triangle pairs in the two masks. Calls `found` for every triangle of this patch that might intersect a triangle of
    /// the other.
    ///
    /// `select` takes a triangle of this patch and a mask of the other patch's triangles whose boxes overlap it. It returns the mask
    /// of those to test.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(
        &self,
        simd: S,
        other: &Self,
        [mut own, others]: [u8; 2],
        select: impl Fn(usize, u8) -> u8,
        mut found: impl FnMut(Row) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let errors = ErrorBounds::new(simd, self.reach.max(other.reach));
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mut near = select(lane, other.boxes.overlap_mask(simd, &self.boxes.get(lane)) & others);
            if near != 0 {
                let verdict = other.judge(simd, self, lane, &errors, near);
                near &= !verdict.apart;
                if near != 0 {
                    let meet = near & verdict.meet;
                    found(Row { lane, near, meet })?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [load(simd, a), load(simd, b), load(simd, c)]
    }

    /// One triangle in every lane.
    #[inline(always)]
    fn splat<S: Simd>(&self, simd: S, lane: usize) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [splat(simd, a, lane), splat(simd, b, lane), splat(simd, c, lane)]
    }
}

#[cfg(test)]
mod rounding_tests;
#[cfg(test)]
mod tests;
