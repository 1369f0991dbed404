//! The triangles of a patch, their boxes and their normals.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use super::vectors::{Corners, cross, dot, load, splat, sub};
use crate::bounds::{Aabb, BoxLanes, LANES, Lanes};
use crate::tree::CornerLanes;

/// Up to eight triangles as structure of arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::query::pairs) struct Patch {
    pub(super) boxes: BoxLanes,
    pub(super) hull: Aabb,
    /// Indexed by corner and coordinate.
    pub(in crate::query::pairs) corners: CornerLanes,
    /// A normal of each triangle, scaled so that its largest coordinate is about 1; zero for degenerate triangles.
    pub(super) normals: [Lanes; 3],
    /// Each triangle's interval along its own normal.
    pub(super) low: Lanes,
    pub(super) high: Lanes,
    /// The longest side of each triangle's box.
    pub(super) span: Lanes,
    /// `span`, divided by the largest coordinate of the normal before it was scaled.
    pub(super) tilt: Lanes,
    /// The largest absolute coordinate; infinite if products could overflow `f32`.
    pub(super) reach: f32,
    /// One bit per triangle.
    lanes: u8,
    pub(in crate::query::pairs) triangles: u8,
    /// The first triangle's position in the order of the tree's leaves.
    pub(in crate::query::pairs) first: u32,
}

impl Patch {
    /// Computes boxes, hull, normals and intervals from the placed corners. Unused lanes must repeat one of the triangles.
    #[inline(always)]
    pub(in crate::query::pairs) fn measure<S: Simd>(&mut self, simd: S, triangles: usize) {
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
    pub(in crate::query::pairs) fn overlaps<S: Simd>(&self, simd: S, other: &Self) -> [u8; 2] {
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

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [load(simd, a), load(simd, b), load(simd, c)]
    }

    /// One triangle in every lane.
    #[inline(always)]
    pub(super) fn splat<S: Simd>(&self, simd: S, lane: usize) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [splat(simd, a, lane), splat(simd, b, lane), splat(simd, c, lane)]
    }
}
