//! Remembers the poses with which surfaces are drawn, frame by frame, for steps at other times.

use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_rapier3d::plugin::TimestepMode;

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use super::step::Stepping;
use crate::physics::drawn::Shows;
use crate::skeletons::{BindPoses, Skeletons};
use crate::weights::drawn_weights;

/// Records a frame at its end, or before its steps if physics runs once per frame.
pub(super) fn record_frame(
    mut surfaces: Query<(&mut RapierSurface, Shows), With<MorphRapierCollider>>,
    shared: Query<&MorphWeights>,
    globals: Query<&GlobalTransform>,
    bind_poses: Option<Res<BindPoses>>,
    mut skeletons: Local<Skeletons>,
    mode: Option<Res<TimestepMode>>,
    time: Res<Time>,
    fixed: Option<Res<Time<Fixed>>>,
    mut stepping: ResMut<Stepping>,
) {
    let now = if stepping.is_fixed {
        // The time that the step clock will show at this frame.
        let Some(fixed) = fixed else { return };
        let now = fixed.elapsed_secs_f64() + fixed.overstep().as_secs_f64();
        stepping.lag.frame(now);
        now
    } else if matches!(mode.as_deref(), Some(TimestepMode::Interpolated { .. })) {
        time.elapsed_secs_f64()
    } else {
        return;
    };
    skeletons.begin();
    for (mut surface, (place, weights, skin)) in &mut surfaces {
        let following = &mut surface.following;
        let skin = skin.filter(|_| following.is_skinned());
        let drawn = &following.drawn;
        let live = drawn.live(place, skin, &mut skeletons, bind_poses.as_deref(), &globals);
        following.record(now, &live, (weights, &shared));
        if !stepping.is_fixed {
            following.drawn.follow_frames();
        }
    }
}

/// Runs after the steps of a frame. If weights changed after the last step saw them, a fixed schedule animates them.
pub(super) fn after_steps(
    mut surfaces: Query<(&mut RapierSurface, Option<&bevy::mesh::morph::MeshMorphWeights>)>,
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
