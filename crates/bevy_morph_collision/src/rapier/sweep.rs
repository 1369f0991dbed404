//! What Rapier asks about fast bodies and parts of surfaces.

use bevy_rapier3d::parry::math::{Pose, Real, Rotation, Vector};
use bevy_rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit};
use bevy_rapier3d::parry::shape::{Ball, Shape};

use crate::physics::triangles::Patch;

/// The radius of the core of a swept shape, relative to the thickness that Parry gives it: the radius of a ball, half the smallest extent of a cuboid.
const CORE: Real = 0.25;

/// One of the two shapes: the part, which Rapier has at rest where it ends, or what is swept against it.
struct Swept<'a> {
    motion: NonlinearRigidMotion,
    shape: &'a dyn Shape,
}

/// Sweeps a shape against a part of a surface; `None` if neither is one, or both are.
///
/// Rapier sweeps a body against the part as it will be at the end of the step. A body that is lifted or pushed away by the part would be stopped by a neighboring triangle in each step. It
/// would stay behind, and fall through in the end. Here a body is stopped only by what it meets while both move.
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
    // What touches already is a matter of contacts. Only its core, a ball around its middle, must not get through.
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
    // Stop it before the place where the part ends, if it can be: after they meet, the part comes closer in the rest of the step.
    let before_its_end = cast(&part.motion, other)?.filter(|hit| hit.time_of_impact > 0.0);
    Some(before_its_end.or(Some(meets)))
}

/// How a part moves that Rapier has at rest at its end.
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
