//! Sweeps of fast bodies against parts of surfaces (continuous collision detection).

use bevy_rapier3d::parry::math::{Pose, Real, Rotation, Vector};
use bevy_rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit};
use bevy_rapier3d::parry::shape::{Ball, Shape};

use crate::physics::triangles::Patch;

/// The radius of a swept shape's core, relative to Parry's CCD thickness. That is the radius of a ball, or half the smallest
/// extent of a cuboid.
const CORE: Real = 0.25;

/// One of the two shapes: the part, which Rapier keeps at rest at the end of its motion, or the shape swept against it.
struct Swept<'a> {
    motion: NonlinearRigidMotion,
    shape: &'a dyn Shape,
}

/// Sweeps a shape against a part of a surface. `None` if neither shape is a part, or both are.
///
/// Rapier sweeps a body against the part's place at the end of the step. A body that the part lifts or pushes away would then be
/// stopped by a neighboring triangle in each step, stay behind, and finally fall through. Here only contact while both move stops
/// a body.
pub(super) fn sweep_part(
    motion1: &NonlinearRigidMotion,
    g1: &dyn Shape,
    motion2: &NonlinearRigidMotion,
    g2: &dyn Shape,
    start_time: Real,
    end_time: Real,
) -> Option<Option<ShapeCastHit>> {
    let swept = [(motion1, g1), (motion2, g2)].map(|(motion, shape)| Swept { motion: *motion, shape });
    let [one, other] = &swept;
    let parts = [g1, g2].map(|shape| shape.as_shape::<Patch>());
    match parts {
        [Some(patch), None] => first_touch(patch, one, other, start_time, end_time),
        [None, Some(patch)] => {
            first_touch(patch, other, one, start_time, end_time).map(|hit| hit.map(ShapeCastHit::swapped))
        }
        _ => None,
    }
}

fn first_touch(
    patch: &Patch,
    part: &Swept,
    other: &Swept,
    start_time: Real,
    end_time: Real,
) -> Option<Option<ShapeCastHit>> {
    let cast = |part: &NonlinearRigidMotion, other: &Swept| {
        let Swept { motion, shape } = other;
        let hit =
            DefaultQueryDispatcher.cast_shapes_nonlinear(part, patch, motion, *shape, start_time, end_time, false);
        hit.ok()
    };
    let along = motion_until(&part.motion, patch, end_time);
    let begin = along
        .position_at_time(start_time)
        .inv_mul(&other.motion.position_at_time(start_time));
    let touches = DefaultQueryDispatcher
        .intersection_test(&begin, patch, other.shape)
        .ok()?;
    // Contacts handle what already touches. Only the shape's core, a ball around its middle, must not pass through.
    let core = Ball::new(CORE * other.shape.ccd_thickness());
    let other = &if touches.intersecting {
        let middle = other.shape.mass_properties(1.0).local_com;
        Swept {
            motion: other.motion.prepend(Pose::from_translation(middle)),
            shape: &core,
        }
    } else {
        Swept { ..*other }
    };
    let Some(meets) = cast(&along, other)? else {
        return Some(None);
    };
    // Stop it before the place where the part ends, if possible: after they meet, the part comes closer during the rest of the
    // step.
    let before_its_end = cast(&part.motion, other)?.filter(|hit| hit.time_of_impact > 0.0);
    Some(before_its_end.or(Some(meets)))
}

/// The motion of a part that Rapier keeps at rest at the end of its motion.
fn motion_until(end: &NonlinearRigidMotion, patch: &Patch, dt: Real) -> NonlinearRigidMotion {
    let [linear, angular] = patch.velocity;
    if end.linvel != Vector::ZERO || end.angvel != Vector::ZERO {
        return *end;
    }
    let begin = Pose::from_parts(
        end.start.translation - dt * linear,
        Rotation::from_scaled_axis(-dt * angular) * end.start.rotation,
    );
    NonlinearRigidMotion::new(begin, Vector::ZERO, linear, angular)
}
