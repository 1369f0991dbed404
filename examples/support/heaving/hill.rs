//! The hill: a glTF file that lies on the ground and plays its first clip.

use bevy::gltf::Gltf;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;

use crate::physics::wobbling;

/// The file, among the assets.
pub const MODEL: &str = "heaving_body_5120.glb";

/// Its largest width and height.
const SIZE: Vec2 = Vec2::new(10.5, 4.0);
/// How deep it is sunk into the ground, so that a flat underside is hidden.
const SUNK: f32 = 0.13;

/// The root of the hill's scene.
#[derive(Component, Clone, Debug)]
pub struct Hill {
    /// The file.
    pub gltf: Handle<Gltf>,
    /// Its extent from the origin and its height, at rest. Zero until it is placed.
    pub reach: Vec2,
}

/// Marks a hill whose scene is spawned.
#[derive(Component)]
pub(super) struct Spawned;

impl Hill {
    /// A hill that is not placed yet.
    #[must_use]
    pub fn new(gltf: Handle<Gltf>) -> Self {
        Self {
            gltf,
            reach: Vec2::ZERO,
        }
    }
}

/// Runs when the scene is spawned. Its animation player is somewhere below its root.
pub(super) fn play(
    ready: On<WorldInstanceReady>,
    hills: Query<&Hill>,
    children: Query<&Children>,
    mut players: Query<&mut AnimationPlayer>,
    gltfs: Res<Assets<Gltf>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut commands: Commands,
) {
    let Ok(hill) = hills.get(ready.entity) else { return };
    commands.entity(ready.entity).insert(Spawned);
    let clip = gltfs.get(&hill.gltf).and_then(|gltf| gltf.animations.first());
    let Some(clip) = clip else { return };
    let (graph, node) = AnimationGraph::from_clip(clip.clone());
    let graph = AnimationGraphHandle(graphs.add(graph));
    for entity in children.iter_descendants(ready.entity) {
        if let Ok(mut player) = players.get_mut(entity) {
            player.play(node).repeat();
            commands.entity(entity).insert(graph.clone());
        }
    }
}

/// Puts it on the ground, scaled to its largest allowed size.
pub(super) fn fit(
    mut hills: Query<(Entity, &mut Hill, &mut Transform), With<Spawned>>,
    parts: Query<(&Mesh3d, &GlobalTransform)>,
    children: Query<&Children>,
    meshes: Res<Assets<Mesh>>,
) {
    for (root, mut hill, mut place) in &mut hills {
        if hill.reach != Vec2::ZERO {
            continue;
        }
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (mesh, place) in parts.iter_many(children.iter_descendants(root)).flatten() {
            let positions = meshes
                .get(mesh)
                .and_then(|mesh| mesh.attribute(Mesh::ATTRIBUTE_POSITION));
            if let Some(VertexAttributeValues::Float32x3(positions)) = positions {
                for &position in positions {
                    let position = place.transform_point(position.into());
                    (min, max) = (min.min(position), max.max(position));
                }
            }
        }
        let size = max - min;
        if !(size.is_finite() && size.max_element() > 0.0) {
            continue;
        }
        let scale = (SIZE.x / size.x.max(size.z)).min(SIZE.y / size.y);
        let middle = 0.5 * (min + max).with_y(2.0 * min.y);
        *place = Transform::from_translation(-scale * middle - SUNK * Vec3::Y).with_scale(Vec3::splat(scale));
        hill.reach = scale * Vec2::new(0.5 * size.x.max(size.z), size.y) - SUNK * Vec2::Y;
    }
}

/// Whether it has become ready to be walked on since the last call.
pub(super) fn is_new(
    hills: Query<&Hill>,
    parts: Query<(&Mesh3d, Option<&SkinnedMesh>), With<MorphCollider>>,
    trees: Res<MorphTrees>,
    mut was: Local<bool>,
) -> bool {
    let lies = hills.iter().any(|hill| hill.reach != Vec2::ZERO);
    let is_done = |(mesh, skin): (&Mesh3d, Option<&SkinnedMesh>)| {
        trees.shown_with(mesh, None, skin).is_some() || trees.error(mesh.id()).is_some()
    };
    let is = lies && parts.iter().all(is_done);
    is && !std::mem::replace(&mut *was, is)
}

/// Starts the clip when everything is loaded, so that the game does not depend on the loading time.
pub(super) fn rewind(mut players: Query<&mut AnimationPlayer>) {
    for mut player in &mut players {
        player.rewind_all();
    }
}

/// Moves the weights of a file without a clip.
pub(super) fn wave(
    hills: Query<&Hill>,
    gltfs: Res<Assets<Gltf>>,
    time: Res<Time>,
    mut models: Query<&mut MorphWeights>,
    mut own: Query<&mut MeshMorphWeights>,
) {
    let is_still = |hill: &Hill| gltfs.get(&hill.gltf).is_some_and(|gltf| gltf.animations.is_empty());
    if !hills.iter().any(is_still) {
        return;
    }
    let take = |weights: &mut [f32]| weights.copy_from_slice(&wobbling(time.elapsed_secs(), weights.len()));
    for mut weights in &mut models {
        take(weights.weights_mut());
    }
    for mut weights in &mut own {
        if let MeshMorphWeights::Value { weights } = &mut *weights {
            take(weights);
        }
    }
}
