//! Scenes whose meshes become colliders by themselves.

use bevy::platform::time::Instant;

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;

use crate::collider::{MorphBody, MorphCollider};
use crate::diagnostics::Preparation;
use crate::events::MorphCollisionEventsEnabled;
use crate::layers::MorphCollisionLayers;
use crate::settings::MorphCollisionSettings;

/// Put on the root of a scene: every mesh below becomes a [`MorphCollider`], and all of them are parts of one body.
///
/// Works with scenes spawned from an asset (`WorldAssetRoot`) and with entities spawned by hand, whether the component or the
/// meshes come first; meshes that appear later are found too. Parts of one body never collide with each other. A part
/// that has a [`MorphCollider`] or [`MorphBody`] of its own keeps it. Removing this component makes its parts ordinary
/// meshes again.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphColliderScene {
    /// What the parts get.
    pub collider: MorphCollider,
    /// The parts' layers.
    pub layers: MorphCollisionLayers,
    /// Whether to leave out meshes without [`MeshMorphWeights`]: the rigid ones.
    pub only_morphing: bool,
    /// If not empty: only meshes whose [`Name`] is one of these, or which are below an entity of the scene whose name is. A
    /// glTF node's name stands on the entity above its meshes.
    pub only_named: Vec<String>,
    /// Whether the parts get [`MorphCollisionEventsEnabled`].
    pub events: bool,
}

impl Default for MorphColliderScene {
    fn default() -> Self {
        Self {
            collider: MorphCollider::default(),
            layers: MorphCollisionLayers::default(),
            only_morphing: true,
            only_named: Vec::new(),
            events: false,
        }
    }
}

/// What a scene gave to one of its parts, and takes back.
#[derive(Component)]
pub(crate) struct ScenePart {
    root: Entity,
    collider: bool,
    body: bool,
    events: bool,
}

/// Set when something came into the world unnoticed by change detection: all scenes are looked through.
#[derive(Resource, Default)]
pub(crate) struct LookAgain(bool);

/// What is enabled again may have changed meanwhile.
pub(crate) fn look_again(_: On<Remove<Disabled>>, mut look_again: ResMut<LookAgain>) {
    look_again.0 = true;
}

/// What may be a new part of a scene, or lead to one.
type PartNews = Or<(Added<Mesh3d>, Added<MeshMorphWeights>, Changed<ChildOf>, Changed<Name>)>;

/// What a mesh has already: weights, a collider, a body.
type PartHas = (Has<MeshMorphWeights>, Has<MorphCollider>, Has<MorphBody>);

/// Meshes below a [`MorphColliderScene`] become colliders.
///
/// Goes by what is new in the hierarchy rather than by a scene's "ready" event: this needs no scene feature of Bevy, and
/// finds meshes however they got there.
pub(crate) fn add_scene_parts(
    mut commands: Commands,
    scenes: Query<&MorphColliderScene>,
    changed_scenes: Query<Entity, Changed<MorphColliderScene>>,
    all_scenes: Query<Entity, With<MorphColliderScene>>,
    look_again: Res<LookAgain>,
    news: Query<Entity, PartNews>,
    names: Query<&Name>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    meshes: Query<PartHas, With<Mesh3d>>,
    parts: Query<(Entity, &ScenePart)>,
    mut orphaned: RemovedComponents<ChildOf>,
    mut preparation: ResMut<Preparation>,
) {
    let start = Instant::now();
    let moved = !news.is_empty() || orphaned.read().count() > 0;
    if moved || look_again.0 {
        // Parts that hang on another scene now, or on none.
        for (part, of) in parts
            .iter()
            .filter(|(part, of)| scene_root(*part, &scenes, &parents) != Some(of.root))
        {
            of.take_back(commands.entity(part));
        }
    }
    let mut roots: EntityHashSet = changed_scenes.iter().collect();
    if !scenes.is_empty() {
        roots.extend(news.iter().filter_map(|part| scene_root(part, &scenes, &parents)));
    }
    if look_again.0 {
        roots.extend(&all_scenes);
    }
    for root in roots {
        let Ok(scene) = scenes.get(root) else { continue };
        for part in std::iter::once(root).chain(children.iter_descendants(root)) {
            let Ok((morphs, mut is_collider, mut has_body)) = meshes.get(part) else {
                continue;
            };
            let before = parts.get(part).ok().map(|(_, before)| before);
            if let Some(before) = before.filter(|before| before.root != root) {
                // Taken back above.
                (is_collider, has_body) = (is_collider && !before.collider, has_body && !before.body);
            } else if before.is_some() {
                continue;
            }
            // A scene within a scene is a body of its own.
            if scene_root(part, &scenes, &parents) != Some(root) || (scene.only_morphing && !morphs && !is_collider) {
                continue;
            }
            if !is_collider && !is_named(part, root, &scene.only_named, &names, &parents) {
                continue;
            }
            let mut part = commands.entity(part);
            part.try_insert(ScenePart {
                root,
                collider: !is_collider,
                body: !has_body,
                events: !is_collider && scene.events,
            });
            if !is_collider {
                part.try_insert((scene.collider, scene.layers));
                if scene.events {
                    part.try_insert(MorphCollisionEventsEnabled);
                }
            }
            if !has_body {
                part.try_insert(MorphBody(root));
            }
        }
    }
    preparation.0 += start.elapsed();
}

impl ScenePart {
    fn take_back(&self, mut part: EntityCommands<'_>) {
        part.try_remove::<Self>();
        if self.collider {
            part.try_remove::<(MorphCollider, MorphCollisionLayers)>();
        }
        if self.body {
            part.try_remove::<MorphBody>();
        }
        if self.events {
            part.try_remove::<MorphCollisionEventsEnabled>();
        }
    }
}

/// The nearest scene root at or above an entity.
fn scene_root(part: Entity, scenes: &Query<&MorphColliderScene>, parents: &Query<&ChildOf>) -> Option<Entity> {
    std::iter::once(part)
        .chain(parents.iter_ancestors(part))
        .find(|&entity| scenes.contains(entity))
}

/// Whether an entity, or one above it up to the scene's root, has one of some names; any will do if there are none.
fn is_named(part: Entity, root: Entity, wanted: &[String], names: &Query<&Name>, parents: &Query<&ChildOf>) -> bool {
    let mut path = std::iter::once(part).chain(parents.iter_ancestors(part));
    let mut done = false;
    wanted.is_empty()
        || path.any(|entity| {
            let is_one = !done
                && names
                    .get(entity)
                    .is_ok_and(|name| wanted.iter().any(|w| w == name.as_str()));
            done |= entity == root;
            is_one
        })
}

/// Meshes with morph weights that are no colliders yet and came, or were changed, since the last run.
type LooseMorphs = (With<Mesh3d>, Without<MorphCollider>);

/// With [`MorphCollisionSettings::every_morphing_mesh`] set, every morphing mesh becomes a collider; what hangs on one root of the
/// hierarchy is one body.
pub(crate) fn add_every_morphing_mesh(
    mut commands: Commands,
    settings: Res<MorphCollisionSettings>,
    mut look_again: ResMut<LookAgain>,
    fresh: Query<Entity, (LooseMorphs, Or<(Added<Mesh3d>, Added<MeshMorphWeights>)>)>,
    all: Query<Entity, (LooseMorphs, With<MeshMorphWeights>)>,
    bodies: Query<(), With<MorphBody>>,
    parents: Query<&ChildOf>,
) {
    let again = std::mem::take(&mut look_again.bypass_change_detection().0);
    let Some(collider) = settings.every_morphing_mesh else {
        return;
    };
    let mut add = |mesh: Entity| {
        let mut entity = commands.entity(mesh);
        entity.try_insert(collider);
        if !bodies.contains(mesh) {
            entity.try_insert(MorphBody(parents.root_ancestor(mesh)));
        }
    };
    if settings.is_changed() || again {
        all.iter().for_each(&mut add);
    } else {
        fresh.iter().filter(|&mesh| all.contains(mesh)).for_each(&mut add);
    }
}

/// Parts of a scene that collides no longer are what they were before it.
pub(crate) fn forget_scene(
    removed: On<Remove<MorphColliderScene>>,
    parts: Query<(Entity, &ScenePart)>,
    mut commands: Commands,
) {
    for (part, of) in parts.iter().filter(|(_, of)| of.root == removed.entity) {
        of.take_back(commands.entity(part));
    }
}
