//! The minimum of a convex function over a convex set, by the ellipsoid method (Yudin and Nemirovski 1976, Shor 1977).
//!
//! An ellipsoid holds every point that may be better than the best so far. Its centre is either outside the set or has a gradient; both
//! say which part of the ellipsoid holds nothing better. A smaller ellipsoid is put around the rest. Functions whose gradient is a unit
//! vector are at least as small as at the centre, less the half-width along the gradient, so the method knows when it is done.

use glam::{DMat3, DVec3};

use super::super::closest::Closest;

/// Where to look.
pub(super) struct Deepest {
    pub(super) center: DVec3,
    /// The ellipsoid is the image of the unit ball, or of the unit disc around z if the third axis is zero.
    pub(super) axes: DMat3,
    /// How much larger than the smallest value the result may be.
    pub(super) tolerance: f64,
}

/// Each step takes at least a tenth of the volume away. Ten times as many as are needed at most.
const MAX_STEPS: usize = 4000;

/// The point with the smallest value. `outside` and `value` return a convex function and its gradient, a unit vector; the set is where
/// `outside` is at most 0.
pub(super) fn deepest(
    start: &Deepest,
    outside: impl Fn(DVec3) -> (f64, DVec3),
    value: impl Fn(DVec3) -> (f64, DVec3),
) -> Closest {
    // In the coordinates along the axes, the ellipsoid is the image of the unit ball too. So it keeps its digits when it gets flat.
    let is_flat = start.axes.z_axis == DVec3::ZERO;
    let (n, third) = if is_flat { (2.0, 0.0) } else { (3.0, 1.0) };
    let mut ellipsoid = DMat3::from_diagonal(DVec3::new(1.0, 1.0, third));
    let mut offset = DVec3::ZERO;
    let mut best = Closest {
        point: start.center,
        normal: DVec3::ZERO,
        distance: f64::INFINITY,
    };
    for _ in 0..MAX_STEPS {
        let center = start.center + start.axes * offset;
        let (beyond, across) = outside(center);
        let is_inside = beyond <= start.tolerance * 0.25;
        let (surplus, direction) = if is_inside {
            let (distance, normal) = value(center);
            if distance < best.distance {
                best = Closest {
                    point: center,
                    normal,
                    distance,
                };
            }
            (distance - best.distance, normal)
        } else {
            (beyond, across)
        };
        let slope = start.axes.transpose() * direction;
        let in_ball = ellipsoid.transpose() * slope;
        let half_width = in_ball.length();
        // Nothing in the ellipsoid is better, or in the set.
        let is_done = half_width <= surplus + if is_inside { start.tolerance } else { 0.0 };
        if is_done || half_width.is_nan() || half_width == 0.0 {
            break;
        }
        let cut = surplus / half_width;
        let in_ball = in_ball / half_width;
        let step = ellipsoid * in_ball;
        offset -= step * ((1.0 + n * cut) / (n + 1.0));
        let flatten = 1.0 - 2.0 * (1.0 + n * cut) / ((n + 1.0) * (1.0 + cut));
        let grow = n * n * (1.0 - cut * cut) / (n * n - 1.0);
        let thinner = step * (flatten.max(0.0).sqrt() - 1.0);
        let flat = DMat3::from_cols(thinner * in_ball.x, thinner * in_ball.y, thinner * in_ball.z);
        ellipsoid = (ellipsoid + flat) * grow.max(0.0).sqrt();
    }
    best
}
