//! Copies Bevy's morph weights to poses.

use bevy::platform::time::Instant;

use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use morph_collision::{Pose, WeightsError};
use thiserror::Error;
use tracing::{debug_span, error};

use crate::app::{MorphCollisionSystems, Names, Rows, any_changed, ran_long_ago};
use crate::components::MorphCollider;
use crate::import::MorphTrees;
use crate::state::{BadWeights, ColliderNews, ColliderState, LockedPose, MorphCollisionDiagnostics};

/// Why weights cannot be used.
#[derive(Debug, Error)]
pub enum WeightsProblem {
    /// They do not fit the mesh, or are not finite.
    #[error(transparent)]
    Refused(#[from] WeightsError),
    /// Another entity should have them, and has none.
    #[error("entity {0}, which it refers to, has no MorphWeights")]
    NoSource(Entity),
}

impl WeightsProblem {
    /// Whether the numbers of weights and targets differ, which may happen while both are changed.
    #[must_use]
    pub fn is_count(&self) -> bool {
        matches!(self, Self::Refused(WeightsError::WrongCount { .. }))
    }
}

/// Whether any weights changed.
#[derive(SystemParam)]
pub(crate) struct WeightChanges<'w, 's> {
    own: Query<'w, 's, Ref<'static, MeshMorphWeights>, With<MorphCollider>>,
    shared: SharedWeightChanges<'w, 's>,
}

/// Whether the weights of any entity that others refer to have changed.
#[derive(SystemParam)]
pub(crate) struct SharedWeightChanges<'w, 's> {
    weights: Query<'w, 's, (Entity, Ref<'static, MorphWeights>)>,
    rows: Local<'s, Rows>,
    ticks: SystemChangeTick,
}

impl SharedWeightChanges<'_, '_> {
    /// Whether any changed, came or went since the system last ran. Also true if that was so long ago that nobody knows.
    pub(crate) fn any(&mut self) -> bool {
        let (Ok(mut weights), Ok(lists)) = (self.weights.contiguous_iter(), self.weights.contiguous_iter()) else {
            return true;
        };
        let are_same = self.rows.replace(lists.map(|(entities, _)| (entities, 0)));
        !are_same || ran_long_ago(&self.ticks) || weights.any(|(_, weights)| any_changed(Some(&weights)))
    }
}

impl WeightChanges<'_, '_> {
    /// Whether any weights changed, came or went since the last run.
    fn any(&mut self) -> bool {
        let are_shared_new = self.shared.any();
        let Ok(mut own) = self.own.contiguous_iter() else {
            return true;
        };
        are_shared_new || own.any(|weights| any_changed(Some(&weights)))
    }
}

/// Gives every pose the weights with which its mesh is drawn.
///
/// Weights are compared by value, because change detection fires every frame while an animation player exists. Without
/// [`MeshMorphWeights`], a mesh is drawn, and collides, in its rest pose. Invalid weights are logged once until they are valid
/// again; the last valid ones stay in use. A wrong number of weights is only logged after several runs, and not while another
/// tree of the mesh is being built. Reads nothing if nobody's weights, and no pose, changed since the last run.
pub(crate) fn read_weights(
    mut colliders: Query<(Entity, &mut ColliderState, Option<&MeshMorphWeights>), With<MorphCollider>>,
    names: Names,
    shared: Query<&MorphWeights>,
    mut changes: WeightChanges,
    trees: Res<MorphTrees>,
    mut news: ResMut<ColliderNews>,
    mut rest: Local<Vec<f32>>,
    mut any_bad: Local<bool>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::weights").entered();
    // Bad weights are reported after some runs.
    if !changes.any() && !news.are_others && news.reposed.is_empty() && !*any_bad {
        diagnostics.spend(MorphCollisionSystems::Weights, start.elapsed());
        return;
    }
    *any_bad = false;
    for (entity, mut state, weights) in &mut colliders {
        let state = &mut *state;
        let Some(pose) = state.pose.as_mut().map(LockedPose::get_mut) else {
            state.bad_weights.no_pose();
            continue;
        };
        if pose.weights().is_empty() {
            continue;
        }
        match take_weights(pose, weights, &shared, &mut rest) {
            Ok(changed) => {
                state.bad_weights = BadWeights::default();
                if changed {
                    state.freshness.pose_changed();
                    news.reposed.push(entity);
                }
            }
            Err(problem) => {
                *any_bad = true;
                let bad = &mut state.bad_weights;
                let is_news = if problem.is_count() {
                    bad.wrong_count(state.tree.is_some_and(|key| trees.is_coming(key)))
                } else {
                    bad.bad_values()
                };
                if is_news {
                    let name = names.with_file(entity);
                    error!(
                        "morph weights of entity {name} cannot be used: {problem}; the last good ones stay in force"
                    );
                }
            }
        }
    }
    diagnostics.spend(MorphCollisionSystems::Weights, start.elapsed());
}

/// Gives a pose the weights with which its mesh is drawn. Returns whether they changed. `rest` is scratch memory.
///
/// # Errors
/// They do not fit the pose, which keeps its own.
pub fn take_weights(
    pose: &mut Pose,
    weights: Option<&MeshMorphWeights>,
    shared: &Query<&MorphWeights>,
    rest: &mut Vec<f32>,
) -> Result<bool, WeightsProblem> {
    let drawn = drawn_weights(pose.weights().len(), weights, shared, rest)?;
    Ok(pose.set_weights(drawn)?)
}

/// The weights with which a mesh with `count` targets is drawn. They may be invalid. `rest` is scratch memory.
///
/// # Errors
/// They belong to another entity that has none.
pub fn drawn_weights<'a>(
    count: usize,
    weights: Option<&'a MeshMorphWeights>,
    shared: &'a Query<&MorphWeights>,
    rest: &'a mut Vec<f32>,
) -> Result<&'a [f32], WeightsProblem> {
    match weights {
        Some(MeshMorphWeights::Value { weights }) => Ok(weights),
        Some(&MeshMorphWeights::Reference(source)) => match shared.get(source) {
            Ok(weights) => Ok(weights.weights()),
            Err(_) => Err(WeightsProblem::NoSource(source)),
        },
        None => {
            rest.clear();
            rest.resize(count, 0.0);
            Ok(rest)
        }
    }
}
