//! Up to eight triangles side by side in `f32`, and which of them certainly share no point with those of another patch.
//!
//! Nothing here says that triangles meet. Two of them are turned away where an axis is found along which they are apart by
//! more than every rounding on the way, and any axis will do: how well it was chosen decides the speed alone. The axes are
//! the world's, both normals, and the two products of edges of which one parts triangles that reach through each
//! other's planes (Guigue and Devillers 2003).

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use super::neighbourhood::{Neighbourhood, Placement};
use crate::bounds::{BoxLanes, LANES, Lanes, Slab, Volume, WorldFromModel};
use crate::tree::CornerLanes;

type Vector<S> = [f32x8<S>; 3];
type Corners<S> = [Vector<S>; 3];

/// Up to eight triangles as structure of arrays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Patch {
    boxes: BoxLanes,
    hull: Slab<3>,
    /// By corner and coordinate.
    corners: CornerLanes,
    /// Across each triangle; the largest coordinate is about 1, or all are 0.
    normals: [Lanes; 3],
    /// What the triangle spans along its own normal.
    low: Lanes,
    high: Lanes,
    /// The largest absolute coordinate, or infinite where products would leave `f32`.
    reach: f32,
    /// A bit per triangle.
    lanes: u8,
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
        self.boxes.store(least, most);
        self.hull = self.boxes.hull_of_all();
        let Slab { min, max } = &self.hull;
        let mut reach = 0.0_f32;
        for i in 0..3 {
            reach = reach.max(-min[i]).max(max[i]);
        }
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
    }

    /// For each triangle of `self`, which ones of `other` may meet it; says if any may.
    #[inline(always)]
    pub(super) fn near<S: Simd>(&self, simd: S, other: &Self, rows: &mut [u8; LANES]) -> bool {
        *rows = [0; LANES];
        let mut own = self.boxes.overlap_mask(simd, &other.hull) & self.lanes;
        if own == 0 {
            return false;
        }
        let others = other.boxes.overlap_mask(simd, &self.hull) & other.lanes;
        if others == 0 {
            return false;
        }
        let doubt = Doubt::new(simd, self.reach.max(other.reach));
        let mut any = 0;
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mut near = other.boxes.overlap_mask(simd, &self.boxes.get(lane)) & others;
            if near != 0 {
                near &= !other.apart(simd, self, lane, &doubt, near);
            }
            rows[lane] = near;
            any |= near;
        }
        any != 0
    }

    /// Which of these triangles, out of `near`, are certainly apart from one of another patch.
    #[inline(always)]
    fn apart<S: Simd>(&self, simd: S, other: &Self, lane: usize, doubt: &Doubt<S>, near: u8) -> u8 {
        let own = self.load(simd);
        let theirs = other.splat(simd, lane);

        // Their plane.
        let [x, y, z] = &other.normals;
        let normal = [one(simd, x, lane), one(simd, y, lane), one(simd, z, lane)];
        let (low, high) = (one(simd, &other.low, lane), one(simd, &other.high, lane));
        let heights = [dot(normal, own[0]), dot(normal, own[1]), dot(normal, own[2])];
        let (mut apart, own_sides) = split(heights, low, high, doubt.of_normals);

        // Our planes.
        let [x, y, z] = &self.normals;
        let normal = [x.load(simd), y.load(simd), z.load(simd)];
        let heights = [dot(normal, theirs[0]), dot(normal, theirs[1]), dot(normal, theirs[2])];
        let (apart_too, their_sides) = split(heights, self.low.load(simd), self.high.load(simd), doubt.of_normals);
        apart |= apart_too;
        let by_planes = apart.to_bitmask() as u8;
        if near & !by_planes == 0 {
            return by_planes;
        }

        // The edges from the corners that are alone on their sides; the pairs that count depend on which sides these are.
        let [p, q, r] = lone_first(own, own_sides);
        let [u, v, w] = lone_first(theirs, their_sides);
        let [s0, s1, s2] = own_sides;
        let [t0, t1, t2] = their_sides;
        let odd = s0 ^ s1 ^ s2 ^ t0 ^ t1 ^ t2;
        let (v, w) = (choose(odd, w, v), choose(odd, v, w));
        apart |= parted(cross(sub(q, p), sub(v, u)), [p, q, r], [u, v, w], doubt);
        apart |= parted(cross(sub(r, p), sub(w, u)), [p, q, r], [u, v, w], doubt);
        apart.to_bitmask() as u8
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

/// By how much intervals along an axis may come out farther apart than they are.
///
/// A coordinate is rounded once when it is taken to the neighbourhood, and a height three times more, each time by at most
/// `2^-24` of the axis' sum of coordinates times the reach; two heights make 8 of these, their comparison and the bound's own
/// rounding 3 more. Products that underflow add less than `FLOOR`.
struct Doubt<S: Simd> {
    per_length: f32x8<S>,
    floor: f32x8<S>,
    /// For axes whose coordinates are at most 1.
    of_normals: f32x8<S>,
}

impl<S: Simd> Doubt<S> {
    #[inline(always)]
    fn new(simd: S, reach: f32) -> Self {
        const ROUNDINGS: f32 = 16.0 * (f32::EPSILON / 2.0);
        const FLOOR: f32 = 1e-30;
        let per_length = ROUNDINGS * reach;
        Self {
            per_length: f32x8::splat(simd, per_length),
            floor: f32x8::splat(simd, FLOOR),
            of_normals: f32x8::splat(simd, 3.01 * per_length + FLOOR),
        }
    }
}

/// Where three heights are all beyond an interval, and which of them are above its middle.
#[inline(always)]
fn split<S: Simd>(
    [a, b, c]: Vector<S>,
    low: f32x8<S>,
    high: f32x8<S>,
    doubt: f32x8<S>,
) -> (mask32x8<S>, [mask32x8<S>; 3]) {
    let apart = a.min(b).min(c).simd_gt(high + doubt) | a.max(b).max(c).simd_lt(low - doubt);
    // Twice the height, so that nothing is halved.
    let middle = low + high;
    (
        apart,
        [
            (a + a).simd_gt(middle),
            (b + b).simd_gt(middle),
            (c + c).simd_gt(middle),
        ],
    )
}

/// Where two triangles are apart along an axis.
#[inline(always)]
fn parted<S: Simd>(axis: Vector<S>, a: Corners<S>, b: Corners<S>, doubt: &Doubt<S>) -> mask32x8<S> {
    let (a0, a1, a2) = (dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2]));
    let (b0, b1, b2) = (dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2]));
    let error = (axis[0].abs() + axis[1].abs() + axis[2].abs()) * doubt.per_length + doubt.floor;
    let above = a0.min(a1).min(a2) - b0.max(b1).max(b2);
    let below = b0.min(b1).min(b2) - a0.max(a1).max(a2);
    above.max(below).simd_gt(error)
}

/// A triangle turned so that the corner that is alone on its side comes first.
#[inline(always)]
fn lone_first<S: Simd>([a, b, c]: Corners<S>, [sa, sb, sc]: [mask32x8<S>; 3]) -> Corners<S> {
    let (b_alone, c_alone) = (!(sa ^ sc), !(sa ^ sb));
    [
        choose(c_alone, c, choose(b_alone, b, a)),
        choose(c_alone, a, choose(b_alone, c, b)),
        choose(c_alone, b, choose(b_alone, a, c)),
    ]
}

#[inline(always)]
fn choose<S: Simd>(mask: mask32x8<S>, yes: Vector<S>, no: Vector<S>) -> Vector<S> {
    [
        mask.select(yes[0], no[0]),
        mask.select(yes[1], no[1]),
        mask.select(yes[2], no[2]),
    ]
}

#[inline(always)]
fn one<S: Simd>(simd: S, row: &Lanes, lane: usize) -> f32x8<S> {
    f32x8::splat(simd, row.0[lane % LANES])
}

#[inline(always)]
fn sub<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod rounding_tests;
