//! A `KinematicCharacterController` as Rapier's world sees it: its shape, its place, and what it collides with.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use bevy_rapier3d::control::{CharacterLength, ControllerFilterPredicate, KinematicCharacterController};
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextEntityLink, RapierRigidBodySet};
use bevy_rapier3d::prelude::{RapierColliderHandle, RapierRigidBodyHandle};
use bevy_rapier3d::rapier::dynamics::{RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet, InteractionGroups};
use bevy_rapier3d::rapier::pipeline::{QueryFilter, QueryFilterFlags};

/// The components that determine a controller's place in Rapier's world.
#[derive(QueryData)]
pub(super) struct Placed {
    pub(super) link: &'static RapierContextEntityLink,
    collider: Option<&'static RapierColliderHandle>,
    body: Option<&'static RapierRigidBodyHandle>,
    global: Option<&'static GlobalTransform>,
}

/// A controller's shape and place.
pub(super) struct Character {
    pub(super) shape: SharedShape,
    pub(super) place: Place,
    pub(super) body: Option<RigidBodyHandle>,
    collider: Option<ColliderHandle>,
}

impl Character {
    /// Computes the same shape and place as Rapier's controller. `None` if it has no shape yet.
    pub(super) fn of(
        controller: &KinematicCharacterController,
        placed: &PlacedItem,
        colliders: &RapierContextColliders,
        bodies: &RapierRigidBodySet,
        subdivision: u32,
    ) -> Option<Self> {
        let handle = placed.collider.map(|handle| handle.0);
        let collider = handle.and_then(|handle| colliders.colliders.get(handle));
        let own_body = placed.body.map(|handle| handle.0);
        let (shape, place) = if let Some((shape, translation, rotation)) = &controller.custom_shape {
            let mut scaled = shape.clone();
            scaled.set_scale(shape.scale(), subdivision);
            let in_body = Place::from_parts(*translation, *rotation);
            let body = own_body.and_then(|body| bodies.bodies.get(body));
            let global = placed.global.map(|global| {
                let global = global.compute_transform();
                Place::from_parts(global.translation, global.rotation)
            });
            let place = body.map(|body| *body.position()).or(global).unwrap_or_default();
            (scaled.raw, place * in_body)
        } else {
            let collider = collider?;
            (collider.shared_shape().clone(), *collider.position())
        };
        Some(Self {
            shape,
            place,
            body: own_body.or_else(|| collider?.parent()),
            collider: handle,
        })
    }
}

/// The height of a shape, as seen by a controller.
pub(super) fn height(shape: &SharedShape, up: Vec3) -> f32 {
    shape.compute_local_aabb().extents().dot(up.abs())
}

/// Converts a controller's length for a shape of this height.
pub(super) fn length(length: CharacterLength, height: f32) -> f32 {
    match length {
        CharacterLength::Relative(part) => part * height,
        CharacterLength::Absolute(length) => length,
    }
}

/// Rapier calls a controller grounded up to this distance, in addition to its offset.
pub(super) const GROUND_PREDICTION: f32 = 0.05;

/// Decides what a controller collides with: what its filters admit, but not itself.
pub(super) struct Sight<'a> {
    flags: QueryFilterFlags,
    groups: Option<InteractionGroups>,
    own_body: Option<RigidBodyHandle>,
    own_collider: Option<ColliderHandle>,
    excluded: &'a EntityHashSet,
    ignored: &'a EntityHashSet,
    excluded_bodies: Vec<RigidBodyHandle>,
    predicate: Option<&'a ControllerFilterPredicate>,
}

impl<'a> Sight<'a> {
    pub(super) fn of(
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
    pub(super) fn sees(&self, handle: ColliderHandle, colliders: &ColliderSet, bodies: &RigidBodySet) -> bool {
        let predicate = |handle, collider: &Collider| self.admits(handle, collider);
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
    pub(super) fn filtered<T>(&self, except: &[ColliderHandle], ask: impl FnOnce(QueryFilter) -> T) -> T {
        let predicate = |handle, collider: &Collider| !except.contains(&handle) && self.admits(handle, collider);
        ask(QueryFilter {
            flags: self.flags,
            groups: self.groups,
            predicate: Some(&predicate),
            ..QueryFilter::default()
        })
    }

    fn admits(&self, handle: ColliderHandle, collider: &Collider) -> bool {
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
