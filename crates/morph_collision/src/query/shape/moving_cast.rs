//! Casts of a shape that may turn on its way.

use std::ops::ControlFlow;

use glam::DVec3;

use super::ShapeQuery;
use super::cast::Sweep;
use super::first_touch::{Touch, at, first_touch};
use super::moving::MovingShape;
use crate::bounds::{Box64, ByBox};
use crate::exact::closest_on_triangle;
use crate::exact::motion::{MovingPoint, TimeOfImpact};
use crate::query::Body;

/// Where a moving shape, ball or point first touches a body, which may move too.
///
/// Numbers other than `time` are computed in `f64` at a time close to `time.latest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceImpact {
    /// The triangle of the body.
    pub triangle: u32,
    /// When it is first touched, as a share of the motion. Nothing touches before `time.earliest`.
    pub time: TimeOfImpact,
    /// Where the triangle is touched, in world space. For a ball: the point that is closest to the centre.
    pub point: DVec3,
    /// The unit vector from the body to the shape. For a ball: towards the centre; for a point: to the side from which it comes.
    ///
    /// If the centre of a ball is on the triangle, it points out of the body. If a point touches at the start, see
    /// [`MotionContact::normal`](crate::motion::MotionContact::normal). If a shape does, it points out of the shape's nearest face, backwards; zero if there is no such direction.
    pub normal: DVec3,
    /// The velocity of the shape relative to the surface at the point, in world units per motion.
    pub velocity: DVec3,
    /// The weights of the triangle's corners at the point. They are not negative, and their sum is 1 up to rounding.
    pub barycentrics: [f64; 3],
}

impl SurfaceImpact {
    pub(in super::super) fn new(number: u32, shape: &MovingShape, points: &[MovingPoint; 3], touch: &Touch) -> Self {
        let foot = closest_on_triangle(touch.point, &at(points, touch.time.latest));
        let [a, b, c] = points.map(|point| point.end - point.start);
        let [of_a, of_b, of_c] = foot.barycentrics;
        let of_surface = a * of_a + b * of_b + c * of_c;
        Self {
            triangle: number,
            time: touch.time,
            point: touch.point,
            normal: touch.normal,
            velocity: shape.velocity(touch.point, touch.time.latest) - of_surface,
            barycentrics: foot.barycentrics,
        }
    }
}

impl ShapeQuery {
    /// Returns the first triangle that a shape touches while it moves and turns. Times are shares of its motion, and `tolerance` is the largest
    /// difference between the two ends of a time.
    ///
    /// Nothing is touched before `time.earliest`, up to a few `f64` roundings of the coordinates involved. A triangle counts as touched when the gap is below
    /// 1e-13 of the coordinates (1.5e-8 for cylinders, cones and convex hulls), or if after 4096 steps it is not clear whether it is; `time` is then a longer interval. Among equal times, the lowest triangle index wins.
    ///
    /// Without rotation it does what [`ShapeQuery::cast`] does.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Quat, Vec3};
    /// use morph_collision::motion::MovingShape;
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements::<[Vec3; 0]>(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// // A sword stands on its handle in front of the triangle, and is swung down through it.
    /// let sword = PlacedShape::new(Shape::Cuboid { half_extents: Vec3::new(0.01, 1.0, 0.01) }, Quat::IDENTITY, Vec3::new(0.2, 1.0, 0.7))?;
    /// let handle = DVec3::new(0.2, 0.0, 0.7);
    /// let swing = MovingShape::new(sword, DVec3::ZERO)?.turning(handle, DVec3::X * -3.0)?;
    /// let hit = ShapeQuery::new().cast_moving(Body::new(&mut pose, &world_from_model), &swing, 1e-6);
    /// let hit = hit.ok_or("nothing hit")?;
    /// assert!(hit.time.latest > 0.1 && hit.time.latest < 0.9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cast_moving(&mut self, mut body: Body<'_>, shape: &MovingShape, tolerance: f64) -> Option<SurfaceImpact> {
        let sweep = Sweep::of_motion(shape, body.posed().placed_body().placed);
        let mut first: Option<SurfaceImpact> = None;
        let mut latest = 1.0;
        let mut tests = 0;
        let _never_stopped = self.one.walk(
            body,
            latest,
            &ByBox(|node: &Box64| sweep.earliest(node)),
            &mut |number, triangle| {
                let points = triangle.map(MovingPoint::resting);
                if let Some(touch) = first_touch(shape, &points, tolerance, latest, &mut tests) {
                    let impact = SurfaceImpact::new(number, shape, &points, &touch);
                    let key = |impact: &SurfaceImpact| (impact.time.latest, impact.triangle);
                    if first.as_ref().is_none_or(|first| key(&impact) < key(first)) {
                        latest = impact.time.latest;
                        first = Some(impact);
                    }
                }
                ControlFlow::Continue(latest)
            },
        );
        self.one.stats.feature_tests = tests;
        first
    }
}
