//! Several instances of a model at different places, each at a different time of a clip.

use std::path::Path;

use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;

use crate::app::{load_gltf, update_until};
use crate::error::ExampleError;

/// A clip of a model and its name, which is empty if the file has none.
pub type NamedClip = (String, Handle<AnimationClip>);

/// Loads a model in the app's asset folder. Returns its first scene and its clips. The app must be [ready](crate::app::ready).
///
/// # Errors
/// The file cannot be loaded, or has no scene.
pub fn load(app: &mut App, file: &Path) -> Result<(Handle<WorldAsset>, Vec<NamedClip>), ExampleError> {
    let gltf = load_gltf(app, file)?;
    let no_scene = || ExampleError::NoScene(file.into());
    let assets = app.world().resource::<Assets<Gltf>>();
    let gltf = assets.get(&gltf).ok_or_else(no_scene)?;
    let name = |clip: &Handle<AnimationClip>| {
        let named = gltf.named_animations.iter().find(|(_, named)| *named == clip);
        named.map(|(name, _)| name.to_string()).unwrap_or_default()
    };
    let clips: Vec<NamedClip> = gltf.animations.iter().map(|clip| (name(clip), clip.clone())).collect();
    Ok((gltf.scenes.first().cloned().ok_or_else(no_scene)?, clips))
}

/// Spawns a scene at each of some places, with `more` on its root. Returns the roots; what is below them comes with a later frame.
pub fn place(
    app: &mut App,
    scene: &Handle<WorldAsset>,
    places: &[Transform],
    more: impl Bundle + Clone,
) -> Vec<Entity> {
    let spawn = |&place: &Transform| {
        let root = (
            WorldAssetRoot(scene.clone()),
            Visibility::default(),
            more.clone(),
            place,
        );
        app.world_mut().spawn(root).id()
    };
    places.iter().map(spawn).collect()
}

/// [Loads](load) a model, [spawns](place) its first scene at each of some places, and waits until all are there.
///
/// Returns the roots and the model's clips. The app must be [ready](crate::app::ready).
///
/// # Errors
/// The file cannot be loaded, or has no scene.
pub fn spawn(
    app: &mut App,
    file: &Path,
    places: &[Transform],
    more: impl Bundle + Clone,
) -> Result<(Vec<Entity>, Vec<NamedClip>), ExampleError> {
    #[derive(Component)]
    struct Ready;
    let (scene, clips) = load(app, file)?;
    app.add_observer(|ready: On<WorldInstanceReady>, mut commands: Commands| {
        commands.entity(ready.entity).insert(Ready);
    });
    let roots = place(app, &scene, places, more);
    update_until(app, file, |world| {
        Ok(roots.iter().all(|&root| world.get::<Ready>(root).is_some()))
    })?;
    Ok((roots, clips))
}

/// The index in `roots` of the root that `entity` is, or is below.
#[must_use]
pub fn root_of(world: &World, mut entity: Entity, roots: &[Entity]) -> Option<usize> {
    loop {
        if let Some(index) = roots.iter().position(|&root| root == entity) {
            return Some(index);
        }
        entity = world.get::<ChildOf>(entity)?.parent();
    }
}

/// Plays only this clip, on the players below each root, each from its own time in seconds. Returns the clip's length in seconds.
pub fn play(app: &mut App, clip: &Handle<AnimationClip>, roots: &[Entity], from: impl Fn(usize, f32) -> f32) -> f32 {
    let world = app.world_mut();
    let clips = world.resource::<Assets<AnimationClip>>();
    let duration = clips.get(clip).map_or(0.0, AnimationClip::duration);
    let (graph, node) = AnimationGraph::from_clip(clip.clone());
    let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
    let mut players = world.query_filtered::<Entity, With<AnimationPlayer>>();
    let found: Vec<Entity> = players.iter(world).collect();
    for player in found {
        let index = root_of(world, player, roots).unwrap_or_default();
        let mut entity = world.entity_mut(player);
        entity.insert(AnimationGraphHandle(graph.clone()));
        if let Some(mut player) = entity.get_mut::<AnimationPlayer>() {
            player.stop_all();
            player.play(node).seek_to(from(index, duration));
        }
    }
    duration
}

/// Changes how every player plays its clips.
pub fn edit_players(app: &mut App, edit: impl Fn(&mut AnimationPlayer)) {
    let world = app.world_mut();
    let mut players = world.query::<&mut AnimationPlayer>();
    for mut player in players.iter_mut(world) {
        edit(&mut player);
    }
}
