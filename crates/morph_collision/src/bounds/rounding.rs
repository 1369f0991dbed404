//! Unit roundoffs, and conversions to `f32` that round outward.

/// Half a unit in the last place of 1, in `f64`.
pub(crate) const U64: f64 = f64::EPSILON / 2.0;
/// Likewise in `f32`.
pub(super) const U32: f64 = f32::EPSILON as f64 / 2.0;
/// Larger coordinates could overflow in `f32`. Nothing is culled then.
pub(super) const MAX_REACH: f64 = 1e37;

/// The largest `f32` that is not above `value`.
pub(crate) fn down(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) <= value {
        nearest
    } else {
        nearest.next_down()
    }
}

/// The smallest `f32` that is not below `value`.
pub(crate) fn up(value: f64) -> f32 {
    -down(-value)
}
