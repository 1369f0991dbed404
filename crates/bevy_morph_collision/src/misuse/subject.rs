//! The components of one entity, and what is around it.

use bevy::ecs::archetype::Archetype;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::{Allow, QueryData};
use bevy::ecs::system::SystemParam;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::physics::ColliderComponents;
use crate::app::Names;
use crate::components::{
    MorphActiveCollisionHooks, MorphBodyRoot, MorphCollider, MorphColliderDisabled, MorphColliderOf,
    MorphColliderScene, MorphColliders, MorphCollisionEventsEnabled, MorphCollisionLayers, MorphCollisionSettings,
    MorphShape, MorphTeleported, MorphTreeOptions,
};
use crate::events::MorphCollidingEntities;
use crate::hooks::HooksInApp;
use crate::import::{MorphTrees, TreeKey};
use crate::self_collisions::MorphSelfCollisions;
use crate::setup::{Hierarchy, SpawnedScenes, TreeUser};
use crate::surface::MorphSurfaceAnchor;

/// The components of one entity.
#[derive(QueryData)]
pub(super) struct Subject {
    pub(super) entity: Entity,
    pub(super) mesh: Has<Mesh3d>,
    pub(super) deforms: (Has<MeshMorphWeights>, Has<SkinnedMesh>),
    pub(super) shape: Has<MorphShape>,
    pub(super) collider: Option<&'static MorphCollider>,
    pub(super) scene: Option<&'static MorphColliderScene>,
    pub(super) anchor: Option<&'static MorphSurfaceAnchor>,
    pub(super) self_collisions: Has<MorphSelfCollisions>,
    pub(super) tree_options: Has<MorphTreeOptions>,
    pub(super) disabled: Has<MorphColliderDisabled>,
    pub(super) layers: Has<MorphCollisionLayers>,
    pub(super) events: Has<MorphCollisionEventsEnabled>,
    pub(super) colliding: Has<MorphCollidingEntities>,
    pub(super) part_of: Has<MorphColliderOf>,
    pub(super) parts: Has<MorphColliders>,
    pub(super) body_root: Has<MorphBodyRoot>,
    pub(super) teleported: Has<MorphTeleported>,
    pub(super) hooks: Has<MorphActiveCollisionHooks>,
    /// Tells which components of other crates it has.
    pub(super) archetype: &'static Archetype,
}

/// What is around an entity.
#[derive(SystemParam)]
pub(super) struct Around<'w, 's> {
    pub(super) subjects: Query<'w, 's, Subject, Allow<Disabled>>,
    tree_users: Query<'w, 's, TreeUser, Allow<Disabled>>,
    pub(super) hierarchy: Hierarchy<'w, 's>,
    pub(super) spawned: SpawnedScenes<'w, 's>,
    pub(super) names: Names<'w, 's>,
    pub(super) trees: Res<'w, MorphTrees>,
    pub(super) settings: Res<'w, MorphCollisionSettings>,
    pub(super) others: Res<'w, ColliderComponents>,
    pub(super) hooks: Option<Res<'w, HooksInApp>>,
}

impl Around<'_, '_> {
    /// An entity in messages.
    pub(super) fn name(&self, entity: Entity) -> String {
        self.names.with_file(entity)
    }

    /// What distinguishes an entity from others with the same mistake.
    pub(super) fn about(&self, entity: Entity) -> String {
        self.names.about(entity)
    }

    /// The tree that an entity uses.
    pub(super) fn tree_key(&self, entity: Entity) -> Option<TreeKey> {
        self.tree_users.get(entity).ok()?.key()
    }

    /// Whether the scene that an entity spawns is not there yet.
    pub(super) fn is_pending(&self, entity: Entity) -> bool {
        self.spawned.is_pending(entity, &self.names)
    }

    /// Whether an entity below this one satisfies a condition.
    pub(super) fn any_below(&self, entity: Entity, is: impl Fn(&SubjectItem) -> bool) -> bool {
        let below = self.hierarchy.below(entity);
        below
            .filter_map(|entity| self.subjects.get(entity).ok())
            .any(|it| is(&it))
    }
}
