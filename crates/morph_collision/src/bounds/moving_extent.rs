//! Boxes that move, in `f64`, and when they first overlap.

use super::Extent;

/// More than the relative rounding error of a time: two differences, a sum, a quotient and a product (docs/numerics.md).
const TIME_ERROR: f64 = 8.0 * f64::EPSILON;

/// A closed `f64` box at the start and at the end of a motion. In between, its ends are interpolated ([`MovingLanes`](super::MovingLanes)).
pub(crate) type MovingExtent = [Extent; 2];

/// A lower bound of the first time at which two moving boxes overlap; infinite if they never do. Infinite boxes overlap at all times.
pub(crate) fn first_overlap([a_start, a_end]: &MovingExtent, [b_start, b_end]: &MovingExtent) -> f64 {
    let gaps = [
        (b_start.min - a_start.max, b_end.min - a_end.max),
        (a_start.min - b_start.max, a_end.min - b_end.max),
    ];
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (start, end) in gaps {
        for (start, end) in start.to_array().into_iter().zip(end.to_array()) {
            // Positive where the boxes are apart. The sign of a rounded difference is exact.
            if start > 0.0 && end > 0.0 {
                return f64::INFINITY;
            }
            if start > 0.0 {
                first = first.max(start / (start - end) * (1.0 - TIME_ERROR) - f64::MIN_POSITIVE);
            } else if end > 0.0 && end - start < f64::INFINITY {
                last = last.min(start / (start - end) * (1.0 + TIME_ERROR) + f64::MIN_POSITIVE);
            }
        }
    }
    if first <= last { first } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn cube(at: DVec3, size: f64) -> Extent {
        Extent {
            min: at,
            max: at + size,
        }
    }

    #[test]
    fn boxes_meet_when_their_last_gap_closes_and_not_after_the_first_one_opens() {
        let still = [cube(DVec3::ZERO, 1.0); 2];
        let met = |from: DVec3, to: DVec3| first_overlap(&[cube(from, 1.0), cube(to, 1.0)], &still);
        let near = |time: f64, exact: f64| time <= exact && exact - time < 1e-14;
        assert!(near(met(DVec3::X * 3.0, DVec3::X * -1.0), 0.5));
        assert!(near(met(DVec3::new(3.0, -4.0, 0.0), DVec3::new(-1.0, 0.0, 0.0)), 0.75));
        assert_eq!(met(DVec3::X * 0.5, DVec3::X * 5.0), 0.0);
        assert_eq!(met(DVec3::X * 2.0, DVec3::X * 3.0), f64::INFINITY);
        // It has passed along x before it comes down along y.
        assert_eq!(
            met(DVec3::new(3.0, 10.0, 0.0), DVec3::new(-9.0, 0.0, 0.0)),
            f64::INFINITY
        );
        // To one point at the end: not before the end, but for rounding.
        let shrink = |x: f64| [cube(DVec3::X * x, 1.0), cube(DVec3::splat(7.0), 0.0)];
        assert!(near(first_overlap(&shrink(3.0), &shrink(5.0)), 1.0));
        assert_eq!(first_overlap(&shrink(3.0), &shrink(3.5)), 0.0);
        // Huge and infinite boxes.
        let unbounded = [Extent {
            min: DVec3::NEG_INFINITY,
            max: DVec3::INFINITY,
        }; 2];
        assert_eq!(first_overlap(&unbounded, &still), 0.0);
        let far = [cube(DVec3::ZERO, 1.0), cube(DVec3::X * -1.7e308, 1.0)];
        let other = [cube(DVec3::ZERO, 1.0), cube(DVec3::X * 1.7e308, 1.0)];
        assert_eq!(first_overlap(&far, &other), 0.0);
    }
}
