//! A box around a shape, as a body in the walk over two trees.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::{MovingBall, MovingBody};
use crate::bounds::WorldFromModel;
use crate::query::Body;
use crate::query::shape::MovingShape;
use crate::{BuildOptions, MorphBvh, MorphModel, Pose};

/// A box around a shape: a segment between opposite corners.
#[derive(Debug)]
pub(super) struct ShapeBox {
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
}

impl ShapeBox {
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

    pub(super) fn around_ball(&mut self, ball: &MovingBall) -> MovingBody<'_> {
        let center = ball.center();
        // More than the rounding of a placed corner.
        let far = center.start.abs().max(center.end.abs()).max_element();
        let half = DVec3::splat(ball.radius() + (far + ball.radius()) * (4.0 * f64::EPSILON));
        self.around([center.start, center.end].map(|at| (at, half)))
    }

    pub(super) fn around_shape(&mut self, shape: &MovingShape) -> MovingBody<'_> {
        self.around(
            shape
                .boxes()
                .map(|[low, high]| (low.midpoint(high), (high - low) * 0.5)),
        )
    }

    /// The boxes at the start and at the end, by the middle and half the size.
    fn around(&mut self, boxes: [(DVec3, DVec3); 2]) -> MovingBody<'_> {
        self.places = boxes.map(|(middle, half)| {
            let [x, y, z] = DVec3::AXES;
            WorldFromModel::from_columns([x * half.x, y * half.y, z * half.z, middle])
        });
        let [start, end] = &mut self.poses;
        MovingBody {
            start: Body::new(start, &self.places[0]),
            end: Body::new(end, &self.places[1]),
        }
    }
}
