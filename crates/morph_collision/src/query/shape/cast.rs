//! Casts of a shape along a line until it touches something.

use std::ops::ControlFlow;

use glam::DVec3;

use super::ShapeQuery;
use super::closest::Closest;
use super::moving::MovingShape;
use super::placed::PlacedShape;
use super::solid::Solid;
use crate::bounds::{Box64, ByBox, PlacedBounds};
use crate::exact::largest;
use crate::input_error::{InputError, check_direction, check_length};
use crate::query::Body;
use crate::query::rank::Rank;

/// Where a moving shape first touches something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeImpact {
    /// How far the shape has moved, in world units; 0 if the two intersect at the start.
    pub distance: f64,
    /// Where they touch, on the target, in world space. If they intersect at the start: the target's point that is deepest in the shape.
    pub point: DVec3,
    /// The unit vector from the target towards the shape. Zero only if they intersect at the start and there is no such direction.
    pub normal: DVec3,
}

/// The first triangle that a moving shape touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeCastHit {
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// How far the shape moves until it touches the triangle, and where it touches.
    pub impact: ShapeImpact,
}

impl ShapeQuery {
    /// Returns the first triangle that a shape touches while it moves along `direction` for at most `max_distance`, which may be infinite.
    /// The length of `direction` does not matter.
    ///
    /// The shape is solid. The distance is too long by at most a few `f64` roundings of the coordinates involved. The shape stops early, before
    /// a gap of at most 1e-12 times the coordinates (1.5e-8 for cylinders, cones and convex hulls); so a path that misses a triangle by that little
    /// may count as a hit. Among equal distances, the lowest triangle index wins (see [`Rank`]).
    ///
    /// # Errors
    /// [`InputError`] if the direction is zero or not finite, or if `max_distance` is negative or NaN.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use glam::{DVec3, Quat, Vec3};
    /// # use morph_collision::*;
    /// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
    /// # let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// # let world_from_model = WorldFromModel::IDENTITY;
    /// pose.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
    /// let ball = PlacedShape::new(Shape::Ball { radius: 1.0 }, Quat::IDENTITY, Vec3::new(0.25, 0.25, 5.0))?;
    /// let hit = ShapeQuery::new().cast(Body::new(&mut pose, &world_from_model), &ball, DVec3::NEG_Z, f64::INFINITY)?;
    /// let hit = hit.ok_or("nothing hit")?;
    /// assert_eq!((hit.impact.distance, hit.impact.point, hit.impact.normal), (3.5, DVec3::new(0.25, 0.25, 0.5), DVec3::Z));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cast(
        &mut self,
        mut body: Body<'_>,
        shape: &PlacedShape,
        direction: DVec3,
        max_distance: f64,
    ) -> Result<Option<ShapeCastHit>, InputError> {
        let direction = unit_direction(direction)?;
        check_length("max_distance", max_distance)?;
        let sweep = Sweep::new(shape, direction, body.posed().placed_body().placed);
        let mut first: Option<ShapeCastHit> = None;
        let mut limit = max_distance;
        let _never_stopped = self.one.walk(
            body,
            limit,
            &ByBox(|node: &Box64| sweep.earliest(node)),
            &mut |number, triangle| {
                let impact = first_impact(shape, direction, limit, |shape| shape.closest(triangle));
                let hit = impact.map(|impact| ShapeCastHit {
                    triangle: number,
                    impact,
                });
                let is_first = |hit: &ShapeCastHit| first.as_ref().is_none_or(|first| hit.rank() < first.rank());
                if let Some(hit) = hit.filter(is_first) {
                    limit = hit.impact.distance;
                    first = Some(hit);
                }
                ControlFlow::Continue(limit)
            },
        );
        Ok(first)
    }
}

impl ShapeCastHit {
    fn rank(&self) -> Rank<u32> {
        Rank::new(self.impact.distance, self.triangle)
    }
}

/// Normalises a direction.
pub(super) fn unit_direction(direction: DVec3) -> Result<DVec3, InputError> {
    check_direction("direction", direction)?;
    Ok((direction / direction.abs().max_element()).normalize())
}

/// How far a shape must move along a unit vector to touch a convex target; `None` if that is farther than `limit`, or if it never touches.
///
/// `closest` takes a moved part of the shape and returns its distance from the target, with the normal of a plane that separates them.
///
/// Until the shape has crossed the gap along that normal, the two stay apart. So each step moves the shape that far and asks for the next
/// plane. This is Newton's method for a convex function: it needs few steps and approaches the contact from the near side.
pub(super) fn first_impact(
    shape: &PlacedShape,
    direction: DVec3,
    limit: f64,
    closest: impl Fn(&Solid) -> Closest,
) -> Option<ShapeImpact> {
    let mut first: Option<ShapeImpact> = None;
    for solid in shape.solids() {
        let limit = first.map_or(limit, |first| first.distance);
        let impact = first_impact_of_solid(solid, direction, limit, &closest);
        if impact.is_some_and(|impact| first.is_none_or(|first| impact.distance < first.distance)) {
            first = impact;
        }
    }
    first
}

fn first_impact_of_solid(
    solid: &Solid,
    direction: DVec3,
    limit: f64,
    closest: impl Fn(&Solid) -> Closest,
) -> Option<ShapeImpact> {
    /// If a path grazes a round target, each step halves the remaining distance; otherwise a few steps are enough. After the last step, the
    /// shape is where it has come without touching anything.
    const MAX_STEPS: usize = 64;
    /// Smaller distances, relative to the coordinates involved, count as touching: the direction across so narrow a gap would be only
    /// rounding error.
    const TOUCHING: f64 = 1e-13;
    let mut distance = 0.0;
    let mut touching = closest(solid);
    for _ in 0..MAX_STEPS {
        let reach = solid.reach() + distance + touching.point.abs().max_element();
        if touching.distance <= TOUCHING * reach {
            break;
        }
        let approach = direction.dot(touching.normal);
        if approach <= 0.0 {
            return None;
        }
        distance += touching.distance / approach;
        if distance.is_nan() || distance > limit {
            return None;
        }
        let now = closest(&solid.moved_by(direction * distance));
        touching = Closest {
            normal: if now.distance <= TOUCHING * reach {
                touching.normal
            } else {
                now.normal
            },
            ..now
        };
    }
    Some(ShapeImpact {
        distance,
        point: touching.point,
        normal: -touching.normal,
    })
}

/// Lower bounds on how far a shape must move to touch anything in a node's box.
pub(super) struct Sweep {
    body: PlacedBounds,
    /// Unit vectors, the shape's extent along each, and its speed along each.
    slabs: [(DVec3, [f64; 2], f64); 6],
    slack: f64,
}

/// Relative to the sum of all magnitudes: 64 roundings, more than the longest chain of operations here.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

impl Sweep {
    /// A shape that moves and turns; times are shares of the motion.
    pub(super) fn of_motion(shape: &MovingShape, body: PlacedBounds) -> Self {
        let [start, end] = [shape.at(0.0), shape.at(1.0)];
        let (velocity, bulge) = (shape.translation(), shape.bulge());
        // The shape seen by an observer who moves with it.
        let support = |w: DVec3| start.support(w).max(end.support(w) - w.dot(velocity)) + bulge;
        let mut sweep = Self::new(&start, velocity.try_normalize().unwrap_or(DVec3::X), body);
        for (w, extent, speed) in &mut sweep.slabs {
            (*extent, *speed) = ([-support(-*w), support(*w)], w.dot(velocity));
        }
        sweep.slack += ROUNDING * shape.reach();
        sweep
    }

    fn new(shape: &PlacedShape, direction: DVec3, body: PlacedBounds) -> Self {
        let across = direction.any_orthonormal_pair();
        let along = [direction, across.0, across.1, DVec3::X, DVec3::Y, DVec3::Z];
        let slabs = along.map(|w| (w, [-shape.support(-w), shape.support(w)], w.dot(direction)));
        let body_reach = body.world_reach().element_sum();
        let blind_gap = largest(shape.solids().iter().map(|solid| solid.blind_gap(body_reach)));
        let slack = ROUNDING * (body_reach + shape.reach()) + 3.0 * body.error() + blind_gap;
        Self { body, slabs, slack }
    }

    /// The earliest distance at which the shape may touch the box; `None` if it certainly misses the box.
    ///
    /// The slack also covers the rounding of speeds, for the distances at which the shape meets boxes.
    pub(super) fn earliest(&self, node: &Box64) -> Option<f64> {
        let world_from_model = self.body.world_from_model();
        let m = world_from_model.linear();
        let center = m * node.center + world_from_model.translation();
        let axes = [m.x_axis * node.half.x, m.y_axis * node.half.y, m.z_axis * node.half.z];
        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for (w, [shape_low, shape_high], speed) in &self.slabs {
            let middle = w.dot(center);
            let radius = axes.iter().map(|axis| w.dot(*axis).abs()).sum::<f64>() + self.slack;
            let (low, high) = (middle - radius - shape_high, middle + radius - shape_low);
            // After an overflow, there is no bound.
            if low.is_nan() || high.is_nan() {
                continue;
            }
            if *speed == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (enter, leave) = (low / speed, high / speed);
            first = first.max(enter.min(leave));
            last = last.min(enter.max(leave));
        }
        (first <= last).then_some(first * (1.0 - 1e-12))
    }
}
