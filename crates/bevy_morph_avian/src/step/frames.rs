//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsCollider;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::time::SurfaceComponents;

use super::stepping::Stepping;
use crate::surface::AvianSurface;

/// Records a frame at its end.
pub(crate) fn record_frame(
    mut surfaces: Query<(&mut AvianSurface, SurfaceComponents), With<MorphPhysicsCollider>>,
    mut sources: Sources,
    fixed: Res<Time<Fixed>>,
    mut stepping: ResMut<Stepping>,
) {
    let now = stepping.timing.frame(&fixed);
    sources.skeletons.notice();
    for (mut surface, components) in &mut surfaces {
        sources.record(&mut surface.moving, &components, now);
    }
}

/// Runs before every step that is due. If the clock was set, it does not say how long changes took: they are no motion.
pub(crate) fn watch_clock(mut surfaces: Query<&mut AvianSurface>, time: Res<Time>, mut stepping: ResMut<Stepping>) {
    if stepping.timing.watch.was_set(&time) {
        for mut surface in &mut surfaces {
            surface.moving.drawn.pause();
        }
    }
}

/// Runs after every step that is due. While Avian pauses, there is none, and what changes is no motion.
pub(crate) fn rest(
    mut surfaces: Query<(&mut AvianSurface, SurfaceComponents)>,
    mut sources: Sources,
    mut stepping: ResMut<Stepping>,
) {
    if std::mem::take(&mut stepping.has_stepped) {
        return;
    }
    sources.skeletons.notice();
    for (mut surface, components) in &mut surfaces {
        sources.rest(&mut surface.moving, &components);
    }
}
