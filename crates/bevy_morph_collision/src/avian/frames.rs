//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;

use super::MorphAvianCollider;
use super::attach::AvianSurface;
use super::step::Stepping;
use crate::physics::drawn::Shows;
use crate::skeletons::{BindPoses, Skeletons};
use crate::weights::drawn_weights;

/// Records a frame at its end.
pub(super) fn record_frame(
    mut surfaces: Query<(&mut AvianSurface, Shows), With<MorphAvianCollider>>,
    shared: Query<&MorphWeights>,
    globals: Query<&GlobalTransform>,
    bind_poses: Option<Res<BindPoses>>,
    mut skeletons: Local<Skeletons>,
    fixed: Res<Time<Fixed>>,
    mut stepping: ResMut<Stepping>,
) {
    // The time that the step clock will show at this frame.
    let now = fixed.elapsed_secs_f64() + fixed.overstep().as_secs_f64();
    stepping.lag.frame(now);
    skeletons.begin();
    for (mut surface, (place, weights, skin)) in &mut surfaces {
        let following = &mut surface.following;
        let skin = skin.filter(|_| following.is_skinned());
        let drawn = &following.drawn;
        let live = drawn.live(place, skin, &mut skeletons, bind_poses.as_deref(), &globals);
        following.record(now, &live, (weights, &shared));
    }
}

/// Runs after the steps of a frame. If weights changed after the last step saw them, a fixed schedule animates them.
pub(super) fn after_steps(
    mut surfaces: Query<(&mut AvianSurface, Option<&MeshMorphWeights>)>,
    shared: Query<&MorphWeights>,
    mut rest: Local<Vec<f32>>,
) {
    for (mut surface, weights) in &mut surfaces {
        let following = &mut surface.following;
        let count = following.before.pose.weights().len();
        if let Ok(weights) = drawn_weights(count, weights, &shared, &mut rest) {
            following.drawn.weights.after_steps(&weights.to_vec());
        }
    }
}

/// Runs before every step that is due. If the clock was set, it does not say how long changes took: they are no motion.
pub(super) fn watch_clock(mut surfaces: Query<&mut AvianSurface>, time: Res<Time>, mut stepping: ResMut<Stepping>) {
    if stepping.watch.was_set(&time) {
        for mut surface in &mut surfaces {
            surface.following.drawn.pause();
        }
    }
}

/// Runs after every step that is due. While Avian pauses, there is none, and what changes is no motion.
pub(super) fn rest(
    mut surfaces: Query<(&mut AvianSurface, Shows)>,
    shared: Query<&MorphWeights>,
    globals: Query<&GlobalTransform>,
    bind_poses: Option<Res<BindPoses>>,
    mut skeletons: Local<Skeletons>,
    mut stepping: ResMut<Stepping>,
) {
    if std::mem::take(&mut stepping.has_stepped) {
        return;
    }
    skeletons.begin();
    for (mut surface, (place, weights, skin)) in &mut surfaces {
        let following = &mut surface.following;
        let skin = skin.filter(|_| following.is_skinned());
        let drawn = &following.drawn;
        let live = drawn.live(place, skin, &mut skeletons, bind_poses.as_deref(), &globals);
        following.rest(&live, (weights, &shared));
    }
}
