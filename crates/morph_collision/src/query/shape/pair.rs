//! Queries for two primitive shapes, and for a shape and a point.

use glam::DVec3;

use super::cast::{ShapeImpact, first_impact, unit_direction};
use super::closest::Closest;
use super::first_touch::{Touch, first_touch};
use super::moving::MovingShape;
use super::placed::PlacedShape;
use crate::exact::motion::TimeOfImpact;
use crate::input_error::{InputError, check_length};

/// The closest points of two shapes, or the deepest points if they intersect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeGap {
    /// The distance, in world units. If they intersect it is at most 0, and its absolute value is a depth.
    pub distance: f64,
    /// The point on the first shape, in world space.
    pub point_a: DVec3,
    /// The point on the second shape, in world space.
    pub point_b: DVec3,
    /// The unit vector from the first shape towards the second. Zero if they intersect and there is no such direction.
    pub normal: DVec3,
}

impl PlacedShape {
    /// Returns the point of the shape that is closest to `point`: `point` itself if it is inside the shape.
    #[must_use]
    pub fn closest_point(&self, point: DVec3) -> DVec3 {
        let distance = self.signed_distance(point);
        if distance > 0.0 {
            point - self.outward(point) * distance
        } else {
            point
        }
    }

    /// Returns whether two solid shapes share a point, computed in `f64`.
    #[must_use]
    pub fn meets(&self, other: &Self) -> bool {
        self.gap(other).distance <= 0.0
    }

    /// Returns the closest points of two solid shapes, computed in `f64`.
    ///
    /// If they intersect, the distance is the signed distance of some point of one shape inside the other. Its absolute value is a lower
    /// bound of the depth. [`PlacedShape`] says how accurate it is.
    #[must_use]
    pub fn gap(&self, other: &Self) -> ShapeGap {
        let closest = self.closest_of_shape(other);
        ShapeGap {
            distance: closest.distance,
            point_a: closest.point - closest.normal * closest.distance,
            point_b: closest.point,
            normal: closest.normal,
        }
    }

    /// Returns how far the shape moves along `direction` until it touches another one. `None` if that is farther than `max_distance`, which
    /// may be infinite, or if they never touch. The length of `direction` does not matter.
    ///
    /// As accurate as [`ShapeQuery::cast`](crate::ShapeQuery::cast).
    ///
    /// # Errors
    /// [`InputError`] if the direction is zero or not finite, or if `max_distance` is negative or NaN.
    ///
    /// ```
    /// use glam::{DVec3, Quat, Vec3};
    /// use morph_collision::{PlacedShape, Shape};
    ///
    /// let ball = PlacedShape::ball(DVec3::new(0.0, 9.0, 0.0), 1.0)?;
    /// let cuboid = Shape::Cuboid { half_extents: Vec3::ONE };
    /// let cuboid = PlacedShape::new(cuboid, Quat::IDENTITY, Vec3::ZERO)?;
    /// let impact = ball.cast(DVec3::NEG_Y, 100.0, &cuboid)?;
    /// assert_eq!(impact.map(|impact| impact.distance), Some(7.0));
    /// # Ok::<(), morph_collision::InputError>(())
    /// ```
    pub fn cast(&self, direction: DVec3, max_distance: f64, other: &Self) -> Result<Option<ShapeImpact>, InputError> {
        let direction = unit_direction(direction)?;
        check_length("max_distance", max_distance)?;
        let mut first: Option<ShapeImpact> = None;
        for target in other.solids() {
            let limit = first.map_or(max_distance, |first| first.distance);
            let impact = first_impact(self, direction, limit, |solid| solid.closest_of_solid(target));
            if impact.is_some_and(|impact| first.is_none_or(|first| impact.distance < first.distance)) {
                first = impact;
            }
        }
        Ok(first)
    }

    /// The point of another shape with the smallest signed distance.
    fn closest_of_shape(&self, other: &Self) -> Closest {
        let solids = self.solids().iter();
        let pairs = solids.flat_map(|solid| other.solids().iter().map(move |of| solid.closest_of_solid(of)));
        // Never `None`: both have at least one part.
        Closest::smallest(pairs).unwrap_or(Closest {
            point: DVec3::ZERO,
            normal: DVec3::ZERO,
            distance: f64::INFINITY,
        })
    }
}

/// When and where a moving shape first touches another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingShapeImpact {
    /// When, as a share of the motion. They do not touch before `time.earliest`.
    pub time: TimeOfImpact,
    /// Where, on the other shape, in world space.
    pub point: DVec3,
    /// The unit vector from the other shape to the moving one; zero if they touch at the start and there is no such direction.
    pub normal: DVec3,
    /// The velocity of the moving shape at the point, in world units per motion.
    pub velocity: DVec3,
}

impl MovingShape {
    /// Returns when the shape first touches another one, which rests. `None` if it does not.
    ///
    /// As accurate as [`ShapeQuery::cast_moving`](crate::ShapeQuery::cast_moving).
    #[must_use]
    pub fn cast(&self, other: &PlacedShape, tolerance: f64) -> Option<MovingShapeImpact> {
        let mut first: Option<Touch> = None;
        for target in other.solids() {
            let latest = first.as_ref().map_or(1.0, |first| first.time.latest);
            let touch = first_touch(self, target, tolerance, latest, &mut 0);
            if touch
                .as_ref()
                .is_some_and(|touch| first.as_ref().is_none_or(|first| touch.time.latest < first.time.latest))
            {
                first = touch;
            }
        }
        first.map(|Touch { time, point, normal }| MovingShapeImpact {
            time,
            point,
            normal,
            velocity: self.velocity(point, time.latest),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Quat, Vec3};

    use super::*;
    use crate::query::shape::solid::Solid;
    use crate::{ConvexHull, Shape};

    fn placed(shape: Shape, rotation: Quat, at: [f32; 3]) -> PlacedShape {
        PlacedShape::new(shape, rotation, Vec3::from_array(at)).unwrap()
    }

    fn moved(shape: &PlacedShape, offset: DVec3) -> PlacedShape {
        let parts = shape.solids().iter().map(|solid| solid.moved_by(offset).into());
        PlacedShape::compound(&parts.collect::<Vec<_>>()).unwrap()
    }

    /// Rotated shapes of every kind.
    fn shapes(at: [f32; 3], turn: f32) -> Vec<PlacedShape> {
        let rotation = Quat::from_euler(glam::EulerRot::XYZ, turn, 1.3 * turn, 0.7 * turn);
        let half_extents = Vec3::new(0.5, 1.0, 0.25);
        [
            Shape::Ball { radius: 0.7 },
            Shape::Ball { radius: 0.0 },
            Shape::Capsule {
                half_length: 0.8,
                radius: 0.3,
            },
            Shape::Cuboid { half_extents },
            Shape::Cuboid {
                half_extents: Vec3::new(0.6, 0.4, 0.0),
            },
            Shape::RoundCuboid {
                half_extents: Vec3::new(0.3, 0.5, 0.2),
                border_radius: 0.2,
            },
            Shape::Cylinder {
                half_height: 0.6,
                radius: 0.4,
            },
            Shape::Cone {
                half_height: 0.7,
                radius: 0.5,
            },
            Shape::ConvexHull(Arc::new(
                ConvexHull::new(&[Vec3::NEG_X, Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_ONE * 0.6]).unwrap(),
            )),
            Shape::HalfSpace {
                normal: Vec3::new(1.0, 2.0, -0.5),
            },
        ]
        .map(|shape| placed(shape, rotation, at))
        .to_vec()
    }

    /// The smallest signed distance from `a` of points of `b`, by descent from many starts: a nearly sharp upper bound.
    fn sampled(a: &PlacedShape, b: &PlacedShape) -> f64 {
        let mut best = f64::INFINITY;
        for i in 0..5 {
            for j in 0..5 {
                for k in 0..5 {
                    let start =
                        b.center() + DVec3::new(f64::from(i) - 2.0, f64::from(j) - 2.0, f64::from(k) - 2.0) * 0.6;
                    let mut point = b.closest_point(start);
                    let mut size = 0.5;
                    for _ in 0..400 {
                        // Step towards `a`, then back into `b`.
                        let next = b.closest_point(point - a.outward(point) * size);
                        if a.signed_distance(next) < a.signed_distance(point) {
                            point = next;
                        } else {
                            size *= 0.8;
                        }
                    }
                    best = best.min(a.signed_distance(point));
                }
            }
        }
        best
    }

    #[test]
    fn gaps_are_those_of_sampled_points() {
        let (mut apart, mut deep) = (0, 0);
        for (i, at) in [[0.3, 0.2, 0.1], [1.5, -0.5, 0.7], [3.0, 0.0, 0.5], [0.9, 1.1, -0.6]]
            .into_iter()
            .enumerate()
        {
            for a in shapes([0.0; 3], 0.4) {
                for b in shapes(at, 0.9 + i as f32) {
                    let gap = a.gap(&b);
                    let back = b.gap(&a);
                    assert_eq!(gap.distance > 0.0, back.distance > 0.0, "{a:?} {b:?}");
                    assert_eq!(a.meets(&b), b.meets(&a));
                    let halves = [&a, &b].map(|shape| matches!(shape.solids(), [Solid::HalfSpace { .. }]));
                    if halves == [true, true] {
                        continue;
                    }
                    if gap.distance > 0.0 {
                        apart += 1;
                        assert!(
                            (gap.distance - back.distance).abs() < 1e-9,
                            "{a:?} {b:?}: {gap:?} {back:?}"
                        );
                        assert!((gap.point_b - gap.point_a - gap.normal * gap.distance).length() < 1e-9);
                        assert!(
                            a.signed_distance(gap.point_a).abs() < 1e-9 && b.signed_distance(gap.point_b).abs() < 1e-9
                        );
                        if !halves[1] {
                            let sampled = sampled(&a, &b);
                            assert!(
                                sampled > gap.distance - 1e-7 && sampled < gap.distance + 0.05,
                                "{sampled} {gap:?}"
                            );
                        }
                    } else {
                        deep += 1;
                        if !halves[1] {
                            let sampled = sampled(&a, &b);
                            assert!(sampled < 1e-6, "{a:?} {b:?}: {sampled} {gap:?}");
                        }
                    }
                }
            }
        }
        assert!(apart > 20 && deep > 20, "{apart} {deep}");
    }

    #[test]
    fn casts_end_where_shapes_meet_first() {
        let (mut hits, mut misses) = (0, 0);
        for i in 0..24_u32 {
            let angle = f64::from(i) * 0.77;
            let direction = DVec3::new(angle.cos(), 0.4 * (1.7 * angle).sin(), angle.sin());
            let start = (direction * -6.0 + DVec3::new(0.3, 0.5 * angle.sin(), 0.2))
                .as_vec3()
                .to_array();
            for a in shapes(start, i as f32) {
                for b in shapes([0.0; 3], 0.5) {
                    let Some(hit) = a.cast(direction * 3.0, 20.0, &b).unwrap() else {
                        misses += 1;
                        let meets = |step: u32| moved(&a, direction.normalize() * f64::from(step) * 0.01).meets(&b);
                        assert!(!(0..2000).any(meets), "{a:?} {b:?}");
                        continue;
                    };
                    hits += 1;
                    let at = |distance: f64| moved(&a, direction.normalize() * distance).gap(&b).distance;
                    assert!(at(hit.distance) < 1e-7, "{a:?} {b:?} {hit:?}");
                    let before = (0..100).map(|step| hit.distance * f64::from(step) / 100.0);
                    assert!(
                        before.clone().all(|distance| hit.distance == 0.0 || at(distance) > 0.0),
                        "{a:?} {b:?} {hit:?}"
                    );
                    if hit.distance > 0.0 {
                        assert!(b.signed_distance(hit.point).abs() < 1e-7, "{hit:?}");
                        assert!(hit.normal.dot(direction) < 0.0, "{hit:?}");
                    }
                }
            }
        }
        assert!(hits > 300 && misses > 50, "{hits} {misses}");
    }

    #[test]
    fn turning_shapes_touch_others_when_sampled_ones_do() {
        let (mut hits, mut misses) = (0, 0);
        for (i, at) in [[2.5, 0.2, 0.1], [-1.5, -2.0, 0.7], [0.3, 2.4, -1.0]]
            .into_iter()
            .enumerate()
        {
            for a in shapes(at, 0.4) {
                let pivot = DVec3::new(0.4, -0.2, 0.1) * i as f64;
                let Ok(moving) = MovingShape::new(a, DVec3::from_array(at.map(f64::from)) * -0.8) else {
                    continue;
                };
                let moving = moving.turning(pivot, DVec3::new(0.2, -0.4, 0.9)).unwrap();
                for b in shapes([0.0; 3], 1.1) {
                    let hit = moving.cast(&b, 1e-6);
                    let until = hit.map_or(1.0, |hit| hit.time.earliest);
                    let meets = |share: u32| moving.at(until * f64::from(share) / 200.0).meets(&b);
                    assert!(until == 0.0 || !(0..200).any(meets), "{moving:?} {b:?} {hit:?}");
                    let Some(hit) = hit else {
                        misses += 1;
                        continue;
                    };
                    hits += 1;
                    let gap = moving.at(hit.time.latest).gap(&b).distance;
                    assert!(gap < 1e-6, "{moving:?} {b:?} {hit:?} {gap}");
                    if hit.time.latest > 0.0 {
                        assert!(b.signed_distance(hit.point).abs() < 1e-5, "{hit:?}");
                        assert!(hit.normal.dot(hit.velocity) < 1e-6, "{hit:?}");
                    }
                }
            }
        }
        assert!(hits > 50 && misses > 50, "{hits} {misses}");
    }

    #[test]
    fn a_ball_grazes_and_passes() {
        let ball = |x: f64| PlacedShape::ball(DVec3::new(x, 10.0, 0.0), 1.0).unwrap();
        let target = PlacedShape::ball(DVec3::ZERO, 1.0).unwrap();
        let cast = |x: f64| ball(x).cast(DVec3::NEG_Y, f64::INFINITY, &target).unwrap();
        let expected = 10.0 - (4.0_f64 - 1.99 * 1.99).sqrt();
        assert!((cast(1.99).unwrap().distance - expected).abs() < 1e-9);
        assert!((cast(2.0).unwrap().distance - 10.0).abs() < 1e-5);
        assert_eq!(cast(2.000_001), None);
        assert_eq!(ball(0.0).cast(DVec3::NEG_Y, 7.9, &target).unwrap(), None);
        assert!(ball(0.0).cast(DVec3::ZERO, 1.0, &target).is_err());
        assert!(ball(0.0).cast(DVec3::X, f64::NAN, &target).is_err());
    }
}
