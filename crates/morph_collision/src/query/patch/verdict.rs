//! One triangle against eight: which ones are certainly apart from it, and which ones certainly meet it.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use super::Patch;
use super::vectors::{Corners, Vector, choose, cross, dot, one, sub};

/// What is certain of eight pairs, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    pub(super) apart: u8,
    pub(super) meet: u8,
}

impl Patch {
    /// These triangles, of which the ones in `near` count, against one of another patch.
    #[inline(always)]
    pub(super) fn judge<S: Simd>(
        &self,
        simd: S,
        other: &Self,
        lane: usize,
        errors: &ErrorBounds<S>,
        near: u8,
    ) -> Verdict {
        let own = self.load(simd);
        let theirs = other.splat(simd, lane);

        // Their plane.
        let [x, y, z] = &other.normals;
        let normal = [one(simd, x, lane), one(simd, y, lane), one(simd, z, lane)];
        let (low, high) = (one(simd, &other.low, lane), one(simd, &other.high, lane));
        let own_sides = Sides::new(normal, own, low, high);
        let mut apart = own_sides.apart(errors.of_normals);

        // Our planes.
        let [x, y, z] = &self.normals;
        let normal = [x.load(simd), y.load(simd), z.load(simd)];
        let their_sides = Sides::new(normal, theirs, self.low.load(simd), self.high.load(simd));
        apart |= their_sides.apart(errors.of_normals);
        let by_planes = apart.to_bitmask() as u8;
        if near & !by_planes == 0 {
            return Verdict {
                apart: by_planes,
                meet: 0,
            };
        }

        // The edges from the corners that are alone on their sides; the pairs that count depend on which sides these are.
        let [s0, s1, s2] = own_sides.above();
        let [t0, t1, t2] = their_sides.above();
        let [p, q, r] = lone_first(own, [s0, s1, s2]);
        let [u, v, w] = lone_first(theirs, [t0, t1, t2]);
        let own_above = s0 ^ s1 ^ s2;
        let their_above = t0 ^ t1 ^ t2;
        let odd = own_above ^ their_above;
        let (v, w) = (choose(odd, w, v), choose(odd, v, w));
        let first = Along::new(cross(sub(q, p), sub(v, u)), [p, q, r], [u, v, w], errors);
        let second = Along::new(cross(sub(r, p), sub(w, u)), [p, q, r], [u, v, w], errors);
        apart |= first.apart() | second.apart();
        let apart = apart.to_bitmask() as u8;
        if near & !apart == 0 {
            return Verdict { apart, meet: 0 };
        }

        // Triangles that reach through each other's planes meet if both products say so.
        let (own_span, their_span) = (self.span.load(simd), one(simd, &other.span, lane));
        let spans = own_span + their_span;
        let error = errors.of_products * (spans * spans);
        let rising = first.step.simd_gt(first.error + error) & second.step.simd_lt(-(second.error + error));
        let falling = first.step.simd_lt(-(first.error + error)) & second.step.simd_gt(second.error + error);
        let tilt = errors.of_tilts * spans;
        let meet = (their_above & rising | !their_above & falling)
            & own_sides.clear(errors.of_sides + tilt * one(simd, &other.tilt, lane))
            & their_sides.clear(errors.of_sides + tilt * self.tilt.load(simd));
        Verdict {
            apart,
            meet: meet.to_bitmask() as u8 & !apart,
        }
    }
}

/// By how much heights along an axis, and products, may come out farther from zero than they are.
///
/// With `R` the reach and `u = 2^-24`:
///
/// A coordinate is rounded once when it is taken to the neighbourhood, and a height three times more, each time by at most
/// `u` of the axis' sum of coordinates times `R`; two heights make 8 of these, their comparison and the bound's own rounding
/// 3 more. Products that underflow add less than `FLOOR`. That is all there is to triangles being apart, for which any axis
/// will do.
///
/// That they meet takes the right axes. With spans `A` and `B`, the edges of both triangles are known within `4.1 u R`, the
/// product of two edges of one within `29 u R A` in each coordinate, of one of each within `14 u R (A + B)`; no two corners
/// of triangles whose boxes overlap are farther from each other than `A + B`. See `docs/numerics.md`.
pub(super) struct ErrorBounds<S: Simd> {
    pub(super) per_length: f32x8<S>,
    pub(super) floor: f32x8<S>,
    /// For axes whose coordinates are at most 1.
    pub(super) of_normals: f32x8<S>,
    /// The same with a normal's own rounding, and that of its tilt; for [`Sides::clear`].
    pub(super) of_sides: f32x8<S>,
    pub(super) of_tilts: f32x8<S>,
    pub(super) of_products: f32x8<S>,
}

impl<S: Simd> ErrorBounds<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, reach: f32) -> Self {
        const ROUNDINGS: f32 = 16.0 * (f32::EPSILON / 2.0);
        const FLOOR: f32 = 1e-30;
        let per_length = ROUNDINGS * reach;
        let of_normals = 3.01 * per_length + FLOOR;
        Self {
            per_length: f32x8::splat(simd, per_length),
            floor: f32x8::splat(simd, FLOOR),
            of_normals: f32x8::splat(simd, of_normals),
            // Twice, as heights are there.
            of_sides: f32x8::splat(simd, 2.0 * 3.0 * of_normals),
            of_tilts: f32x8::splat(simd, 2.0 * 8.0 * per_length),
            of_products: f32x8::splat(simd, 4.0 * per_length),
        }
    }
}

/// Where the corners of triangles are beside planes, or the other way round.
pub(super) struct Sides<S: Simd> {
    pub(super) heights: Vector<S>,
    /// What the planes' own triangles span along their normals.
    pub(super) low: f32x8<S>,
    pub(super) high: f32x8<S>,
}

impl<S: Simd> Sides<S> {
    #[inline(always)]
    pub(super) fn new(normal: Vector<S>, corners: Corners<S>, low: f32x8<S>, high: f32x8<S>) -> Self {
        let [a, b, c] = corners;
        Self {
            heights: [dot(normal, a), dot(normal, b), dot(normal, c)],
            low,
            high,
        }
    }

    /// Where all heights are beyond the interval.
    #[inline(always)]
    fn apart(&self, errors: f32x8<S>) -> mask32x8<S> {
        let [a, b, c] = self.heights;
        a.min(b).min(c).simd_gt(self.high + errors) | a.max(b).max(c).simd_lt(self.low - errors)
    }

    /// Which heights are above the interval's middle.
    #[inline(always)]
    pub(super) fn above(&self) -> [mask32x8<S>; 3] {
        let [a, b, c] = self.heights;
        // Twice the height, so that nothing is halved.
        let middle = self.low + self.high;
        [
            (a + a).simd_gt(middle),
            (b + b).simd_gt(middle),
            (c + c).simd_gt(middle),
        ]
    }

    /// How far outside of the interval the nearest of the heights is, twice; below 0 where it is inside.
    #[inline(always)]
    pub(super) fn clearance(&self) -> f32x8<S> {
        let [a, b, c] = self.heights;
        let middle = self.low + self.high;
        let off = (a + a - middle).abs();
        let off = off.min((b + b - middle).abs()).min((c + c - middle).abs());
        off - (self.high - self.low)
    }

    /// Where no height is in errors about its side.
    #[inline(always)]
    fn clear(&self, errors: f32x8<S>) -> mask32x8<S> {
        self.clearance().simd_gt(errors)
    }
}

/// Two triangles along an axis.
pub(super) struct Along<S: Simd> {
    /// By how much one is beyond the other; below 0 where they overlap.
    pub(super) gap: f32x8<S>,
    pub(super) error: f32x8<S>,
    /// From the first corner of one to that of the other.
    pub(super) step: f32x8<S>,
}

impl<S: Simd> Along<S> {
    #[inline(always)]
    pub(super) fn new(axis: Vector<S>, a: Corners<S>, b: Corners<S>, errors: &ErrorBounds<S>) -> Self {
        let (a0, a1, a2) = (dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2]));
        let (b0, b1, b2) = (dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2]));
        let above = a0.min(a1).min(a2) - b0.max(b1).max(b2);
        let below = b0.min(b1).min(b2) - a0.max(a1).max(a2);
        Self {
            gap: above.max(below),
            error: (axis[0].abs() + axis[1].abs() + axis[2].abs()) * errors.per_length + errors.floor,
            step: b0 - a0,
        }
    }

    #[inline(always)]
    fn apart(&self) -> mask32x8<S> {
        self.gap.simd_gt(self.error)
    }
}

/// A triangle turned so that the corner that is alone on its side comes first.
#[inline(always)]
pub(super) fn lone_first<S: Simd>([a, b, c]: Corners<S>, [sa, sb, sc]: [mask32x8<S>; 3]) -> Corners<S> {
    let (b_alone, c_alone) = (!(sa ^ sc), !(sa ^ sb));
    [
        choose(c_alone, c, choose(b_alone, b, a)),
        choose(c_alone, a, choose(b_alone, c, b)),
        choose(c_alone, b, choose(b_alone, a, c)),
    ]
}
