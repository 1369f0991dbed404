//! Who uses which tree: colliders request trees and receive them, and unused trees are dropped.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::app::{MorphCollisionSystems, Rows, any_added, any_changed, has, ran_long_ago};
use crate::components::{MorphCollider, MorphShape, MorphTreeOptions};
use crate::import::{MorphTrees, TreeKey};
use crate::state::{ColliderNews, ColliderState, MorphCollisionDiagnostics, Preparation, Runs};

/// The components that determine a collider's tree.
#[derive(QueryData)]
pub(crate) struct TreeUser {
    mesh: Option<&'static Mesh3d>,
    options: Option<&'static MorphTreeOptions>,
    skin: Option<&'static SkinnedMesh>,
    pub(super) has_shape: Has<MorphShape>,
}

impl TreeUserItem<'_, '_> {
    /// The key of the collider's tree; `None` if it shows no mesh or has a shape.
    pub(crate) fn key(&self) -> Option<TreeKey> {
        // A shape collides in place of the mesh.
        let mesh = self.mesh.filter(|_| !self.has_shape)?;
        Some(TreeKey::of(mesh, self.options, self.skin))
    }
}

/// The columns of the components that determine which tree a collider uses.
pub(super) type UseColumns = (
    Ref<'static, MorphCollider>,
    Option<Ref<'static, Mesh3d>>,
    Option<Ref<'static, MorphTreeOptions>>,
    Option<Ref<'static, SkinnedMesh>>,
    Option<Ref<'static, MorphShape>>,
    Has<Disabled>,
);

/// Whether any collider may need another tree than before because a component was added or changed.
pub(super) fn any_use_changed(columns: &Query<UseColumns>) -> bool {
    let Ok(mut tables) = columns.contiguous_iter() else {
        return true;
    };
    tables.any(|(collider, mesh, options, skin, shape, _)| {
        any_added(Some(&collider))
            || any_changed(mesh.as_ref())
            || any_changed(options.as_ref())
            || any_changed(skin.as_ref())
            || any_added(shape.as_ref())
    })
}

/// Colliders that may need another tree from before.
type UsesAnother = (
    Or<(
        Changed<Mesh3d>,
        Changed<MorphTreeOptions>,
        Changed<SkinnedMesh>,
        Added<MorphCollider>,
        Added<MorphShape>,
    )>,
    With<MorphCollider>,
    Allow<Disabled>,
);

/// Colliders that may need another tree because a component is gone.
#[derive(SystemParam)]
pub(crate) struct UsesLess<'w, 's> {
    options: RemovedComponents<'w, 's, MorphTreeOptions>,
    skins: RemovedComponents<'w, 's, SkinnedMesh>,
    shapes: RemovedComponents<'w, 's, MorphShape>,
}

impl UsesLess<'_, '_> {
    fn read(&mut self) -> impl Iterator<Item = Entity> {
        self.options.read().chain(self.skins.read()).chain(self.shapes.read())
    }
}

/// Requests the trees that colliders do not have yet.
///
/// It looks only at colliders that changed, found by their change ticks, unless any collider may need its tree again.
pub(crate) fn request_trees(
    colliders: Query<(Entity, TreeUser), With<MorphCollider>>,
    columns: Query<UseColumns>,
    changed: Query<(Entity, TreeUser, Has<Disabled>), UsesAnother>,
    mut less: UsesLess,
    mut enabled: RemovedComponents<Disabled>,
    mut trees: ResMut<MorphTrees>,
    mut preparation: ResMut<Preparation>,
) {
    let start = Instant::now();
    // Disabled entities did not notice when their trees were dropped.
    let anew = trees.is_stale() || enabled.read().count() > 0;
    let changed = any_use_changed(&columns).then(|| changed.iter()).into_iter().flatten();
    for (entity, user, is_disabled) in changed {
        trees.bypass_change_detection().uses_changed();
        if let Some(key) = user.key().filter(|_| !is_disabled) {
            trees.request(key, entity);
        }
    }
    let all = anew.then(|| colliders.iter()).into_iter().flatten();
    for (entity, user) in colliders.iter_many(less.read()).flatten().chain(all) {
        if let Some(key) = user.key() {
            trees.request(key, entity);
        }
    }
    preparation.import += start.elapsed();
}

/// Drops unused trees of a mesh while another tree of that mesh is in use. Runs only when a use may have ended or a tree is new.
pub(crate) fn drop_unused_trees(
    colliders: Query<TreeUser, (With<MorphCollider>, Allow<Disabled>)>,
    mut no_colliders: RemovedComponents<MorphCollider>,
    mut no_options: RemovedComponents<MorphTreeOptions>,
    mut no_meshes: RemovedComponents<Mesh3d>,
    mut no_skins: RemovedComponents<SkinnedMesh>,
    culled: Query<(&Mesh3d, Option<&SkinnedMesh>), (Or<(With<MeshMorphWeights>, With<SkinnedMesh>)>, Allow<Disabled>)>,
    culls: Option<Res<Culls>>,
    mut trees: ResMut<MorphTrees>,
    mut seen: Local<u64>,
) {
    let removed = no_colliders.read().count() + no_options.read().count() + no_meshes.read().count();
    let removed = removed + no_skins.read().count();
    let is_new = std::mem::replace(&mut *seen, trees.version()) != trees.version();
    let trees = trees.bypass_change_detection();
    if !trees.may_have_unused(removed > 0 || is_new) {
        return;
    }
    let mut used: HashSet<TreeKey> = colliders.iter().filter_map(|user| user.key()).collect();
    if culls.is_some() {
        used.extend(culled.iter().map(|(mesh, skin)| TreeKey::of(mesh, None, skin)));
    }
    trees.drop_unused(&used);
}

/// Marks that the bounds of deforming meshes are updated, which uses trees too.
#[derive(Resource)]
pub(crate) struct Culls;

/// The columns of the components that determine the pose of a collider.
type PoseColumns = (
    Entity,
    Ref<'static, MorphCollider>,
    Option<Ref<'static, Mesh3d>>,
    Option<Ref<'static, MorphTreeOptions>>,
    Option<Ref<'static, SkinnedMesh>>,
    Has<MorphShape>,
    Has<MeshMorphWeights>,
);

/// Gives colliders whose mesh or tree changed a new pose, or none while there is no tree. Says whether the colliders are others than in
/// the last run.
///
/// Compares mesh and settings by value, because it does not see what changed about disabled entities.
pub(crate) fn hand_out_trees(
    mut colliders: Query<(Entity, TreeUser, &mut ColliderState), With<MorphCollider>>,
    columns: Query<PoseColumns, With<ColliderState>>,
    mut rows: Local<Rows>,
    ticks: SystemChangeTick,
    runs: Res<Runs>,
    mut trees: ResMut<MorphTrees>,
    mut version: Local<u64>,
    mut news: ResMut<ColliderNews>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let tables = || columns.contiguous_iter().ok().into_iter().flatten();
    let lists = tables().map(|(entities, _, mesh, options, skin, has_shape, has_weights)| {
        let has = has([
            mesh.is_some(),
            options.is_some(),
            skin.is_some(),
            has_shape,
            has_weights,
        ]);
        (entities, has)
    });
    let are_same = columns.contiguous_iter().is_ok() && rows.replace(lists);
    news.are_others = !are_same || ran_long_ago(&ticks) || news.is_restored;
    let mut all = tables();
    let any_changed = all.any(|(_, collider, mesh, options, skin, ..)| {
        any_added(Some(&collider))
            || any_changed(mesh.as_ref())
            || any_changed(options.as_ref())
            || any_changed(skin.as_ref())
    });
    let every = *version != trees.version() || news.is_restored;
    *version = trees.version();
    if news.are_others || any_changed || every {
        for (entity, user, mut state) in &mut colliders {
            let was_away = !state.freshness.is_seen(&runs);
            let key = user.key();
            if !every && !was_away && state.tree == key {
                continue;
            }
            if let Some(key) = key.filter(|_| was_away) {
                trees.request(key, entity);
            }
            let tree = key.and_then(|key| trees.tree(key));
            if state.take_tree(key, tree) {
                news.reposed.push(entity);
            }
        }
    }
    diagnostics.spend(MorphCollisionSystems::Weights, start.elapsed());
}
