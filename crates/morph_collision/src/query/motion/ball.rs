//! Points and balls that move.

use glam::DVec3;

use super::triangle::MovingTriangle;
use super::{MotionContact, SurfaceImpact};
use crate::InputError;
use crate::exact::closest_on_triangle;
use crate::exact::motion::{MovingPoint, ball_impact, relative_to};
use crate::input_error::{check_number, check_point};

/// A ball whose center moves on a straight line. With radius 0, it is a point.
///
/// ```
/// use glam::DVec3;
/// use morph_collision::motion::{MovingBall, MovingPoint};
///
/// let flight = MovingPoint::new(DVec3::ZERO, DVec3::X * 5.0);
/// assert_eq!(MovingBall::new(flight, 0.5)?.radius(), 0.5);
/// assert!(MovingBall::new(flight, -1.0).is_err());
/// # Ok::<(), morph_collision::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingBall {
    center: MovingPoint,
    radius: f64,
}

impl MovingBall {
    /// Creates a ball, in world units.
    ///
    /// # Errors
    /// [`InputError`] if a coordinate or the radius is not finite or beyond 1e50, or if the radius is negative.
    pub fn new(center: MovingPoint, radius: f64) -> Result<Self, InputError> {
        check_point("center at the start", center.start)?;
        check_point("center at the end", center.end)?;
        check_number("radius", radius, (0.0..=1e50).contains(&radius), "from 0 to 1e50")?;
        Ok(Self { center, radius })
    }

    /// How the center moves.
    #[must_use]
    pub const fn center(&self) -> MovingPoint {
        self.center
    }

    /// The radius.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// When and where the ball, which is no point, first touches a triangle; `None` if it does not, or only after `latest`.
    /// Adds the work to `tests`.
    pub(super) fn impact(
        &self,
        triangle: &MovingTriangle<'_>,
        tolerance: f64,
        latest: f64,
        tests: &mut u64,
    ) -> Option<SurfaceImpact> {
        let time = ball_impact(&self.center, self.radius, &triangle.points, tolerance, latest, tests)?;
        let middle = time.earliest.midpoint(time.latest);
        let relative = relative_to(&self.center, &triangle.points);
        let closest = closest_on_triangle(DVec3::ZERO, &relative.map(|corner| corner.at(middle)));
        let weights = closest.barycentrics;
        let [a, b, c] = relative.map(|corner| corner.start - corner.end);
        Some(SurfaceImpact {
            triangle: triangle.number,
            time,
            point: self.center.at(middle) + closest.point,
            normal: (-closest.point)
                .try_normalize()
                .unwrap_or_else(|| triangle.outward(middle)),
            velocity: a * weights[0] + b * weights[1] + c * weights[2],
            barycentrics: weights,
        })
    }
}

/// The contact of a triangle of the first body with a point, which is the second.
pub(super) fn impact_of_point(triangle: u32, contact: &MotionContact) -> SurfaceImpact {
    SurfaceImpact {
        triangle,
        time: contact.time,
        point: contact.point,
        normal: -contact.normal,
        velocity: -contact.velocity,
        barycentrics: contact.barycentrics[0],
    }
}
