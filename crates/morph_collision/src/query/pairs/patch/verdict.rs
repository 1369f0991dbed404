//! Tests one triangle against eight: which are certainly apart from it, and which certainly intersect it.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use super::triangles::Patch;
use super::vectors::{Corners, Vector, choose, cross, dot, load, one, splat, sub};

/// What is certain about eight pairs, as bit masks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdict {
    pub(super) apart: u8,
    pub(super) meet: u8,
}

impl Patch {
    /// Tests the triangles in `near` against one triangle of another patch.
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

        // Our corners against their plane.
        let normal = splat(simd, &other.normals, lane);
        let (low, high) = (one(simd, &other.low, lane), one(simd, &other.high, lane));
        let own_sides = Sides::new(normal, own, low, high);
        let mut apart = own_sides.apart(errors.of_normals);

        // Their corners against our planes.
        let normal = load(simd, &self.normals);
        let their_sides = Sides::new(normal, theirs, self.low.load(simd), self.high.load(simd));
        apart |= their_sides.apart(errors.of_normals);
        let by_planes = apart.to_bitmask() as u8;
        if near & !by_planes == 0 {
            return Verdict {
                apart: by_planes,
                meet: 0,
            };
        }

        // The edges from the corner that is alone on its side of the other triangle's plane. The sides decide which pairs of edges
        // to use.
        let [s0, s1, s2] = own_sides.above();
        let [t0, t1, t2] = their_sides.above();
        let [p, q, r] = lone_first(own, [s0, s1, s2]);
        let [u, v, w] = lone_first(theirs, [t0, t1, t2]);
        let own_above = s0 ^ s1 ^ s2;
        let their_above = t0 ^ t1 ^ t2;
        let odd = own_above ^ their_above;
        let (v, w) = (choose(odd, w, v), choose(odd, v, w));
        let step = sub(u, p);
        let axes = [cross(sub(q, p), sub(v, u)), cross(sub(r, p), sub(w, u))];
        let (first, second) = (dot(axes[0], step), dot(axes[1], step));

        // Triangles that cross each other's planes intersect if both products have the right sign. If one has the wrong sign, they are
        // apart.
        let (own_span, their_span) = (self.span.load(simd), one(simd, &other.span, lane));
        let spans = own_span + their_span;
        let error = errors.of_products * (spans * spans) + errors.floor;
        let first_is = (first.simd_gt(error), first.simd_lt(-error));
        let second_is = (second.simd_gt(error), second.simd_lt(-error));
        let tilt = errors.of_tilts * spans;
        let clear = own_sides.clear(errors.of_sides + tilt * one(simd, &other.tilt, lane))
            & their_sides.clear(errors.of_sides + tilt * self.tilt.load(simd));
        let rising = first_is.0 & second_is.1;
        let falling = first_is.1 & second_is.0;
        let not_rising = first_is.1 | second_is.0;
        let not_falling = first_is.0 | second_is.1;
        let meet = clear & (their_above & rising | !their_above & falling);
        apart |= clear & (their_above & not_rising | !their_above & not_falling);
        let (by_signs, meet) = (apart.to_bitmask() as u8, meet.to_bitmask() as u8 & !by_planes);
        if near & !by_signs & !meet == 0 {
            return Verdict { apart: by_signs, meet };
        }

        // If a sign is uncertain, the triangles' intervals along the same axes may still be apart.
        let (first, second) = (
            Along::new(axes[0], [p, q, r], [u, v, w], errors),
            Along::new(axes[1], [p, q, r], [u, v, w], errors),
        );
        apart |= first.apart() | second.apart();
        Verdict {
            apart: apart.to_bitmask() as u8,
            meet,
        }
    }
}

/// Upper bounds for the errors of heights along an axis, and of products of edges. Derived in `docs/numerics.md`.
///
/// Let `R` be the reach and `u = 2^-24`.
///
/// To reject a pair, any axis is valid, so only heights matter. A coordinate is rounded once when it is taken to the
/// neighbourhood, and a height three more times, each by at most `u R` times the sum of the axis's coordinates. That makes 8
/// roundings for two heights; their comparison and the bound itself add 3. Products that underflow add less than `FLOOR`.
///
/// To accept a pair, or to reject it by the sign of a product of three edges, the axes themselves must be accurate. Let `A` and `B`
/// be the spans. The errors are at most:
///
/// - `4.1 u R` for an edge;
/// - `29 u R A` per coordinate for the product of two edges of one triangle;
/// - `14 u R (A + B)` per coordinate for the product of one edge of each.
///
/// Corners of triangles with overlapping boxes are at most `A + B` apart, so the error of a product of three edges is less than
/// `67 u R (A + B)^2`.
pub(super) struct ErrorBounds<S: Simd> {
    pub(super) per_length: f32x8<S>,
    pub(super) floor: f32x8<S>,
    /// For axes with coordinates of at most 1.
    pub(super) of_normals: f32x8<S>,
    /// The same including the normal's own rounding and tilt, for [`Sides::clear`].
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
            // Doubled, because `clearance` doubles the heights.
            of_sides: f32x8::splat(simd, 2.0 * 3.0 * of_normals),
            of_tilts: f32x8::splat(simd, 2.0 * 8.0 * per_length),
            of_products: f32x8::splat(simd, 6.0 * per_length),
        }
    }
}

/// The heights of corners over planes: eight triangles over one plane, or one triangle over eight planes.
pub(super) struct Sides<S: Simd> {
    pub(super) heights: Vector<S>,
    /// The intervals of the planes' own triangles along their normals.
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

    /// The lanes in which all heights lie beyond the interval.
    #[inline(always)]
    fn apart(&self, errors: f32x8<S>) -> mask32x8<S> {
        let [a, b, c] = self.heights;
        a.min(b).min(c).simd_gt(self.high + errors) | a.max(b).max(c).simd_lt(self.low - errors)
    }

    /// Whether each height is above the middle of the interval.
    #[inline(always)]
    pub(super) fn above(&self) -> [mask32x8<S>; 3] {
        let [a, b, c] = self.heights;
        // Doubles the heights instead of halving the sum.
        let middle = self.low + self.high;
        [
            (a + a).simd_gt(middle),
            (b + b).simd_gt(middle),
            (c + c).simd_gt(middle),
        ]
    }

    /// Twice the distance from the interval to the nearest height; negative inside.
    #[inline(always)]
    pub(super) fn clearance(&self) -> f32x8<S> {
        let [a, b, c] = self.heights;
        let middle = self.low + self.high;
        let off = (a + a - middle).abs();
        let off = off.min((b + b - middle).abs()).min((c + c - middle).abs());
        off - (self.high - self.low)
    }

    /// The lanes in which it is certain for every height on which side of the plane it is.
    #[inline(always)]
    fn clear(&self, errors: f32x8<S>) -> mask32x8<S> {
        self.clearance().simd_gt(errors)
    }
}

/// Pairs of triangles projected onto an axis.
pub(super) struct Along<S: Simd> {
    /// The gap between them; negative if they overlap.
    pub(super) gap: f32x8<S>,
    pub(super) error: f32x8<S>,
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
        }
    }

    #[inline(always)]
    fn apart(&self) -> mask32x8<S> {
        self.gap.simd_gt(self.error)
    }
}

/// Rotates a triangle so that the corner that is alone on its side comes first.
#[inline(always)]
pub(super) fn lone_first<S: Simd>([a, b, c]: Corners<S>, [sa, sb, sc]: [mask32x8<S>; 3]) -> Corners<S> {
    let (b_alone, c_alone) = (!(sa ^ sc), !(sa ^ sb));
    [
        choose(c_alone, c, choose(b_alone, b, a)),
        choose(c_alone, a, choose(b_alone, c, b)),
        choose(c_alone, b, choose(b_alone, a, c)),
    ]
}
