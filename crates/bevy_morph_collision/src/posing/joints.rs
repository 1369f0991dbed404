//! Copies the transforms of joints to the poses of skinned meshes.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::WorldFromModel;
use tracing::{debug_span, error};

use super::skeletons::CurrentSkeletons;
use crate::app::{MorphCollisionSystems, Names};
use crate::components::{MorphCollider, MorphColliderDisabled};
use crate::state::{ColliderNews, ColliderState, MorphCollisionDiagnostics};

/// Gives every skinned pose the joint matrices with which its mesh is drawn.
///
/// Matrices are compared by value, so a character at rest keeps its answers. Invalid matrices are logged once per skeleton, until
/// they are valid again; the last valid ones stay in use.
pub(crate) fn read_joints(
    mut colliders: Query<(Entity, &mut ColliderState, &SkinnedMesh, Has<MorphColliderDisabled>), With<MorphCollider>>,
    names: Names,
    mut skeletons: CurrentSkeletons,
    mut news: ResMut<ColliderNews>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::joints").entered();
    skeletons.notice();
    for (entity, mut state, skin, is_disabled) in &mut colliders {
        let Some(pose) = state.pose_mut() else { continue };
        if pose.joints().is_none() {
            continue;
        }
        let skeleton = skeletons.of(skin);
        if let Some((joint, problem)) = skeleton.problem()
            && !skeleton.is_reported
        {
            error!(
                "the joints of entity {} cannot be used: {problem} (`{}`); the last good ones stay in force, and without any it is \
                 left out of collisions",
                names.with_file(entity),
                names.entity(joint)
            );
            skeleton.is_reported = true;
        }
        let state = &mut *state;
        let is_first = !state.has_joints;
        if let (Some(matrices), Some(pose)) = (skeleton.matrices(), state.pose_mut())
            && let Ok(changed) = pose.set_joints(matrices)
            && (changed || is_first)
        {
            if !is_disabled {
                // The broad phase will ask for this box, when the matrices are no longer in the processor's nearest cache.
                pose.broad_phase_bounds(&WorldFromModel::IDENTITY);
            }
            state.has_joints = true;
            state.freshness.pose_changed();
            news.reposed.push(entity);
        }
    }
    diagnostics.spend(MorphCollisionSystems::Weights, start.elapsed());
}
