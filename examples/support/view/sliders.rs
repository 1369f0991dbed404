//! Morph weights by hand: every model takes those of the sliders instead of its own.

use bevy::app::AnimationSystems;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::clock::Clock;
use super::models::weights_of;

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
        .add_systems(
            PostUpdate,
            (show, follow.run_if(|sliders: Res<Sliders>| sliders.in_hand))
                .chain()
                .in_set(SliderSystems),
        );
}

/// One slider per target of the model that has most. Until a hand takes them they show what that model plays, so that they are found
/// where it is.
fn show(
    clock: Res<Clock>,
    mut sliders: ResMut<Sliders>,
    models: Query<(&Mesh3d, &MeshMorphWeights)>,
    shared: Query<&MorphWeights>,
    meshes: Res<Assets<Mesh>>,
) {
    if sliders.in_hand || !clock.started {
        return;
    }
    let Some((mesh, weights)) = models
        .iter()
        .max_by_key(|(_, weights)| weights_of(weights, &shared).len())
    else {
        return;
    };
    let weights = weights_of(weights, &shared);
    if sliders.weights.len() != weights.len() {
        let names = meshes
            .get(&mesh.0)
            .and_then(Mesh::morph_target_names)
            .unwrap_or_default();
        let name = |target| names.get(target).cloned().unwrap_or_else(|| format!("target {target}"));
        sliders.weights = (0..weights.len()).map(|target| (name(target), 0.0)).collect();
    }
    for (slider, &weight) in sliders.weights.iter_mut().zip(weights) {
        slider.1 = weight;
    }
}

fn follow(sliders: Res<Sliders>, mut shared: Query<&mut MorphWeights>, mut own: Query<&mut MeshMorphWeights>) {
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
