//! The motion of a part of a surface during a step.

use bevy::math::{DMat3, DVec3};

use super::velocities::{fastest, largest};

/// The motion of a rigid body: velocity of its origin, and angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidMotion {
    /// Of the origin.
    pub linear: DVec3,
    /// In radians.
    pub angular: DVec3,
}

impl RigidMotion {
    /// The rigid motion closest to the motion of some points, by weighted least squares. Points are relative to the body's
    /// origin.
    ///
    /// There is no rotation about axes that the points do not determine, such as a line that contains all points.
    pub fn fitted(points: &[DVec3], velocities: &[DVec3], weights: &[f64]) -> Self {
        let all = || points.iter().zip(velocities).zip(weights);
        let total: f64 = weights.iter().sum();
        if total <= 0.0 {
            return Self::default();
        }
        let center = all().map(|((&point, _), &weight)| weight * point).sum::<DVec3>() / total;
        let linear = all().map(|((_, &velocity), &weight)| weight * velocity).sum::<DVec3>() / total;
        // Least squares for `angular x point = velocity - linear`: the equation of a rigid body's angular momentum.
        let (mut inertia, mut momentum) = (DMat3::ZERO, DVec3::ZERO);
        for ((&point, &velocity), &weight) in all() {
            let arm = point - center;
            inertia += weight * DMat3::from_diagonal(DVec3::splat(arm.length_squared()));
            inertia -= weight * DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            momentum += weight * arm.cross(velocity - linear);
        }
        let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        // Slightly more inertia than there is. This changes nothing for a part with some width, and avoids a division by zero.
        let regular = inertia + DMat3::from_diagonal(DVec3::splat(1e-9 * size));
        let angular = regular.inverse() * momentum;
        let angular = if angular.is_finite() { angular } else { DVec3::ZERO };
        let speed = fastest(velocities);
        let arm = (0.5 * size / total).sqrt();
        Self {
            linear: without_noise(linear - angular.cross(center), speed),
            angular: without_noise(angular, speed / arm),
        }
    }

    /// The velocity of a point, relative to the body's origin.
    pub fn at(&self, point: DVec3) -> DVec3 {
        self.linear + self.angular.cross(point)
    }

    /// The weighted error of the motion, in units of velocity.
    pub fn error(&self, points: &[DVec3], velocities: &[DVec3], weights: &[f64]) -> f64 {
        let all = points.iter().zip(velocities).zip(weights);
        largest(all.map(|((&point, &velocity), &weight)| weight * velocity.distance(self.at(point))))
    }
}

/// Replaces components by zero that are too small to change `largest` in `f32`.
///
/// They are rounding errors. Solvers multiply them with each other, down to subnormal numbers, with which processors are slow: a
/// step of Avian with a hundred bodies on a surface took twice as long.
fn without_noise(velocity: DVec3, largest: f64) -> DVec3 {
    let least = largest * f64::from(f32::EPSILON);
    DVec3::select(velocity.abs().cmplt(DVec3::splat(least)), DVec3::ZERO, velocity)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [DVec3; 4] = [
        DVec3::new(1.0, 0.2, 0.0),
        DVec3::new(-0.3, 1.0, 0.4),
        DVec3::new(0.2, -0.7, 1.0),
        DVec3::new(-1.1, 0.1, -0.5),
    ];

    #[test]
    fn rigid_motions_are_found() {
        let (linear, angular) = (DVec3::new(0.3, -2.0, 1.0), DVec3::new(1.0, 0.5, -3.0));
        let velocities = POINTS.map(|p| linear + angular.cross(p));
        for weights in [[1.0; 4], [0.1, 2.0, 0.5, 1.0]] {
            let motion = RigidMotion::fitted(&POINTS, &velocities, &weights);
            assert!(motion.linear.distance(linear) < 1e-7, "{motion:?}");
            assert!(motion.angular.distance(angular) < 1e-7, "{motion:?}");
            assert!(motion.error(&POINTS, &velocities, &weights) < 1e-7);
        }
    }

    #[test]
    fn growing_is_no_motion() {
        let mean = POINTS.iter().sum::<DVec3>() / 4.0;
        let points = POINTS.map(|p| p - mean);
        let velocities = points.map(|p| 0.5 * p);
        let motion = RigidMotion::fitted(&points, &velocities, &[1.0; 4]);
        assert!(
            motion.linear.length() < 1e-12 && motion.angular.length() < 1e-9,
            "{motion:?}"
        );
        assert!(motion.error(&points, &velocities, &[1.0; 4]) > 0.4);
        // The point with the largest weight is exact.
        let motion = RigidMotion::fitted(&points, &velocities, &[1.0, 1e-6, 1e-6, 1e-6]);
        let at_first = motion.linear + motion.angular.cross(points[0]);
        assert!(at_first.distance(velocities[0]) < 1e-5, "{motion:?}");
    }

    #[test]
    fn what_rounding_makes_is_no_motion() {
        // A translation along one axis, and roundings in all directions.
        let velocities = POINTS.map(|p| 6.0 * DVec3::Y + 1e-15 * (p + DVec3::ONE));
        let motion = RigidMotion::fitted(&POINTS, &velocities, &[1.0, 0.3, 0.7, 0.2]);
        assert_eq!(
            (motion.linear.x, motion.linear.z, motion.angular),
            (0.0, 0.0, DVec3::ZERO)
        );
        assert!((motion.linear.y - 6.0).abs() < 1e-12, "{motion:?}");
    }

    #[test]
    fn points_on_a_line_and_single_points_do_not_spin() {
        let on_a_line = [DVec3::X, DVec3::ZERO, -DVec3::X];
        let turning = on_a_line.map(|p| DVec3::new(5.0, 0.0, 2.0).cross(p));
        let motion = RigidMotion::fitted(&on_a_line, &turning, &[1.0; 3]);
        // A rotation about the line itself is not visible.
        assert!(motion.angular.distance(DVec3::new(0.0, 0.0, 2.0)) < 1e-6, "{motion:?}");
        let one = RigidMotion::fitted(&[DVec3::X], &[DVec3::Y], &[1.0]);
        assert_eq!((one.linear, one.angular), (DVec3::Y, DVec3::ZERO));
        assert_eq!(RigidMotion::fitted(&[], &[], &[]), RigidMotion::default());
    }
}
