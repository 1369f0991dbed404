//! Scenes whose meshes become colliders automatically.

use bevy::platform::time::Instant;

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::body::{MorphColliderOf, body_of, give_body};
use crate::collider::{MorphCollider, follows};
use crate::diagnostics::Preparation;
use crate::events::MorphCollisionEventsEnabled;
use crate::every_mesh::Automatic;
use crate::layers::MorphCollisionLayers;
use crate::misuse::Suspects;
use crate::scene_outcomes::OpenScenes;
use crate::spawned_scenes::SpawnedScenes;

/// Turns the meshes below this entity into [`MorphCollider`]s: by default those that deform. Put it on the root of a scene; all its
/// colliders become parts of one body.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
///     commands.spawn((
///         WorldAssetRoot(assets.load("face.glb#Scene0")),
///         MorphColliderScene { only_named: vec!["Mouth".into()], ..default() },
///     ));
/// }
/// # App::new().add_systems(Startup, spawn);
/// ```
///
/// The body is the entity with this component. Observe [`MorphBodyCollisionStart`](crate::MorphBodyCollisionStart) and
/// [`MorphBodyCollisionEnd`](crate::MorphBodyCollisionEnd) on it, or add
/// [`MorphCollidingEntities`](crate::MorphCollidingEntities) to it.
///
/// It works with scenes spawned from an asset (`WorldAssetRoot`) and with entities spawned by hand. Either the component or the
/// meshes can come first, and meshes that appear later are found too. Parts of one body never collide with each other.
///
/// If the scene makes no colliders, or a name in [`only_named`](Self::only_named) matches nothing, a warning in the log says why: for a
/// scene from an asset when it is spawned, otherwise after some seconds.
///
/// You can edit or re-insert the component at any time. Meshes that no longer match stop being parts, and meshes that now match
/// become parts. Removing the component turns all parts back into ordinary meshes.
///
/// Components that you put on a part stay yours:
///
/// - A mesh that already has a [`MorphCollider`] joins the body, whatever its name, and keeps its collider, layers and events.
///   The scene also keeps [`MorphCollisionLayers`], [`MorphColliderOf`] and [`MorphCollisionEventsEnabled`] that were there
///   first.
/// - If you change or remove a component that the scene added, later edits of the scene do not touch it.
/// - When a part leaves the scene, what the scene added is removed: the collider even if you changed it since, but layers and
///   body only if you did not.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphColliderScene {
    /// The collider of each part.
    pub collider: MorphCollider,
    /// The layers of each part.
    pub layers: MorphCollisionLayers,
    /// Leaves out rigid meshes, which have neither [`MeshMorphWeights`] nor [`SkinnedMesh`].
    pub only_deforming: bool,
    /// If not empty, only meshes with one of these [`Name`]s, or below an entity of the scene with one of these names, become
    /// parts. In a glTF scene, a node's name is on the entity above its meshes.
    pub only_named: Vec<String>,
    /// Whether the parts get [`MorphCollisionEventsEnabled`].
    pub events: bool,
}

impl Default for MorphColliderScene {
    fn default() -> Self {
        Self {
            collider: MorphCollider::default(),
            layers: MorphCollisionLayers::default(),
            only_deforming: true,
            only_named: Vec::new(),
            events: false,
        }
    }
}

/// What a scene gave to one of its parts. A field is `None` if the part had its own.
#[derive(Component, Clone, Copy, PartialEq)]
pub(crate) struct ScenePart {
    pub(crate) root: Entity,
    collider: Option<MorphCollider>,
    layers: Option<MorphCollisionLayers>,
    /// The body that the scene assigned; the part itself if it is the root.
    body: Option<Entity>,
    events: bool,
}

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

/// Scenes and the hierarchy below them.
#[derive(SystemParam)]
pub(crate) struct Hierarchy<'w, 's> {
    scenes: Query<'w, 's, Ref<'static, MorphColliderScene>, Allow<Disabled>>,
    names: Query<'w, 's, &'static Name, Allow<Disabled>>,
    parents: Query<'w, 's, &'static ChildOf, Allow<Disabled>>,
    children: Query<'w, 's, &'static Children, Allow<Disabled>>,
}

impl Hierarchy<'_, '_> {
    /// An entity and its ancestors, nearest first.
    fn path(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        std::iter::once(entity).chain(self.parents.iter_ancestors(entity))
    }

    /// An entity and its ancestors up to a root, which is one of them.
    pub(crate) fn path_below(&self, entity: Entity, root: Entity) -> impl Iterator<Item = Entity> {
        let below = self.path(entity).take_while(move |&entity| entity != root);
        below.chain([root])
    }

    /// The descendants of an entity.
    pub(crate) fn below(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        self.children.iter_descendants(entity)
    }

    /// The nearest scene root at or above an entity.
    pub(crate) fn scene_root(&self, part: Entity) -> Option<Entity> {
        self.path(part).find(|&entity| self.scenes.contains(entity))
    }

    /// Whether an entity, or an ancestor up to the scene's root, has one of the names. Always true without names.
    fn is_named(&self, part: Entity, root: Entity, wanted: &[String]) -> bool {
        let is_one = |entity: Entity| {
            let name = self.names.get(entity);
            name.is_ok_and(|name| wanted.iter().any(|wanted| wanted == name.as_str()))
        };
        wanted.is_empty() || self.path_below(part, root).any(is_one)
    }
}

/// Updates the parts of every [`MorphColliderScene`].
///
/// It reacts to changes in the hierarchy instead of a scene's "ready" event. This needs no scene feature of Bevy and finds meshes
/// however they were spawned.
pub(crate) fn update_scene_parts(
    mut commands: Commands,
    hierarchy: Hierarchy,
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
    // Without a scene there are no parts. The search for news would look at every mesh.
    if removed.is_empty() && hierarchy.scenes.is_empty() {
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
    preparation.0 += start.elapsed();
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
            && follows(new, given, self.collider, scene.collider, MorphCollider::is_same)
        {
            entity.try_insert(scene.collider);
        }
        if let Some(given) = &mut part.layers
            && follows(new, given, self.layers, scene.layers, PartialEq::eq)
        {
            entity.try_insert(scene.layers);
        }
        if let Some(given) = &mut part.body
            && follows(new, given, Some(&self.body()), root, PartialEq::eq)
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
