//! Models as they are loaded, culled and colliding, with their clips.

use std::path::{Path, PathBuf};

use bevy::camera::visibility::VisibilityPlugin;
use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::{headless, load_gltf, update_until};

use crate::log::start;
use crate::support::settle;

/// A model from outside the repository, if that folder is there.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/models")
        .join(name);
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    path.canonicalize().ok()
}

/// A clip of a model, and its name.
pub(crate) type NamedClip = (String, Handle<AnimationClip>);

/// An app with a model at each of some places, culled and colliding; the roots of their scenes, and the model's clips.
pub(crate) fn with_models(file: &Path, places: &[Transform]) -> (App, Vec<Entity>, Vec<NamedClip>) {
    let mut app = headless(file.parent().unwrap());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    let gltf = load_gltf(&mut app, file).expect("the model can be loaded");
    let (scene, clips) = {
        let gltf = app.world().resource::<Assets<Gltf>>().get(&gltf).unwrap();
        // Those without a name have an empty one here.
        let name = |clip: &Handle<AnimationClip>| {
            let named = gltf.named_animations.iter().find(|(_, named)| *named == clip);
            named.map(|(name, _)| name.to_string()).unwrap_or_default()
        };
        let clips: Vec<NamedClip> = gltf.animations.iter().map(|clip| (name(clip), clip.clone())).collect();
        (gltf.scenes[0].clone(), clips)
    };
    #[derive(Resource, Default)]
    struct Ready(usize);
    app.init_resource::<Ready>();
    app.world_mut()
        .add_observer(|_: On<WorldInstanceReady>, mut ready: ResMut<Ready>| ready.0 += 1);
    let spawn = |&place: &Transform| {
        let parts = MorphColliderScene::default();
        let root = (WorldAssetRoot(scene.clone()), Visibility::default(), parts, place);
        app.world_mut().spawn(root).id()
    };
    let roots: Vec<Entity> = places.iter().map(spawn).collect();
    let all = roots.len();
    update_until(&mut app, file, |world| Ok(world.resource::<Ready>().0 == all)).expect("the scenes are spawned");
    settle(&mut app);
    (app, roots, clips)
}

/// Plays a clip, and no other: by the players below each root, from a time of its own on. Returns how long it takes in seconds.
pub(crate) fn play(app: &mut App, clip: &Handle<AnimationClip>, roots: &[Entity], from: impl Fn(usize) -> f32) -> f32 {
    let world = app.world_mut();
    let duration = world.resource::<Assets<AnimationClip>>().get(clip).unwrap().duration();
    let (graph, node) = AnimationGraph::from_clip(clip.clone());
    let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
    let mut players = world.query::<(Entity, &mut AnimationPlayer)>();
    let found: Vec<Entity> = players.iter(world).map(|(player, _)| player).collect();
    for player in found {
        let is_above = |mut entity: Entity, root: Entity| loop {
            if entity == root {
                return true;
            }
            match world.get::<ChildOf>(entity) {
                Some(parent) => entity = parent.parent(),
                None => return false,
            }
        };
        let index = roots
            .iter()
            .position(|&root| is_above(player, root))
            .unwrap_or_default();
        let mut entity = world.entity_mut(player);
        entity.insert(AnimationGraphHandle(graph.clone()));
        let mut player = entity.get_mut::<AnimationPlayer>().unwrap();
        player.stop_all();
        player.play(node).seek_to(from(index));
    }
    duration
}
