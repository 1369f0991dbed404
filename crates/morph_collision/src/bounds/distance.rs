//! Lower bounds, in `f32`, on the distance of a body's boxes and triangles from a point or a segment in the world.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::box_map::BoxMap;
use super::gap::diagonal_below;
use super::local::{LocalSpace, map_to_world};
use super::rounding::{MAX_REACH, U32, U64, down, up};
use super::world_query::mapped;
use super::{BoxLanes, Keys, Lanes, LowerBounds, PlacedBounds};
use crate::exact::{power_of_two, power_of_two_below};

/// A segment, which may be a point, prepared for lower bounds on distances. A key is a distance in scaled coordinates.
///
/// The scaled coordinates of a point `x` of the body are `k (x - c)` along each axis, for the segment's middle `c`. The scales `k` are
/// so small that no vector is longer than in the world, times `scale`. Any vector `n` gives a lower bound on the scaled distance of two sets
/// `X` and `S`: `(min n X - max n S) / |n|`. Here `n` is roughly the vector between their closest points, for which the bound is sharp.
/// `docs/numerics.md`, "Boxes and distances", derives how far rounding can increase it.
#[derive(Clone, Debug)]
pub(crate) struct DistanceCull {
    /// The segment's middle in the space of the boxes.
    middle: [f32; 3],
    scales: [f32; 3],
    /// From the middle to an end, in scaled coordinates.
    half: [f32; 3],
    /// 1 over the squared length of `half`; 0 for a point.
    half_inverse: f32,
    scale: f64,
    /// The part of all distances that is not in the keys.
    offset: f64,
    /// By how much keys may be too large.
    slack: f64,
    /// The map of the boxes, if they are not in the space of the segment. Then triangles have no bounds.
    map: Option<BoxMap>,
}

/// Vectors whose squared length is below this, in scaled coordinates, give no bound.
const SHORTEST_SQUARED: f32 = 1.0 / (1_u128 << 100) as f32;

impl DistanceCull {
    /// Distances from the segment between two points, minus `radius`. `corner_error` bounds the error of corners along each axis.
    pub(crate) fn new([p, q]: [DVec3; 2], radius: f64, body: &PlacedBounds, corner_error: f32) -> Self {
        /// Segments farther away than this, relative to the size of the body and of the segment, are moved towards the body: with their
        /// distance, rounding errors grow. Not measured.
        const FAR: f64 = 1000.0;
        /// More than the error of a subnormal coordinate.
        const SUBNORMAL: f64 = power_of_two(-148);
        let world_from_model = body.world_from_model();
        let (space, metric) = faithful_space(body);
        let (middle, half) = (0.5 * (p + q), 0.5 * (q - p));
        let mut from_body = middle - world_from_model.translation();
        let (distance, size) = (from_body.length(), body.spread().length() + half.length());
        let rounded = from_body.abs().max_element() + middle.abs().max_element();
        let mut offset = -radius;
        if distance > FAR * size {
            // Between two points of the body and of the segment, the distance grows by the motion or less. By how much less, is at most
            // the integral of `(size / x)^2` over the distances `x` beyond `FAR size`.
            from_body *= FAR * size / distance;
            offset += distance - (FAR + 1.0 / FAR) * size - 32.0 * U64 * (distance + rounded);
        }
        let (local, half) = (space.linear() * from_body, space.linear() * half);
        let reach = space.magnitude + local.abs() + half.abs();
        let error = space.error(rounded, reach.max_element()) + DVec3::splat(f64::from(corner_error) + SUBNORMAL);
        let map = if space.is_in_model { None } else { map_to_world(body) };
        // False for NaN.
        let is_usable = (error + reach).max_element() <= MAX_REACH && (space.is_in_model || map.is_some());
        if !is_usable {
            return Self::of_everything();
        }
        let root = metric.map(f64::sqrt);
        let largest = power_of_two_below((root * reach).max_element());
        // Scaled to a size of about 1, nothing overflows in `f32`. Clamped for bodies of size 0.
        let scale = largest.clamp(power_of_two(-300), power_of_two(300)).recip();
        let scales = (root * (scale * (1.0 - 4.0 * U64))).min(DVec3::splat(1e38));
        let scaled_half = (scales * half).as_vec3();
        let slack = (scales * (error + 16.0 * U32 * reach)).length() + 16.0 * U32 * (scales * reach).length();
        Self {
            middle: local.as_vec3().to_array(),
            scales: scales.to_array().map(down),
            half: scaled_half.to_array(),
            half_inverse: scaled_half.length_squared().max(f32::MIN_POSITIVE).recip(),
            scale,
            offset,
            slack,
            map,
        }
    }

    fn of_everything() -> Self {
        Self {
            middle: [0.0; 3],
            scales: [0.0; 3],
            half: [0.0; 3],
            half_inverse: 0.0,
            scale: 0.0,
            offset: 0.0,
            slack: f64::INFINITY,
            map: None,
        }
    }

    /// A coordinate along an axis, scaled.
    #[inline(always)]
    fn scaled<S: Simd>(&self, simd: S, row: &Lanes, axis: usize) -> f32x8<S> {
        (row.load(simd) - f32x8::splat(simd, self.middle[axis])) * f32x8::splat(simd, self.scales[axis])
    }

    /// The point of the segment that is closest to some point.
    #[inline(always)]
    fn on_segment<S: Simd>(&self, simd: S, near: &Vectors<S>) -> Vectors<S> {
        let half = self.half_lanes(simd);
        let (one, inverse) = (f32x8::splat(simd, 1.0), f32x8::splat(simd, self.half_inverse));
        let share = (dot(near, &half) * inverse).min(one).max(-one);
        [half[0] * share, half[1] * share, half[2] * share]
    }

    #[inline(always)]
    fn half_lanes<S: Simd>(&self, simd: S) -> Vectors<S> {
        let [x, y, z] = self.half;
        [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
    }

    /// The key that vectors give, if the smallest product of each with its set's points is `least`.
    #[inline(always)]
    fn key_along<S: Simd>(&self, simd: S, vectors: &Vectors<S>, least: f32x8<S>) -> f32x8<S> {
        let squared = dot(vectors, vectors);
        let between = least - dot(vectors, &self.half_lanes(simd)).abs();
        let is_long = squared.simd_gt(f32x8::splat(simd, SHORTEST_SQUARED));
        // Both NaN and negative numbers end as 0.
        is_long.select(between / squared.sqrt(), f32x8::splat(simd, 0.0))
    }

    /// Sets the keys and returns the bit mask of those that are at most the limit.
    #[inline(always)]
    fn within<S: Simd>(&self, simd: S, own: f32x8<S>, limit: f32, keys: &mut Keys) -> u8 {
        own.store_slice(keys);
        !(own.simd_gt(f32x8::splat(simd, limit)).to_bitmask() as u8)
    }
}

/// The space in which distances are bounded, and the diagonal of a matrix below its metric.
fn faithful_space(body: &PlacedBounds) -> (LocalSpace<'_>, DVec3) {
    /// If less of the metric is kept, the axes are so sheared that coordinates say little about lengths. Not measured.
    const SHEARED: f64 = 0.5;
    let in_model = LocalSpace::model(body).and_then(|space| {
        let (metric, kept) = diagonal_below(body.world_from_model().linear());
        (kept > SHEARED).then_some((space, metric))
    });
    in_model.unwrap_or_else(|| (LocalSpace::world(body), DVec3::ONE))
}

/// Eight vectors.
type Vectors<S> = [f32x8<S>; 3];

#[inline(always)]
fn dot<S: Simd>([a, b, c]: &Vectors<S>, [d, e, f]: &Vectors<S>) -> f32x8<S> {
    *a * *d + *b * *e + *c * *f
}

#[inline(always)]
fn minus<S: Simd>([a, b, c]: &Vectors<S>, [d, e, f]: &Vectors<S>) -> Vectors<S> {
    [*a - *d, *b - *e, *c - *f]
}

#[inline(always)]
fn cross<S: Simd>([a, b, c]: &Vectors<S>, [d, e, f]: &Vectors<S>) -> Vectors<S> {
    [*b * *f - *c * *e, *c * *d - *a * *f, *a * *e - *b * *d]
}

/// The points of edges that are closest to the origin. Where both ends are equal, the start.
#[inline(always)]
fn on_edge<S: Simd>(simd: S, start: &Vectors<S>, end: &Vectors<S>) -> Vectors<S> {
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let edge = minus(end, start);
    let length = dot(&edge, &edge).max(f32x8::splat(simd, f32::MIN_POSITIVE));
    let share = (-dot(start, &edge) / length).max(zero).min(one);
    [
        start[0] + edge[0] * share,
        start[1] + edge[1] * share,
        start[2] + edge[2] * share,
    ]
}

/// In each lane, the shorter vector.
#[inline(always)]
fn shorter<S: Simd>(u: &Vectors<S>, v: &Vectors<S>) -> Vectors<S> {
    let is_shorter = dot(u, u).simd_lt(dot(v, v));
    [
        is_shorter.select(u[0], v[0]),
        is_shorter.select(u[1], v[1]),
        is_shorter.select(u[2], v[2]),
    ]
}

impl LowerBounds for DistanceCull {
    fn key(&self, limit: f64) -> f32 {
        let rounding = 8.0 * U64 * (limit.abs() + self.offset.abs());
        let key = (limit - self.offset + rounding) * self.scale + self.slack;
        if key.is_nan() { f32::INFINITY } else { up(key) }
    }

    #[inline(always)]
    fn lower_bounds<S: Simd>(&self, simd: S, boxes: &BoxLanes, lanes: u8, limit: f32, keys: &mut Keys) -> u8 {
        let in_world;
        let boxes = match &self.map {
            None => boxes,
            Some(map) => {
                in_world = mapped(simd, map, boxes);
                &in_world
            }
        };
        let ([l, m, n], [x, y, z]) = (&boxes.min, &boxes.max);
        let low = [
            self.scaled(simd, l, 0),
            self.scaled(simd, m, 1),
            self.scaled(simd, n, 2),
        ];
        let high = [
            self.scaled(simd, x, 0),
            self.scaled(simd, y, 1),
            self.scaled(simd, z, 2),
        ];
        let own = if self.half == [0.0; 3] {
            let zero = f32x8::splat(simd, 0.0);
            let gap = [
                low[0].max(-high[0]).max(zero),
                low[1].max(-high[1]).max(zero),
                low[2].max(-high[2]).max(zero),
            ];
            dot(&gap, &gap).sqrt()
        } else {
            let middle = f32x8::splat(simd, 0.5);
            let center = [
                (low[0] + high[0]) * middle,
                (low[1] + high[1]) * middle,
                (low[2] + high[2]) * middle,
            ];
            let on_segment = self.on_segment(simd, &center);
            let on_box = [
                on_segment[0].max(low[0]).min(high[0]),
                on_segment[1].max(low[1]).min(high[1]),
                on_segment[2].max(low[2]).min(high[2]),
            ];
            // Along each axis, the end of the box that is closer to the segment is the one with the smallest product.
            let between = minus(&on_box, &on_segment);
            self.key_along(simd, &between, dot(&between, &on_box))
        };
        self.within(simd, own, limit, keys) & lanes
    }

    #[inline(always)]
    fn triangles<S: Simd>(&self, simd: S, [a, b, c]: &[[Lanes; 3]; 3], limit: f32, keys: &mut Keys) -> u8 {
        if self.map.is_some() {
            *keys = [f32::NEG_INFINITY; 8];
            return u8::MAX;
        }
        let a = [
            self.scaled(simd, &a[0], 0),
            self.scaled(simd, &a[1], 1),
            self.scaled(simd, &a[2], 2),
        ];
        let b = [
            self.scaled(simd, &b[0], 0),
            self.scaled(simd, &b[1], 1),
            self.scaled(simd, &b[2], 2),
        ];
        let c = [
            self.scaled(simd, &c[0], 0),
            self.scaled(simd, &c[1], 1),
            self.scaled(simd, &c[2], 2),
        ];
        let (mut from_a, mut from_b, mut from_c) = (a, b, c);
        if self.half != [0.0; 3] {
            let third = f32x8::splat(simd, 1.0 / 3.0);
            let center = [
                (a[0] + b[0] + c[0]) * third,
                (a[1] + b[1] + c[1]) * third,
                (a[2] + b[2] + c[2]) * third,
            ];
            let on_segment = self.on_segment(simd, &center);
            from_a = minus(&a, &on_segment);
            from_b = minus(&b, &on_segment);
            from_c = minus(&c, &on_segment);
        }
        let on_outline = shorter(
            &shorter(&on_edge(simd, &from_a, &from_b), &on_edge(simd, &from_b, &from_c)),
            &on_edge(simd, &from_c, &from_a),
        );
        let least = dot(&on_outline, &a).min(dot(&on_outline, &b)).min(dot(&on_outline, &c));
        let of_outline = self.key_along(simd, &on_outline, least);
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let (of_a, of_b, of_c) = (dot(&normal, &a), dot(&normal, &b), dot(&normal, &c));
        let above = of_a.min(of_b).min(of_c);
        let below = of_a.max(of_b).max(of_c);
        let of_plane = self.key_along(simd, &normal, above.max(-below));
        self.within(simd, of_outline.max(of_plane), limit, keys)
    }
}
