//! What users put on entities, and the plugin's own state beside it.

use bevy::ecs::entity::EntityHashSet;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use morph_collision::{Pose, WorldFromModel};

use crate::events::MorphCollisionEventsEnabled;

/// Makes the [`Mesh3d`] of this entity collide, at its current morph weights and [`GlobalTransform`].
///
/// Any affine transform will do: mirrored, sheared, scaled by zero. A mesh without morph targets is rigid. The collider takes
/// part as soon as its mesh is loaded and the mesh's tree is built; while a swapped mesh is being prepared, it is left out.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform, ColliderState)]
pub struct MorphCollider {
    /// How much a contact of this collider should tell.
    pub mode: CollisionMode,
}

/// How much a contact tells. Of the two colliders of a pair the one that asks for more decides.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[reflect(Debug, Default, Clone, PartialEq, Hash)]
pub enum CollisionMode {
    /// Only whether they touch. As cheap as [`CollisionMode::First`].
    Any,
    /// One pair of intersecting triangles, the first that is found.
    First,
    /// Every pair of intersecting triangles.
    #[default]
    All,
}

/// Put on the root of a scene: every mesh below becomes a [`MorphCollider`], and all of them are parts of one body.
///
/// Works with scenes spawned from an asset (`WorldAssetRoot`) and with entities spawned by hand, whether the component or the
/// meshes come first; meshes that appear later are found too. Parts of one body never collide with each other. A part
/// that has a [`MorphCollider`] or [`MorphBody`] of its own keeps it. Removing this component makes its parts ordinary
/// meshes again.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphColliderScene {
    /// The colliders' mode.
    pub mode: CollisionMode,
    /// Whether to leave out meshes without [`MeshMorphWeights`]: the rigid ones.
    pub only_morphing: bool,
    /// Whether the parts get [`MorphCollisionEventsEnabled`].
    pub events: bool,
}

impl Default for MorphColliderScene {
    fn default() -> Self {
        Self {
            mode: CollisionMode::default(),
            only_morphing: true,
            events: false,
        }
    }
}

/// The body that a collider is part of, named by any entity, usually the root of its scene.
///
/// Colliders of one body never collide with each other. A collider without this component is a body of its own.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
pub struct MorphBody(#[entities] pub Entity);

/// The plugin's state of one collider.
#[derive(Component, Default)]
pub(crate) struct ColliderState {
    /// The instance of the mesh's tree; none while there is no tree.
    pub(crate) pose: Option<Pose>,
    /// How it took part in the last frame; none if it did not.
    pub(crate) placed: Option<Placement>,
    /// Whether the pose has other weights, or is another one, than when its bounds were last asked for.
    pub(crate) reposed: bool,
    /// Whether anything an answer depends on differs from the last frame.
    pub(crate) changed: bool,
    /// The complaint about the weights that is in the log, so that it is not logged every frame.
    pub(crate) bad_weights: bool,
    /// Likewise about the transform.
    pub(crate) bad_transform: bool,
}

/// What the narrow phase goes by besides the pose.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub(crate) world_from_model: WorldFromModel,
    pub(crate) body: Entity,
    pub(crate) mode: CollisionMode,
}

/// What may be a new part of a scene, or lead to one.
type PartNews = Or<(Added<Mesh3d>, Added<MeshMorphWeights>, Changed<ChildOf>)>;

/// What a mesh has already: weights, a collider, a body.
type PartHas = (Has<MeshMorphWeights>, Has<MorphCollider>, Has<MorphBody>);

/// Meshes below a [`MorphColliderScene`] become colliders.
///
/// Goes by what is new in the hierarchy rather than by a scene's "ready" event: this needs no scene feature of Bevy, and
/// finds meshes however they got there.
pub(crate) fn add_scene_parts(
    mut commands: Commands,
    scenes: Query<&MorphColliderScene>,
    new_scenes: Query<Entity, Added<MorphColliderScene>>,
    news: Query<Entity, PartNews>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    meshes: Query<PartHas, With<Mesh3d>>,
) {
    if scenes.is_empty() {
        return;
    }
    let mut roots: EntityHashSet = new_scenes.iter().collect();
    roots.extend(news.iter().filter_map(|part| scene_root(part, &scenes, &parents)));
    for root in roots {
        let Ok(scene) = scenes.get(root) else { continue };
        for part in std::iter::once(root).chain(children.iter_descendants(root)) {
            let Ok((morphs, is_collider, has_body)) = meshes.get(part) else {
                continue;
            };
            // A scene within a scene is a body of its own.
            if scene_root(part, &scenes, &parents) != Some(root) || (scene.only_morphing && !morphs && !is_collider) {
                continue;
            }
            let mut part = commands.entity(part);
            if !is_collider {
                part.insert(MorphCollider { mode: scene.mode });
                if scene.events {
                    part.insert(MorphCollisionEventsEnabled);
                }
            }
            if !has_body {
                part.insert(MorphBody(root));
            }
        }
    }
}

/// The nearest scene root at or above an entity.
fn scene_root(part: Entity, scenes: &Query<&MorphColliderScene>, parents: &Query<&ChildOf>) -> Option<Entity> {
    std::iter::once(part)
        .chain(parents.iter_ancestors(part))
        .find(|&entity| scenes.contains(entity))
}

/// A collider that is one no longer keeps no state.
pub(crate) fn forget_collider(removed: On<Remove<MorphCollider>>, mut commands: Commands) {
    commands.entity(removed.entity).try_remove::<ColliderState>();
}

/// Parts of a scene that collides no longer are ordinary meshes again.
pub(crate) fn forget_scene(
    removed: On<Remove<MorphColliderScene>>,
    parts: Query<(Entity, &MorphBody), With<MorphCollider>>,
    mut commands: Commands,
) {
    for (part, _) in parts.iter().filter(|(_, body)| body.0 == removed.entity) {
        commands
            .entity(part)
            .try_remove::<(MorphCollider, MorphBody, MorphCollisionEventsEnabled)>();
    }
}
