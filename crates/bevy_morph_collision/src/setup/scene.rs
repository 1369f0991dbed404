//! Scenes whose meshes become colliders automatically.

use bevy::platform::time::Instant;

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::automatic::Automatic;
use super::given::should_update;
use super::hierarchy::Hierarchy;
use super::open_scenes::OpenScenes;
use super::scene_part::ScenePart;
use crate::app::{Suspects, any_added, any_changed};
use crate::components::{
    MorphCollider, MorphColliderOf, MorphColliderScene, MorphCollisionEventsEnabled, MorphCollisionLayers, body_of,
    give_body,
};
use crate::setup::SpawnedScenes;
use crate::state::Preparation;

/// A mesh, or a part that used to be one.
#[derive(QueryData)]
pub(crate) struct PartNow {
    entity: Entity,
    part: Option<&'static ScenePart>,
    is_mesh: Has<Mesh3d>,
    deforms: (Has<MeshMorphWeights>, Has<SkinnedMesh>),
    collider: Option<&'static MorphCollider>,
    layers: Option<&'static MorphCollisionLayers>,
    body: Option<&'static MorphColliderOf>,
    events: Has<MorphCollisionEventsEnabled>,
    automatic: Option<&'static Automatic>,
}

/// Meshes and parts, including those of disabled entities, so that they are up to date when they are enabled again.
type PartQuery<'w, 's> = Query<'w, 's, PartNow, (Or<(With<Mesh3d>, With<ScenePart>)>, Allow<Disabled>)>;

/// The columns of the components in [`PartNews`].
type PartColumns = (
    Option<Ref<'static, Mesh3d>>,
    Option<Ref<'static, MeshMorphWeights>>,
    Option<Ref<'static, SkinnedMesh>>,
    Option<Ref<'static, MorphCollider>>,
    Option<Ref<'static, ChildOf>>,
    Option<Ref<'static, Name>>,
    Option<Ref<'static, MorphColliderScene>>,
    Has<Disabled>,
);

/// Tables with any of these components.
type HasPartColumn = Or<(
    With<Mesh3d>,
    With<MeshMorphWeights>,
    With<SkinnedMesh>,
    With<MorphCollider>,
    With<ChildOf>,
    With<Name>,
    With<MorphColliderScene>,
)>;

/// Whether there may be any [`PartNews`].
fn any_news(columns: &Query<PartColumns, HasPartColumn>) -> bool {
    let Ok(mut tables) = columns.contiguous_iter() else {
        return true;
    };
    tables.any(|(mesh, weights, skin, collider, parent, name, scene, _)| {
        any_added(mesh.as_ref())
            || any_added(weights.as_ref())
            || any_added(skin.as_ref())
            || any_added(collider.as_ref())
            || any_changed(parent.as_ref())
            || any_changed(name.as_ref())
            || any_changed(scene.as_ref())
    })
}

/// Changes that may turn a mesh, or a mesh below, into a part.
type PartNews = (
    Or<(
        Added<Mesh3d>,
        Added<MeshMorphWeights>,
        Added<SkinnedMesh>,
        Added<MorphCollider>,
        Changed<ChildOf>,
        Changed<Name>,
        Changed<MorphColliderScene>,
    )>,
    Allow<Disabled>,
);

/// Removals with the same effect.
#[derive(SystemParam)]
pub(crate) struct PartRemovals<'w, 's> {
    meshes: RemovedComponents<'w, 's, Mesh3d>,
    weights: RemovedComponents<'w, 's, MeshMorphWeights>,
    skins: RemovedComponents<'w, 's, SkinnedMesh>,
    parents: RemovedComponents<'w, 's, ChildOf>,
    names: RemovedComponents<'w, 's, Name>,
    scenes: RemovedComponents<'w, 's, MorphColliderScene>,
}

impl PartRemovals<'_, '_> {
    fn read(&mut self) -> impl Iterator<Item = Entity> {
        let entities = self.meshes.read().chain(self.weights.read()).chain(self.skins.read());
        let entities = entities.chain(self.parents.read()).chain(self.names.read());
        entities.chain(self.scenes.read())
    }
}

/// Updates the parts of every [`MorphColliderScene`].
///
/// It reacts to changes in the hierarchy instead of a scene's "ready" event. This needs no scene feature of Bevy and finds meshes
/// however they were spawned.
pub(crate) fn update_scene_parts(
    mut commands: Commands,
    hierarchy: Hierarchy,
    columns: Query<PartColumns, HasPartColumn>,
    news: Query<Entity, PartNews>,
    mut removals: PartRemovals,
    parts: PartQuery,
    spawned: SpawnedScenes,
    mut open: ResMut<OpenScenes>,
    mut suspects: ResMut<Suspects>,
    mut preparation: ResMut<Preparation>,
) {
    let start = Instant::now();
    let removed: Vec<Entity> = removals.read().collect();
    // Without a scene there are no parts. The search for news looks at every mesh.
    if removed.is_empty() && (hierarchy.scenes.is_empty() || !any_news(&columns)) {
        preparation.import += start.elapsed();
        return;
    }
    let mut roots = EntityHashSet::default();
    let mut anything = false;
    for entity in news.iter().chain(removed) {
        anything = true;
        let Some(root) = hierarchy.scene_root(entity) else {
            continue;
        };
        roots.insert(root);
        // It may only now have come below this scene.
        if entity != root && spawned.is_root(entity) {
            open.open(root);
        }
    }
    if anything {
        let left = |part: &PartNowItem| part.part.is_some() && hierarchy.scene_root(part.entity).is_none();
        for part in parts.iter().filter(left) {
            part.take_back(&mut commands);
        }
    }
    for root in roots {
        let Ok(scene) = hierarchy.scenes.get(root) else {
            continue;
        };
        if scene.is_changed() {
            open.open(root);
            suspects.note(root);
        }
        for entity in std::iter::once(root).chain(hierarchy.below(root)) {
            let Ok(part) = parts.get(entity) else { continue };
            // A scene within a scene is a body of its own.
            if hierarchy.scene_root(entity) == Some(root) {
                let is_named = hierarchy.is_named(entity, root, &scene.only_named);
                part.update(root, &scene, is_named, &mut commands);
            }
        }
    }
    preparation.import += start.elapsed();
}

impl PartNowItem<'_, '_> {
    /// Makes a mesh a part, updates the part, or turns it back into a mesh, as the scene now requires.
    fn update(&self, root: Entity, scene: &MorphColliderScene, is_named: bool, commands: &mut Commands) {
        let before = self.part;
        let gives = before.map_or(!self.has_own_collider(), |before| before.collider.is_some());
        let is_rigid = self.deforms == (false, false);
        let matches = is_named && !(is_rigid && scene.only_deforming);
        if !self.is_mesh || (gives && !matches) {
            self.take_back(commands);
            return;
        }
        let mut entity = commands.entity(self.entity);
        let new = before.is_none();
        if new && gives {
            // Scenes take precedence over the setting for all meshes.
            entity.try_remove::<Automatic>();
        }
        let mut part = before.copied().unwrap_or_else(|| self.first(root, scene, gives));
        part.root = root;
        if let Some(given) = &mut part.collider
            && should_update(new, given, self.collider, scene.collider, MorphCollider::is_same)
        {
            entity.try_insert(scene.collider);
        }
        if let Some(given) = &mut part.layers
            && should_update(new, given, self.layers, scene.layers, PartialEq::eq)
        {
            entity.try_insert(scene.layers);
        }
        if let Some(given) = &mut part.body
            && should_update(new, given, Some(&self.body()), root, PartialEq::eq)
        {
            give_body(&mut entity, root);
        }
        if part.events && !scene.events {
            part.events = false;
            entity.try_remove::<MorphCollisionEventsEnabled>();
        } else if gives && scene.events && !part.events && !self.events {
            part.events = true;
            entity.try_insert(MorphCollisionEventsEnabled);
        }
        if before != Some(&part) {
            entity.try_insert(part);
        }
    }

    /// What a scene gives to a mesh that becomes a part: everything that the user has not put there.
    fn first(&self, root: Entity, scene: &MorphColliderScene, gives: bool) -> ScenePart {
        let automatic = self.automatic();
        let gives_layers = gives && (self.layers.is_none() || automatic.gave_layers(self.layers));
        let gives_body = self.body.is_none() || automatic.gave_body(self.body());
        ScenePart {
            root,
            collider: gives.then(|| self.collider.copied().unwrap_or(scene.collider)),
            layers: gives_layers.then(|| self.layers.copied().unwrap_or(scene.layers)),
            body: gives_body.then(|| self.body()),
            events: false,
        }
    }

    /// The part's current body.
    fn body(&self) -> Entity {
        body_of(self.entity, self.body)
    }

    fn has_own_collider(&self) -> bool {
        self.collider.is_some() && !self.automatic().gave_collider(self.collider)
    }

    fn automatic(&self) -> Automatic {
        self.automatic.copied().unwrap_or_default()
    }

    /// Turns a part back into an ordinary mesh.
    fn take_back(&self, commands: &mut Commands) {
        let Some(part) = self.part else { return };
        let mut entity = commands.entity(self.entity);
        entity.try_remove::<ScenePart>();
        if part.collider.is_some() {
            entity.try_remove::<MorphCollider>();
        }
        if part.layers.is_some() && part.layers.as_ref() == self.layers {
            entity.try_remove::<MorphCollisionLayers>();
        }
        if part.body == Some(self.body()) {
            entity.try_remove::<MorphColliderOf>();
        }
        if part.events {
            entity.try_remove::<MorphCollisionEventsEnabled>();
        }
    }
}

/// When the scene component is removed, its parts become ordinary meshes again.
pub(crate) fn forget_scene(removed: On<Remove<MorphColliderScene>>, parts: PartQuery, mut commands: Commands) {
    let of_scene = |part: &PartNowItem| part.part.is_some_and(|of| of.root == removed.entity);
    for part in parts.iter().filter(of_scene) {
        part.take_back(&mut commands);
    }
}
