//! Points and balls that move.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::triangle::MovingTriangle;
use super::{MotionContact, MovingBody};
use crate::bounds::WorldFromModel;
use crate::exact::closest_on_triangle;
use crate::exact::motion::{MovingPoint, TimeOfImpact, ball_impact, relative_to};
use crate::input_error::{check_number, check_point};
use crate::query::Body;
use crate::{BuildOptions, InputError, MorphBvh, MorphModel, Pose};

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
    ) -> Option<BallImpact> {
        let time = ball_impact(&self.center, self.radius, &triangle.points, tolerance, latest, tests)?;
        let middle = time.earliest.midpoint(time.latest);
        let relative = relative_to(&self.center, &triangle.points);
        let closest = closest_on_triangle(DVec3::ZERO, &relative.map(|corner| corner.at(middle)));
        let weights = closest.barycentrics;
        let [a, b, c] = relative.map(|corner| corner.start - corner.end);
        Some(BallImpact {
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

/// Where a moving point or ball first touches a body.
///
/// Numbers other than `time` are computed in `f64` at a time close to `time.latest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallImpact {
    /// The triangle of the body.
    pub triangle: u32,
    /// When it is first touched, as a share of the motion. Nothing touches before `time.earliest`.
    pub time: TimeOfImpact,
    /// The point of the triangle that is closest to the center, in world space.
    pub point: DVec3,
    /// The unit vector from the body to the ball: towards the center, or, for a point, to the side from which it comes.
    ///
    /// If the center of a ball is on the triangle, it points out of the body. If a point touches at the start, see
    /// [`MotionContact::normal`].
    pub normal: DVec3,
    /// The velocity of the ball relative to the surface, in world units per motion.
    pub velocity: DVec3,
    /// The weights of the triangle's corners at the point. They are not negative, and their sum is 1 up to rounding.
    pub barycentrics: [f64; 3],
}

impl BallImpact {
    /// The contact of a triangle of the first body with a point, which is the second.
    pub(super) fn of_point(triangle: u32, contact: &MotionContact) -> Self {
        Self {
            triangle,
            time: contact.time,
            point: contact.point,
            normal: -contact.normal,
            velocity: -contact.velocity,
            barycentrics: contact.barycentrics[0],
        }
    }
}

/// A box around a ball, as a body in the walk over two trees: a segment between opposite corners.
#[derive(Debug)]
pub(super) struct BallBox {
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
}

impl BallBox {
    pub(super) fn new() -> Self {
        let corners = [Vec3::NEG_ONE, Vec3::ONE];
        let model = MorphModel::from_displacements::<Vec<Vec3>>(&corners, &[[0, 1, 1]], &[]);
        let model = model.expect("two finite vertices and a triangle of them");
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        Self {
            poses: [Pose::new(bvh.clone()), Pose::new(bvh)],
            places: [WorldFromModel::IDENTITY; 2],
        }
    }

    /// The box around a ball.
    pub(super) fn around(&mut self, ball: &MovingBall) -> MovingBody<'_> {
        let MovingBall { center, radius } = ball;
        // More than the rounding of a placed corner.
        let far = center.start.abs().max(center.end.abs()).max_element();
        let half = radius + (far + radius) * (4.0 * f64::EPSILON);
        let [x, y, z] = DVec3::AXES.map(|axis| axis * half);
        self.places = [center.start, center.end].map(|at| WorldFromModel::from_columns([x, y, z, at]));
        let [start, end] = &mut self.poses;
        MovingBody {
            start: Body::new(start, &self.places[0]),
            end: Body::new(end, &self.places[1]),
        }
    }
}
