//! Eight vectors side by side, as structure of arrays.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, mask32x8};

use crate::bounds::{LANES, Lanes};

pub(super) type Vector<S> = [f32x8<S>; 3];
pub(super) type Corners<S> = [Vector<S>; 3];

#[inline(always)]
pub(super) fn choose<S: Simd>(mask: mask32x8<S>, yes: Vector<S>, no: Vector<S>) -> Vector<S> {
    [
        mask.select(yes[0], no[0]),
        mask.select(yes[1], no[1]),
        mask.select(yes[2], no[2]),
    ]
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> Vector<S> {
    [x.load(simd), y.load(simd), z.load(simd)]
}

#[inline(always)]
pub(super) fn one<S: Simd>(simd: S, row: &Lanes, lane: usize) -> f32x8<S> {
    f32x8::splat(simd, row.0[lane % LANES])
}

/// Copies the vector in one lane to every lane.
#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3], lane: usize) -> Vector<S> {
    [one(simd, x, lane), one(simd, y, lane), one(simd, z, lane)]
}

#[inline(always)]
pub(super) fn sub<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn cross<S: Simd>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(a: Vector<S>, b: Vector<S>) -> f32x8<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
