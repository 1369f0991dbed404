//! Half units in the last place, and conversions to `f32` that round outward.

/// Half a unit in the last place of 1, in `f64`.
pub(crate) const U64: f64 = f64::EPSILON / 2.0;
/// Half a unit in the last place of 1, in `f32`.
pub(crate) const U32: f64 = f32::EPSILON as f64 / 2.0;

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

/// An `f32` below `low` and one above `high`, each within three units in the last place; without a branch.
#[inline(always)]
pub(crate) fn around(low: f64, high: f64) -> (f32, f32) {
    // Rounding to nearest is off by at most half a unit; the step is at least one.
    let (low, high) = (low as f32, high as f32);
    let step = |value: f32| value.abs() * f32::EPSILON + f32::MIN_POSITIVE;
    (low - step(low), high + step(high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn around_is_outward_and_near() {
        let mut value = 1e-44_f64;
        while value < 1e37 {
            for value in [value, -value, value.next_up(), 0.0] {
                let (low, high) = around(value, value);
                assert!(f64::from(low) < value && value < f64::from(high), "{value}");
                assert!(
                    low >= down(value).next_down().next_down() - 2.0 * f32::MIN_POSITIVE,
                    "{value}"
                );
                assert!(
                    high <= up(value).next_up().next_up() + 2.0 * f32::MIN_POSITIVE,
                    "{value}"
                );
            }
            value *= 1.000_37;
        }
    }
}
