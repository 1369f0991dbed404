//! Sweeps of fast bodies against parts of surfaces (continuous collision detection).

use bevy_rapier3d::parry::math::{Pose, Real, Rotation, Vector};
use bevy_rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit};
use bevy_rapier3d::parry::shape::{Ball, Shape};

use bevy_morph_physics::shape::Patch;

/// The radius of a swept shape's core, relative to Parry's CCD thickness. That is the radius of a ball, or half the smallest
/// extent of a cuboid.
const CORE: Real = 0.25;

/// The distance of a body up to which contacts stop it and not sweeps, relative to the same thickness.
pub(crate) const MARGIN: Real = 0.5;

/// One of the two shapes: the part, which Rapier keeps at rest at the end of its motion, or the shape swept against it.
struct Swept<'a> {
    motion: NonlinearRigidMotion,
    shape: &'a dyn Shape,
}

/// Sweeps a shape against a part of a surface. `None` if neither shape is a part, or both are.
///
/// If a body is within a margin of the part, contacts stop it; for a fast body they are prepared that far ahead. Only its core, a
/// ball around its middle, is swept then, because it must not pass through even if contacts fail. Rapier would stop the whole body where its foremost point
/// touches, and where the part is at the end of the step. A body that the part lifts, or that turns, would be stopped in each
/// step, stay behind, and finally fall through.
pub(crate) fn sweep_part(
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
    let along = motion_until(&part.motion, patch, end_time);
    let begin = along
        .position_at_time(start_time)
        .inv_mul(&other.motion.position_at_time(start_time));
    let thickness = other.shape.ccd_thickness();
    let (core, middle) = (Ball::new(CORE * thickness), other.shape.mass_properties(1.0).local_com);
    let gap = DefaultQueryDispatcher.distance(&begin, patch, other.shape).ok()?;
    let (motion, shape): (_, &dyn Shape) = if gap.distance > MARGIN * thickness {
        (other.motion, other.shape)
    } else {
        (other.motion.prepend(Pose::from_translation(middle)), &core)
    };
    let cast = |part: &NonlinearRigidMotion| {
        let hit =
            DefaultQueryDispatcher.cast_shapes_nonlinear(part, patch, &motion, shape, start_time, end_time, false);
        hit.ok()
    };
    let Some(meets) = cast(&along)? else {
        return Some(None);
    };
    // Stop it before the place where the part ends, if possible: after they meet, the part comes closer during the rest of the
    // step.
    let before_its_end = cast(&part.motion)?.filter(|hit| hit.time_of_impact > 0.0);
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
