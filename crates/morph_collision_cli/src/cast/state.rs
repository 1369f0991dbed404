//! What a body does in a frame, checked.

use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{MorphModel, WorldFromModel};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes;
use morph_collision_models::weight_list::{TargetNames, WeightList};

use crate::files::clips::ClipChoice;

/// What a body does in a frame.
#[derive(Clone, Debug)]
pub(crate) struct BodyState {
    weights: Weights,
    pub(super) world_from_model: Affine3A,
    /// The clips that move it.
    pub(super) clips: ClipChoice,
    /// The time in the clips.
    pub(super) seconds: f32,
}

/// The weights that a state gives.
#[derive(Clone, Debug)]
enum Weights {
    All(Arc<[f32]>),
    /// Targets with their weights; all others have those of the clip, or their default weights.
    Some(Vec<(usize, f32)>),
}

impl BodyState {
    /// A body that nothing moves.
    pub(super) fn at_rest(world_from_model: Affine3A) -> Self {
        Self {
            weights: Weights::Some(Vec::new()),
            world_from_model,
            clips: ClipChoice::default(),
            seconds: 0.0,
        }
    }

    /// Upper bound on the bytes that [`BodyState::check`] takes for a state.
    pub(super) fn bytes(state: &scenes::BodyState) -> u64 {
        // A name is also in the set of those seen. 64: the list of a frame, and the block of the weights.
        let per_weight = match &state.weights {
            WeightList::All(_) => size_of::<f32>(),
            WeightList::Named(_) => size_of::<(usize, f32)>() + 3 * size_of::<usize>(),
        };
        (size_of::<Self>() + 64 + per_weight * state.weights.values().count()) as u64
    }

    pub(super) fn check(
        state: &scenes::BodyState,
        clips: ClipChoice,
        mesh: &MorphMesh,
        names: &TargetNames<'_>,
        model: &MorphModel,
    ) -> Result<Self, String> {
        let world_from_model = state.world_from_model();
        WorldFromModel::new(world_from_model).map_err(|error| error.to_string())?;
        let weights = match &state.weights {
            WeightList::All(weights) if !weights.is_empty() => Weights::All(weights.as_slice().into()),
            list => Weights::Some(names.targets(list).map_err(|error| error.to_string())?),
        };
        let checked = Self {
            weights,
            world_from_model,
            clips,
            seconds: state.time.unwrap_or(0.0),
        };
        // Weights of a clip are checked when they are set, and zeros are always fine.
        let are_zero =
            matches!(&checked.weights, Weights::Some(given) if given.is_empty()) && mesh.default_weights.is_empty();
        if clips.weights.is_none() && !are_zero {
            model
                .check_weights(&checked.weights(mesh))
                .map_err(|error| error.to_string())?;
        }
        Ok(checked)
    }

    /// One weight per target.
    pub(super) fn weights(&self, mesh: &MorphMesh) -> Arc<[f32]> {
        let given = match &self.weights {
            Weights::All(weights) => return Arc::clone(weights),
            Weights::Some(given) => given,
        };
        let mut weights = match self.clips.weights {
            Some(clip) => mesh.animations[clip].sample(self.seconds),
            None => mesh.weights_at_rest(),
        };
        for &(target, weight) in given {
            weights[target] = weight;
        }
        weights.into()
    }
}
