//! What Rapier asks about fast bodies and parts of surfaces.

use bevy_rapier3d::parry::math::{Pose, Real};
use bevy_rapier3d::parry::query::{DefaultQueryDispatcher, NonlinearRigidMotion, QueryDispatcher, ShapeCastHit};
use bevy_rapier3d::parry::shape::{Ball, Shape};

use crate::physics::triangles::Patch;

/// The radius of what must not get through of a swept shape that touches already, relative to Parry's thickness of it: the radius of a ball, half the smallest extent of
/// a cuboid.
const CORE: Real = 0.25;

/// Sweeps a shape that touches a part of a surface already; `None` if it does not.
///
/// Rapier sweeps bodies against where a part ends in the step. What rests on a part that rises is in there at once, and meets its next triangle soon after: stopped there
/// in step after step, it does not rise with the part and falls through. What touches already is a matter of contacts. Only its core, a ball around its middle, must not get
/// through.
pub(super) fn sweep_core(
    motion1: &NonlinearRigidMotion,
    g1: &dyn Shape,
    motion2: &NonlinearRigidMotion,
    g2: &dyn Shape,
    start_time: Real,
    end_time: Real,
) -> Option<Option<ShapeCastHit>> {
    let parts = [g1, g2].map(|shape| shape.as_shape::<Patch>().is_some());
    if parts[0] == parts[1] {
        return None;
    }
    let pos12 = motion1
        .position_at_time(start_time)
        .inv_mul(&motion2.position_at_time(start_time));
    let touches = DefaultQueryDispatcher.intersection_test(&pos12, g1, g2).ok()?;
    if !touches.intersecting {
        return None;
    }
    let core = |motion: &NonlinearRigidMotion, shape: &dyn Shape| {
        let middle = shape.mass_properties(1.0).local_com;
        (
            motion.prepend(Pose::from_translation(middle)),
            Ball::new(CORE * shape.ccd_thickness()),
        )
    };
    let hit = if parts[0] {
        let (motion, core) = core(motion2, g2);
        DefaultQueryDispatcher.cast_shapes_nonlinear(motion1, g1, &motion, &core, start_time, end_time, false)
    } else {
        let (motion, core) = core(motion1, g1);
        DefaultQueryDispatcher.cast_shapes_nonlinear(&motion, &core, motion2, g2, start_time, end_time, false)
    };
    hit.ok()
}
