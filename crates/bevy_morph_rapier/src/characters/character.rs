//! A `KinematicCharacterController` as Rapier's world sees it: its shape, where it is, and what it collides with.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use bevy_rapier3d::control::{CharacterLength, ControllerFilterPredicate, KinematicCharacterController};
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextEntityLink, RapierRigidBodySet};
use bevy_rapier3d::prelude::{RapierColliderHandle, RapierRigidBodyHandle};
use bevy_rapier3d::rapier::dynamics::{RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet, InteractionGroups};
use bevy_rapier3d::rapier::pipeline::{QueryFilter, QueryFilterFlags};

/// The components that determine where a controller is in Rapier's world.
#[derive(QueryData)]
pub(crate) struct ControllerComponents {
    pub(crate) link: &'static RapierContextEntityLink,
    collider: Option<&'static RapierColliderHandle>,
    body: Option<&'static RapierRigidBodyHandle>,
    global: Option<&'static GlobalTransform>,
}

/// A controller's shape, and where it is.
pub(crate) struct Character {
    pub(crate) shape: SharedShape,
    pub(crate) isometry: Isometry,
    pub(crate) body: Option<RigidBodyHandle>,
    collider: Option<ColliderHandle>,
}

impl Character {
    /// Computes the same shape and isometry as Rapier's controller. `None` if it has no shape yet.
    pub(crate) fn of(
        controller: &KinematicCharacterController,
        components: &ControllerComponentsItem,
        colliders: &RapierContextColliders,
        bodies: &RapierRigidBodySet,
        subdivision: u32,
    ) -> Option<Self> {
        let handle = components.collider.map(|handle| handle.0);
        let collider = handle.and_then(|handle| colliders.colliders.get(handle));
        let own_body = components.body.map(|handle| handle.0);
        let (shape, isometry) = if let Some((shape, translation, rotation)) = &controller.custom_shape {
            let mut scaled = shape.clone();
            scaled.set_scale(shape.scale(), subdivision);
            let in_body = Isometry::from_parts(*translation, *rotation);
            let body = own_body.and_then(|body| bodies.bodies.get(body));
            let global = components.global.map(|global| {
                let global = global.compute_transform();
                Isometry::from_parts(global.translation, global.rotation)
            });
            let isometry = body.map(|body| *body.position()).or(global).unwrap_or_default();
            (scaled.raw, isometry * in_body)
        } else {
            let collider = collider?;
            (collider.shared_shape().clone(), *collider.position())
        };
        Some(Self {
            shape,
            isometry,
            body: own_body.or_else(|| collider?.parent()),
            collider: handle,
        })
    }
}

/// The height of a shape, as seen by a controller.
pub(crate) fn height(shape: &SharedShape, up: Vec3) -> f32 {
    shape.compute_local_aabb().extents().dot(up.abs())
}

/// Converts a controller's length for a shape of this height.
pub(crate) fn length(length: CharacterLength, height: f32) -> f32 {
    match length {
        CharacterLength::Relative(part) => part * height,
        CharacterLength::Absolute(length) => length,
    }
}

/// Rapier calls a controller grounded up to this distance, in addition to its offset.
pub(crate) const GROUND_PREDICTION: f32 = 0.05;

/// Decides what a controller collides with: what its filters admit, but not itself.
pub(crate) struct CharacterFilter<'a> {
    flags: QueryFilterFlags,
    groups: Option<InteractionGroups>,
    own_body: Option<RigidBodyHandle>,
    own_collider: Option<ColliderHandle>,
    excluded: &'a EntityHashSet,
    ignored: &'a EntityHashSet,
    excluded_bodies: Vec<RigidBodyHandle>,
    predicate: Option<&'a ControllerFilterPredicate>,
}

impl<'a> CharacterFilter<'a> {
    pub(crate) fn of(
        controller: &'a KinematicCharacterController,
        character: &Character,
        ignored: &'a EntityHashSet,
        bodies: &RapierRigidBodySet,
    ) -> Self {
        let excluded = controller.exclude_rigid_bodies.iter().chain(ignored);
        Self {
            flags: controller.filter_flags,
            groups: controller.filter_groups.map(Into::into),
            own_body: character.body,
            own_collider: character.collider,
            excluded: &controller.exclude_colliders,
            ignored,
            excluded_bodies: excluded
                .filter_map(|entity| bodies.entity2body().get(entity).copied())
                .collect(),
            predicate: controller.filter_predicate.as_ref(),
        }
    }

    /// Whether the controller collides with a collider.
    pub(crate) fn includes(&self, handle: ColliderHandle, colliders: &ColliderSet, bodies: &RigidBodySet) -> bool {
        let predicate = |handle, collider: &Collider| self.accepts(handle, collider);
        let filter = QueryFilter {
            flags: self.flags,
            groups: self.groups,
            predicate: Some(&predicate),
            ..QueryFilter::default()
        };
        colliders
            .get(handle)
            .is_some_and(|collider| filter.test(bodies, handle, collider))
    }

    /// Runs a Rapier query on everything that the controller collides with, except some colliders.
    pub(crate) fn filtered<T>(&self, except: &[ColliderHandle], query: impl FnOnce(QueryFilter) -> T) -> T {
        let predicate = |handle, collider: &Collider| !except.contains(&handle) && self.accepts(handle, collider);
        query(QueryFilter {
            flags: self.flags,
            groups: self.groups,
            predicate: Some(&predicate),
            ..QueryFilter::default()
        })
    }

    fn accepts(&self, handle: ColliderHandle, collider: &Collider) -> bool {
        let body = collider.parent();
        let is_own = match self.own_body {
            Some(own) => body == Some(own),
            None => self.own_collider == Some(handle),
        };
        let entity = RapierContextColliders::entity_from_collider(collider);
        !is_own
            && !self.excluded.contains(&entity)
            && !self.ignored.contains(&entity)
            && body.is_none_or(|body| !self.excluded_bodies.contains(&body))
            && self.predicate.is_none_or(|predicate| predicate.test(entity, collider))
    }
}
