//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsCollider;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::time::SurfaceComponents;
use bevy_rapier3d::plugin::TimestepMode;

use super::stepping::Stepping;
use crate::surface::RapierSurface;

/// Records a frame at its end, or before its steps if physics runs once per frame.
pub(crate) fn record_frame(
    mut surfaces: Query<(&mut RapierSurface, SurfaceComponents), With<MorphPhysicsCollider>>,
    mut sources: Sources,
    mode: Option<Res<TimestepMode>>,
    time: Res<Time>,
    fixed: Option<Res<Time<Fixed>>>,
    mut stepping: ResMut<Stepping>,
) {
    let timing = &mut stepping.timing;
    let now = if timing.is_fixed {
        let Some(fixed) = fixed else { return };
        timing.frame(&fixed)
    } else if matches!(mode.as_deref(), Some(TimestepMode::Interpolated { .. })) {
        time.elapsed_secs_f64()
    } else {
        return;
    };
    sources.skeletons.notice();
    for (mut surface, components) in &mut surfaces {
        let moving = &mut surface.moving;
        sources.record(moving, &components, now);
        if !timing.is_fixed {
            moving.drawn.interpolate();
        }
    }
}
