//! Morph weights by hand: every model takes the sliders' weights instead of its own.

use bevy::app::AnimationSystems;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::clock::Clock;
use super::models::weights_of;

/// The sliders.
#[derive(Resource, Clone, Debug, Default)]
pub struct Sliders {
    /// Whether models follow the sliders.
    pub in_hand: bool,
    /// The name and weight of each target.
    pub weights: Vec<(String, f32)>,
}

/// The systems that set the models' weights, in [`PostUpdate`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SliderSystems;

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<Sliders>()
        .configure_sets(
            PostUpdate,
            SliderSystems
                .after(AnimationSystems)
                .before(MorphCollisionSystems::Weights)
                .before(bevy_morph_collision::bounds::MorphBoundsSystems::Bounds),
        )
        .add_systems(
            PostUpdate,
            (show, apply.run_if(|sliders: Res<Sliders>| sliders.in_hand))
                .chain()
                .in_set(SliderSystems),
        );
}

/// Shows one slider per target of the model with the most targets. Until the user moves one, the sliders show the weights that
/// the model plays. If several models have the most targets, one with a weight that is not zero is preferred.
fn show(
    clock: Res<Clock>,
    mut sliders: ResMut<Sliders>,
    mut named: Local<Option<AssetId<Mesh>>>,
    models: Query<(&Mesh3d, &MeshMorphWeights)>,
    shared: Query<&MorphWeights>,
    meshes: Res<Assets<Mesh>>,
) {
    if sliders.in_hand || !clock.started {
        return;
    }
    let Some((mesh, weights)) = models
        .iter()
        .map(|(mesh, weights)| (mesh, weights_of(weights, &shared)))
        .max_by_key(|(_, weights)| (weights.len(), weights.iter().any(|&weight| weight != 0.0)))
    else {
        return;
    };
    // Models with equally many targets may name them differently.
    let renamed = named.replace(mesh.id()) != Some(mesh.id());
    if renamed || sliders.weights.len() != weights.len() {
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

fn apply(sliders: Res<Sliders>, mut shared: Query<&mut MorphWeights>, mut own: Query<&mut MeshMorphWeights>) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The sliders' weights with models of these weights, spawned in this order.
    fn shown(models: &[Vec<f32>]) -> Vec<f32> {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .init_resource::<Sliders>()
            .init_resource::<Clock>()
            .add_systems(Update, show);
        app.world_mut().resource_mut::<Clock>().started = true;
        for weights in models {
            let weights = MeshMorphWeights::Value {
                weights: weights.clone(),
            };
            app.world_mut().spawn((Mesh3d::default(), weights));
        }
        app.update();
        let sliders = app.world().resource::<Sliders>();
        sliders.weights.iter().map(|&(_, weight)| weight).collect()
    }

    #[test]
    fn sliders_show_a_model_that_morphs_not_one_at_rest_with_as_many_targets() {
        let (rest, morphed, small) = (vec![0.0; 3], vec![0.0, 0.5, 0.0], vec![1.0]);
        assert_eq!(shown(&[rest.clone(), morphed.clone(), small.clone()]), morphed);
        assert_eq!(shown(&[small.clone(), morphed.clone(), rest.clone()]), morphed);
        assert_eq!(shown(&[small, rest.clone()]), rest);
    }
}
