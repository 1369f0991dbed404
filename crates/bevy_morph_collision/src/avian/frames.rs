//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::prelude::*;

use super::MorphAvianCollider;
use super::attach::AvianSurface;
use super::step::Stepping;
use crate::physics::drawn::Shows;
use crate::physics::sources::Sources;

/// Records a frame at its end.
pub(super) fn record_frame(
    mut surfaces: Query<(&mut AvianSurface, Shows), With<MorphAvianCollider>>,
    mut sources: Sources,
    fixed: Res<Time<Fixed>>,
    mut stepping: ResMut<Stepping>,
) {
    let now = stepping.timing.frame(&fixed);
    sources.skeletons.begin();
    for (mut surface, shows) in &mut surfaces {
        sources.record(&mut surface.following, shows, now);
    }
}

/// Runs before every step that is due. If the clock was set, it does not say how long changes took: they are no motion.
pub(super) fn watch_clock(mut surfaces: Query<&mut AvianSurface>, time: Res<Time>, mut stepping: ResMut<Stepping>) {
    if stepping.timing.watch.was_set(&time) {
        for mut surface in &mut surfaces {
            surface.following.drawn.pause();
        }
    }
}

/// Runs after every step that is due. While Avian pauses, there is none, and what changes is no motion.
pub(super) fn rest(
    mut surfaces: Query<(&mut AvianSurface, Shows)>,
    mut sources: Sources,
    mut stepping: ResMut<Stepping>,
) {
    if std::mem::take(&mut stepping.has_stepped) {
        return;
    }
    sources.skeletons.begin();
    for (mut surface, shows) in &mut surfaces {
        sources.rest(&mut surface.following, shows);
    }
}
