use std::ops::ControlFlow;

use glam::DVec3;

use super::body::Body;
use super::input::Ball;
use super::one::{OneBody, magnitude};
use super::stats::QueryStats;
use crate::bounds::{Box64, GapFrame, WorldFromModel};
use crate::exact::{TrianglePoint, closest_on_triangle};

/// Pruning keeps what may be closer by no more than distances may be off, so that the closest does not depend on the tree.
const MARGIN: f64 = 1.0 + 1e-9;

/// The point of a body's surface that is closest to some point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// The triangle's number in its mesh.
    pub triangle: u32,
    /// The weights of the triangle's corners at [`ClosestPoint::point`]; not negative, 1 in sum.
    pub barycentrics: [f64; 3],
    /// The closest point, in world space.
    pub point: DVec3,
    /// The distance, in world units; off by a few `f64` roundings of the triangle's size and the distance.
    pub distance: f64,
}

/// Projects points onto a body's surface; holds the memory that queries reuse.
///
/// The surface is the union of the closed triangles, degenerate ones included; a mesh need not be closed, and a point
/// inside one is as far from it as its surface is. No answer depends on the tree.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{DVec3, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())?));
/// # let place = WorldFromModel::IDENTITY;
/// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// let from = Ball::unbounded(DVec3::new(-2.0, 0.0, 0.5))?;
/// let (closest, _) = PointQuery::new().closest(Body::new(&mut pose, &place), &from);
/// let closest = closest.ok_or("nothing there")?;
/// assert_eq!((closest.distance, closest.point), (2.0, DVec3::new(0.0, 0.0, 0.5)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct PointQuery {
    one: OneBody,
}

impl PointQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The point of the surface closest to the ball's centre, if any is in the ball; among equally close ones, that of the
    /// lowest triangle.
    pub fn closest(&mut self, body: Body<'_>, ball: &Ball) -> (Option<ClosestPoint>, QueryStats) {
        let mut closest: Option<(u32, TrianglePoint)> = None;
        let stats = self.one.near(body, ball, |number, foot| {
            let closer = closest.as_ref().is_none_or(|(triangle, best)| {
                foot.squared < best.squared || (foot.squared == best.squared && number < *triangle)
            });
            if closer {
                closest = Some((number, *foot));
            }
            let squared = closest.as_ref().map_or(f64::INFINITY, |(_, best)| best.squared);
            ControlFlow::Continue(squared)
        });
        let closest = closest.map(|(triangle, foot)| ClosestPoint {
            triangle,
            barycentrics: foot.barycentrics,
            point: foot.point,
            distance: foot.squared.sqrt(),
        });
        (closest, stats)
    }
}

impl OneBody {
    /// Calls `at_foot` for triangles in a ball and the point of each closest to the centre, closer leaves first, until it
    /// breaks; it returns beyond which squared distance it wants no more.
    pub(super) fn near(
        &mut self,
        body: Body<'_>,
        ball: &Ball,
        mut at_foot: impl FnMut(u32, &TrianglePoint) -> ControlFlow<(), f64>,
    ) -> QueryStats {
        let mut tree = body.pose.posed();
        let center = Box64::point(ball.center);
        let reach = ball.center.abs();
        let frames = GapFrame::list(
            body.world_from_model,
            magnitude(&mut tree),
            &WorldFromModel::IDENTITY,
            reach,
        );
        let targets: Vec<_> = frames.iter().map(|frame| (frame, frame.image_of_b(&center))).collect();
        let squared_distance = |bounds: &Box64| {
            let distances = targets
                .iter()
                .map(|(frame, target)| frame.squared(&frame.image_of_a(bounds), target));
            Some(distances.fold(0.0, f64::max))
        };
        let radius_squared = ball.radius * ball.radius * MARGIN;
        let mut limit = radius_squared;
        self.walk(
            &mut tree,
            body.world_from_model,
            limit,
            squared_distance,
            |number, triangle| {
                let foot = closest_on_triangle(ball.center, triangle);
                if foot.squared.sqrt() <= ball.radius {
                    limit = (at_foot(number, &foot)? * MARGIN).min(radius_squared);
                }
                ControlFlow::Continue(limit)
            },
        )
    }
}
