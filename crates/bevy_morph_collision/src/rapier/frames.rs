//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::prelude::*;
use bevy_rapier3d::plugin::TimestepMode;

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use super::step::Stepping;
use crate::physics::drawn::Shows;
use crate::physics::sources::Sources;

/// Records a frame at its end, or before its steps if physics runs once per frame.
pub(super) fn record_frame(
    mut surfaces: Query<(&mut RapierSurface, Shows), With<MorphRapierCollider>>,
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
    sources.skeletons.begin();
    for (mut surface, shows) in &mut surfaces {
        let following = &mut surface.following;
        sources.record(following, shows, now);
        if !timing.is_fixed {
            following.drawn.follow_frames();
        }
    }
}
