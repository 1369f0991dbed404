//! How a part of a surface moves during a step.

use bevy::math::{DMat3, DVec3};

/// The motion of a rigid body: velocity of its origin, and angular velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct RigidMotion {
    pub(super) linear: DVec3,
    pub(super) angular: DVec3,
}

impl RigidMotion {
    /// The one closest to the motion of some points, in the sense of least squares; points are relative to their mean.
    ///
    /// About axes that the points do not tell anything about, such as the line that all are on, nothing turns.
    pub(super) fn fitted(points: &[DVec3], velocities: &[DVec3]) -> Self {
        let count = points.len().max(1) as f64;
        let linear = velocities.iter().sum::<DVec3>() / count;
        // Least squares for `angular x point = velocity - linear`: the equation of a rigid body's angular momentum.
        let (mut inertia, mut momentum) = (DMat3::ZERO, DVec3::ZERO);
        for (&p, &velocity) in points.iter().zip(velocities) {
            inertia += DMat3::from_diagonal(DVec3::splat(p.length_squared()));
            inertia -= DMat3::from_cols(p * p.x, p * p.y, p * p.z);
            momentum += p.cross(velocity - linear);
        }
        let size = inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z;
        // A little more inertia than there is: nothing at all for a patch with some width, and no division by zero.
        let regular = inertia + DMat3::from_diagonal(DVec3::splat(1e-9 * size));
        let angular = regular.inverse() * momentum;
        Self {
            linear,
            angular: if angular.is_finite() { angular } else { DVec3::ZERO },
        }
    }
}

/// Whether velocities can be told from a jump: they are small, or they go on from the step before.
///
/// `limit` is the change of velocity that one step may bring. Something that moves faster than that at once is believed
/// when the next step confirms it.
pub(super) fn continuous(velocities: &[DVec3], before: Option<&[DVec3]>, limit: f64) -> bool {
    let speed = velocities.iter().map(|v| v.length()).fold(0.0, f64::max);
    if speed <= limit {
        return true;
    }
    let Some(before) = before else { return false };
    let changes = velocities.iter().zip(before).map(|(v, u)| v.distance(*u));
    changes.fold(0.0, f64::max) <= limit.max(0.5 * speed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around_the_mean() -> Vec<DVec3> {
        let mut points = vec![
            DVec3::new(1.0, 0.2, 0.0),
            DVec3::new(-0.3, 1.0, 0.4),
            DVec3::new(0.2, -0.7, 1.0),
            DVec3::new(-1.1, 0.1, -0.5),
        ];
        let mean = points.iter().sum::<DVec3>() / points.len() as f64;
        points.iter_mut().for_each(|p| *p -= mean);
        points
    }

    #[test]
    fn rigid_motions_are_found() {
        let points = around_the_mean();
        let (linear, angular) = (DVec3::new(0.3, -2.0, 1.0), DVec3::new(1.0, 0.5, -3.0));
        let velocities: Vec<_> = points.iter().map(|&p| linear + angular.cross(p)).collect();
        let motion = RigidMotion::fitted(&points, &velocities);
        assert!(motion.linear.distance(linear) < 1e-7, "{motion:?}");
        assert!(motion.angular.distance(angular) < 1e-7, "{motion:?}");
    }

    #[test]
    fn growing_is_no_motion() {
        let points = around_the_mean();
        let velocities: Vec<_> = points.iter().map(|&p| 0.5 * p).collect();
        let motion = RigidMotion::fitted(&points, &velocities);
        assert!(
            motion.linear.length() < 1e-12 && motion.angular.length() < 1e-9,
            "{motion:?}"
        );
    }

    #[test]
    fn points_on_a_line_and_single_points_do_not_spin() {
        let on_a_line = [DVec3::X, DVec3::ZERO, -DVec3::X];
        let turning = on_a_line.map(|p| DVec3::new(5.0, 0.0, 2.0).cross(p));
        let motion = RigidMotion::fitted(&on_a_line, &turning);
        // Turning about the line itself cannot be seen.
        assert!(motion.angular.distance(DVec3::new(0.0, 0.0, 2.0)) < 1e-6, "{motion:?}");
        let one = RigidMotion::fitted(&[DVec3::ZERO], &[DVec3::Y]);
        assert_eq!(
            one,
            RigidMotion {
                linear: DVec3::Y,
                angular: DVec3::ZERO
            }
        );
        assert_eq!(RigidMotion::fitted(&[], &[]), RigidMotion::default());
    }

    #[test]
    fn jumps_are_told_from_motion() {
        let fast = [DVec3::Y * 12.0];
        assert!(continuous(&[DVec3::Y], None, 1.5));
        assert!(!continuous(&fast, None, 1.5));
        assert!(!continuous(&fast, Some(&[DVec3::ZERO]), 1.5));
        assert!(continuous(&fast, Some(&[DVec3::Y * 11.0]), 1.5));
        assert!(continuous(&fast, Some(&[DVec3::Y * 7.0]), 1.5));
        assert!(!continuous(&fast, Some(&[DVec3::Y * -12.0]), 1.5));
    }
}
