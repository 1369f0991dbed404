//! Events that report when colliders and scenes are ready.

use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::scene_part::ScenePart;
use super::users::{TreeUser, UseColumns, any_use_changed};
use crate::app::any_changed;
use crate::components::{MorphCollider, MorphShape, MorphTreeOptions};
use crate::import::{ImportError, MorphTrees};
use crate::state::{ColliderState, Readiness};

/// The collider's tree is built. It takes part from the next run on.
///
/// Triggered on the collider for its first tree and for each new one: when it shows another mesh, when its mesh was modified, or
/// when it got other [`MorphTreeOptions`]. Not triggered by changes of weights or joints. A [`MorphShape`] is ready immediately.
///
/// Always triggered in [`PostUpdate`], whatever schedule collision detection runs in, and even while it is
/// [paused](crate::components::MorphCollisionSettings::paused).
#[derive(EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Debug, Clone, PartialEq)]
pub struct MorphColliderReady {
    /// The collider.
    pub entity: Entity,
}

/// The collider's mesh cannot be used, or could not be loaded. This is also logged.
///
/// The collider is left out until it shows another mesh or the mesh is modified or loaded after all. If a tree of an earlier state of
/// the mesh exists, the collider keeps using that tree instead.
///
/// Also triggered on the root of a [`MorphColliderScene`](crate::components::MorphColliderScene) whose scene could not be loaded, with
/// [`ImportError::NotLoaded`]. A [`MorphColliderSceneReady`] without parts follows.
#[derive(EntityEvent, Reflect, Clone, Debug, PartialEq)]
#[reflect(Event, Debug, Clone, PartialEq)]
pub struct MorphColliderFailed {
    /// The collider, or the root of the scene.
    pub entity: Entity,
    /// What is wrong with the mesh, or with the scene.
    pub reason: ImportError,
}

/// Every part of a [`MorphColliderScene`](crate::components::MorphColliderScene) is ready or has failed.
///
/// Triggered on the scene's root, after the events of its parts. The parts of a glTF scene appear together when it is spawned, so
/// this event comes once for the whole scene. When parts are added, removed or get another mesh later, it is triggered again as
/// soon as all parts are ready.
///
/// A loading screen that waits for this event ends in any case (feature `gltf`, on by default): the event also comes, with `parts: 0`,
/// if the scene cannot be loaded, and if it is spawned and none of its meshes becomes a collider. The log says why. A scene that you
/// build by hand gets the event only when it has parts.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn show(ready: On<MorphColliderSceneReady>, mut scenes: Query<&mut Visibility>) {
///     if let Ok(mut visibility) = scenes.get_mut(ready.entity) {
///         *visibility = Visibility::Visible;
///     }
/// }
/// # App::new().add_observer(show);
/// ```
#[derive(EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Debug, Clone, PartialEq)]
pub struct MorphColliderSceneReady {
    /// The root of the scene.
    pub entity: Entity,
    /// How many meshes of the scene are colliders.
    pub parts: u32,
    /// How many of them cannot be used; each of these had a [`MorphColliderFailed`].
    pub failed: u32,
}

/// The parts of a scene.
#[derive(Default)]
pub(crate) struct Parts {
    count: u32,
    failed: u32,
    /// Whether any part is not ready yet.
    is_waiting: bool,
    /// Whether the root needs an event.
    is_news: bool,
}

/// Removals after which a collider may become ready or stop being ready.
#[derive(SystemParam)]
pub(crate) struct Removals<'w, 's> {
    colliders: RemovedComponents<'w, 's, MorphCollider>,
    shapes: RemovedComponents<'w, 's, MorphShape>,
    meshes: RemovedComponents<'w, 's, Mesh3d>,
    settings: RemovedComponents<'w, 's, MorphTreeOptions>,
    skins: RemovedComponents<'w, 's, SkinnedMesh>,
    parts: RemovedComponents<'w, 's, ScenePart>,
}

impl Removals<'_, '_> {
    fn read(&mut self) -> usize {
        let shows = self.shapes.read().count() + self.meshes.read().count() + self.settings.read().count();
        shows + self.skins.read().count() + self.colliders.read().count() + self.parts.read().count()
    }
}

/// Triggers the events that colliders and scene roots have not had yet. Runs only when a tree or a collider changed.
pub(crate) fn report_readiness(
    mut commands: Commands,
    mut colliders: Query<
        (Entity, TreeUser, &mut ColliderState, Option<&ScenePart>, Has<Disabled>),
        (With<MorphCollider>, Allow<Disabled>),
    >,
    columns: Query<UseColumns>,
    parts: Query<(Ref<ScenePart>, Has<Disabled>), With<MorphCollider>>,
    mut removals: Removals,
    mut trees: ResMut<MorphTrees>,
    mut version: Local<u64>,
    mut scenes: Local<EntityHashMap<Parts>>,
) {
    let news = trees.bypass_change_detection().take_news();
    let is_same = std::mem::replace(&mut *version, trees.version()) == trees.version();
    let part_changed = || {
        let tables = parts.contiguous_iter();
        tables.map_or(true, |mut tables| tables.any(|(part, _)| any_changed(Some(&part))))
    };
    if removals.read() == 0 && is_same && news.is_empty() && !any_use_changed(&columns) && !part_changed() {
        return;
    }
    let mut now = EntityHashMap::<Parts>::default();
    let mut settled: Vec<(Entity, Option<ImportError>)> = Vec::new();
    for (entity, user, mut state, part, is_disabled) in &mut colliders {
        let (key, has_shape) = (user.key(), user.has_shape);
        let outcome = key.and_then(|key| Some((key, trees.outcome(key)?)));
        let readiness = match outcome {
            _ if has_shape => Readiness::Ready(None),
            Some((key, Ok(()))) => Readiness::Ready(Some(key)),
            Some((key, Err(_))) => Readiness::Failed(key),
            None => Readiness::Nothing,
        };
        let is_new_tree = key.is_some_and(|key| news.contains(&key));
        let is_news = readiness != Readiness::Nothing && (is_new_tree || readiness != state.reported);
        if readiness != state.reported {
            state.reported = readiness;
        }
        if is_news {
            let reason = outcome.and_then(|(_, outcome)| outcome.err());
            settled.push((entity, reason.filter(|_| !has_shape).cloned()));
        }
        // Disabled colliders get no tree.
        if let Some(part) = part.filter(|_| readiness != Readiness::Nothing || !is_disabled) {
            let parts = now.entry(part.root).or_default();
            parts.count += 1;
            parts.failed += u32::from(matches!(readiness, Readiness::Failed(_)));
            parts.is_waiting |= readiness == Readiness::Nothing;
            parts.is_news |= is_news;
        }
    }
    settled.sort_unstable_by_key(|(entity, _)| *entity);
    for (entity, reason) in settled {
        match reason {
            None => commands.trigger(MorphColliderReady { entity }),
            Some(reason) => commands.trigger(MorphColliderFailed { entity, reason }),
        }
    }
    let mut ready: Vec<MorphColliderSceneReady> = Vec::new();
    for (&entity, parts) in &mut now {
        let before = scenes.get(&entity);
        let is_news = before.is_none_or(|before| before.is_news || before.count != parts.count);
        parts.is_news |= is_news || parts.is_waiting;
        if parts.is_news && !parts.is_waiting {
            parts.is_news = false;
            ready.push(MorphColliderSceneReady {
                entity,
                parts: parts.count,
                failed: parts.failed,
            });
        }
    }
    *scenes = now;
    ready.sort_unstable_by_key(|ready| ready.entity);
    ready.into_iter().for_each(|ready| commands.trigger(ready));
}
