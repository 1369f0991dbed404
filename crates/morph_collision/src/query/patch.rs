//! Up to eight triangles side by side in `f32`, and what is certain of them and those of another patch.
//!
//! Two of them are turned away where an axis is found along which they are apart by more than every rounding on the way, and
//! any axis will do: how well it was chosen decides the speed alone. The axes are the world's, both normals, and the two
//! products of edges of which one parts triangles that reach through each other's planes (Guigue and Devillers 2003). Where
//! all the signs that these depend on are beyond errors and none parts two triangles, they meet.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use self::vectors::{Corners, cross, dot, one, sub};
use self::verdict::ErrorBounds;
use super::neighbourhood::{Neighbourhood, Placement};
use crate::bounds::{Aabb, BoxLanes, LANES, Lanes, WorldFromModel};
use crate::tree::CornerLanes;

mod vectors;
mod verdict;

/// Up to eight triangles as structure of arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Patch {
    boxes: BoxLanes,
    hull: Aabb,
    /// By corner and coordinate.
    corners: CornerLanes,
    /// Across each triangle; the largest coordinate is about 1, or all are 0.
    normals: [Lanes; 3],
    /// What the triangle spans along its own normal.
    low: Lanes,
    high: Lanes,
    /// The longest side of each triangle's box, and the same for a normal whose largest coordinate is 1.
    span: Lanes,
    tilt: Lanes,
    /// The largest absolute coordinate, or infinite where products would leave `f32`.
    reach: f32,
    /// A bit per triangle.
    lanes: u8,
}

/// The pairs of triangles of two patches: in each row a bit for each triangle of the other one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PatchPairs {
    /// Those that may meet.
    pub(super) near: [u8; LANES],
    /// Those of them that do.
    pub(super) meet: [u8; LANES],
}

impl Patch {
    /// Takes posed triangles to the neighbourhood and measures them; lanes beyond their number repeat one of them.
    #[inline(always)]
    pub(super) fn place<S: Simd>(
        &mut self,
        simd: S,
        posed: &CornerLanes,
        triangles: usize,
        world_from_model: &WorldFromModel,
        neighbourhood: &Neighbourhood,
    ) {
        self.lanes = u8::MAX >> (LANES - triangles.clamp(1, LANES));
        let world = Placement::new(simd, world_from_model, neighbourhood);
        for (rows, posed) in self.corners.iter_mut().zip(posed) {
            world.place(simd, posed, rows);
        }
        self.measure(simd);
    }

    /// Boxes, hull, normals and heights of the corners.
    #[inline(always)]
    fn measure<S: Simd>(&mut self, simd: S) {
        // Coordinates beyond this leave no room for products of four.
        const MOST: f32 = 1e6;
        let [a, b, c] = self.load(simd);
        let (mut least, mut most) = (a, a);
        for i in 0..3 {
            least[i] = a[i].min(b[i]).min(c[i]);
            most[i] = a[i].max(b[i]).max(c[i]);
        }
        let size = sub(most, least);
        let span = size[0].max(size[1]).max(size[2]);
        self.boxes.store(least, most);
        self.hull = self.boxes.hull_of_all();
        let Aabb { min, max } = self.hull;
        let reach = (-min).max(max).max_element().max(0.0);
        self.reach = if reach <= MOST { reach } else { f32::INFINITY };
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

    /// Filters the pairs of triangles; returns whether any pair might intersect.
    ///
    /// `select` is given a triangle of this patch and a mask of triangles of the other with overlapping boxes; it returns those to test.
    #[inline(always)]
    pub(super) fn compare<S: Simd>(
        &self,
        simd: S,
        other: &Self,
        select: impl Fn(usize, u8) -> u8,
        pairs: &mut PatchPairs,
    ) -> bool {
        *pairs = PatchPairs::default();
        let mut own = self.boxes.overlap_mask(simd, &other.hull) & self.lanes;
        if own == 0 {
            return false;
        }
        let others = other.boxes.overlap_mask(simd, &self.hull) & other.lanes;
        if others == 0 {
            return false;
        }
        let errors = ErrorBounds::new(simd, self.reach.max(other.reach));
        let mut any = 0;
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mut near = select(lane, other.boxes.overlap_mask(simd, &self.boxes.get(lane)) & others);
            if near != 0 {
                let verdict = other.judge(simd, self, lane, &errors, near);
                near &= !verdict.apart;
                pairs.near[lane] = near;
                pairs.meet[lane] = near & verdict.meet;
                any |= near;
            }
        }
        any != 0
    }

    #[inline(always)]
    fn load<S: Simd>(&self, simd: S) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [
            [a[0].load(simd), a[1].load(simd), a[2].load(simd)],
            [b[0].load(simd), b[1].load(simd), b[2].load(simd)],
            [c[0].load(simd), c[1].load(simd), c[2].load(simd)],
        ]
    }

    /// One triangle in every lane.
    #[inline(always)]
    fn splat<S: Simd>(&self, simd: S, lane: usize) -> Corners<S> {
        let [a, b, c] = &self.corners;
        [
            [one(simd, &a[0], lane), one(simd, &a[1], lane), one(simd, &a[2], lane)],
            [one(simd, &b[0], lane), one(simd, &b[1], lane), one(simd, &b[2], lane)],
            [one(simd, &c[0], lane), one(simd, &c[1], lane), one(simd, &c[2], lane)],
        ]
    }
}

#[cfg(test)]
mod rounding_tests;
