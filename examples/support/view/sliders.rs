//! Morph weights by hand: every model takes those of the sliders instead of its own.

use bevy::app::AnimationSystems;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::clock::Clock;

/// The sliders.
#[derive(Resource, Clone, Debug, Default)]
pub struct Sliders {
    /// Whether models follow them.
    pub in_hand: bool,
    /// One for each target: a name and a weight.
    pub weights: Vec<(String, f32)>,
}

/// When models have taken their weights, in [`PostUpdate`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SliderSystems;

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<Sliders>()
        .configure_sets(
            PostUpdate,
            SliderSystems
                .after(AnimationSystems)
                .before(MorphCollisionSystems::Weights)
                .before(bevy_morph_collision::MorphBoundsSystems::Bounds),
        )
        .add_systems(PostUpdate, follow.in_set(SliderSystems))
        .add_systems(Update, name);
}

/// One slider per target of the model that has most.
fn name(
    clock: Res<Clock>,
    mut sliders: ResMut<Sliders>,
    models: Query<&Mesh3d, With<MeshMorphWeights>>,
    meshes: Res<Assets<Mesh>>,
    mut named: Local<bool>,
) {
    if *named || !clock.started {
        return;
    }
    *named = true;
    let names = |mesh: &Mesh3d| {
        meshes
            .get(&mesh.0)
            .and_then(|mesh| mesh.morph_target_names().map(<[String]>::to_vec))
    };
    let most = models.iter().filter_map(names).max_by_key(Vec::len);
    sliders.weights = most.unwrap_or_default().into_iter().map(|name| (name, 0.0)).collect();
}

fn follow(mut sliders: ResMut<Sliders>, mut shared: Query<&mut MorphWeights>, mut own: Query<&mut MeshMorphWeights>) {
    if !sliders.in_hand {
        // They show what is played, so that a hand finds them where the model is.
        let played = shared
            .iter()
            .map(MorphWeights::weights)
            .max_by_key(|weights| weights.len());
        let played = played.map(<[f32]>::to_vec).or_else(|| {
            let values = own.iter().filter_map(|weights| match weights {
                MeshMorphWeights::Value { weights } => Some(weights.clone()),
                MeshMorphWeights::Reference(_) => None,
            });
            values.max_by_key(Vec::len)
        });
        for (slider, weight) in sliders
            .bypass_change_detection()
            .weights
            .iter_mut()
            .zip(played.unwrap_or_default())
        {
            slider.1 = weight;
        }
        return;
    }
    let take = |weights: &mut [f32]| {
        for (weight, slider) in weights.iter_mut().zip(&sliders.weights) {
            *weight = slider.1;
        }
    };
    for mut weights in &mut shared {
        take(weights.weights_mut());
    }
    for mut weights in &mut own {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            take(weights);
        }
    }
}
