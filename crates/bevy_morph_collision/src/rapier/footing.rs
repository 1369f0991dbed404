//! Provides ground to Rapier's character controllers while they run.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use bevy_rapier3d::control::{ControllerIgnored, KinematicCharacterController};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::prelude::RapierColliderHandle;
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, ColliderBuilder, ColliderHandle};

use super::attach::RapierSurface;
use super::character::{Character, GROUND_PREDICTION, Placed, Sight, height, length};
use super::ground::Ground;
use crate::physics::range::box_in_range;

/// A surface that controllers may touch.
struct Seen {
    entity: Entity,
    context: Entity,
    collider: ColliderHandle,
    /// In world space, in the pose of the last step.
    bounds: Aabb,
}

/// What exists while controllers run.
#[derive(Resource, Default)]
pub(super) struct Footing {
    surfaces: Vec<Seen>,
    /// With their contexts.
    grounds: Vec<(Entity, ColliderHandle)>,
    /// The controllers that run.
    pub(super) runs: EntityHashSet,
    /// Pairs of a controller and a surface that was hidden from it.
    hidden: Vec<(Entity, Entity)>,
}

impl Footing {
    /// Whether there is any surface near a box.
    pub(super) fn is_near(&self, context: Entity, bounds: &Aabb) -> bool {
        let mut surfaces = self.surfaces.iter();
        surfaces.any(|surface| surface.context == context && surface.bounds.intersects(bounds))
    }
}

/// Adds the triangles near each controller, in the pose of the last step, as ground that Rapier's own casts can hit.
///
/// They are colliders without a body, even if the surface has one: Rapier would drag a controller along with a kinematic body
/// that it brushes.
pub(super) fn before_controllers(
    mut contexts: Query<(
        &mut RapierContextSimulation,
        &mut RapierContextColliders,
        &RapierRigidBodySet,
        &RapierConfiguration,
    )>,
    mut controllers: Query<(Entity, &mut KinematicCharacterController, Placed)>,
    surfaces: Query<(Entity, &RapierSurface, &RapierColliderHandle, &RapierContextEntityLink)>,
    ignored: Query<Entity, With<ControllerIgnored>>,
    mut footing: ResMut<Footing>,
) {
    let footing = &mut *footing;
    footing.runs.clear();
    footing.surfaces.clear();
    if surfaces.is_empty() || controllers.is_empty() {
        return;
    }
    for (entity, surface, handle, link) in &surfaces {
        let Ok((_, colliders, ..)) = contexts.get(link.0) else {
            continue;
        };
        let collider = colliders.colliders.get(handle.0);
        if let Some(collider) = collider.filter(|collider| collider.is_enabled()) {
            let bounds = surface.following.surface.lock().bounds();
            footing.surfaces.push(Seen {
                entity,
                context: link.0,
                collider: handle.0,
                bounds: bounds.transform_by(collider.position()),
            });
        }
    }
    let ignored: EntityHashSet = ignored.iter().collect();
    for (entity, mut controller, placed) in &mut controllers {
        let Some(translation) = controller.translation else {
            continue;
        };
        let context = placed.link.0;
        let Ok((mut simulation, mut colliders, bodies, configuration)) = contexts.get_mut(context) else {
            continue;
        };
        let subdivision = configuration.scaled_shape_subdivision;
        let Some(character) = Character::of(&controller, &placed, &colliders, bodies, subdivision) else {
            continue;
        };
        footing.runs.insert(entity);
        // The farthest that the controller can move, whatever it slides along, plus its search for ground from there.
        let height = height(&character.shape, controller.up);
        let mut reach = translation.length() + length(controller.offset, height) + GROUND_PREDICTION;
        reach += controller.snap_to_ground.map_or(0.0, |snap| length(snap, height));
        reach += controller.autostep.map_or(0.0, |step| length(step.max_height, height));
        let region = character.shape.compute_aabb(&character.place).loosened(reach);
        if !box_in_range(&region) {
            continue;
        }
        let sight = Sight::of(&controller, &character, &ignored, bodies);
        let mut unseen = Vec::new();
        for seen in &footing.surfaces {
            if seen.context != context || !seen.bounds.intersects(&region) {
                continue;
            }
            let collider = colliders.colliders.get(seen.collider);
            let Some((collider, (_, surface, ..))) = collider.zip(surfaces.get(seen.entity).ok()) else {
                continue;
            };
            let place = *collider.position();
            let region = region.transform_by(&place.inverse());
            let triangles = surface.following.surface.lock().triangles_in(&region, true);
            if triangles.is_empty() {
                continue;
            }
            if !sight.sees(seen.collider, &colliders.colliders, &bodies.bodies) {
                // Other controllers may see the surface, and its ground does not have the body that this controller ignores.
                unseen.push(seen.entity);
                continue;
            }
            let ground = ColliderBuilder::new(SharedShape::new(Ground(triangles)))
                .position(place)
                .density(0.0)
                .active_collision_types(ActiveCollisionTypes::empty())
                .collision_groups(collider.collision_groups())
                .sensor(collider.is_sensor())
                .user_data(collider.user_data)
                .build();
            let bounds = ground.compute_aabb();
            let ground = colliders.colliders.insert(ground);
            let parameters = simulation.integration_parameters;
            simulation.broad_phase.set_aabb(&parameters, ground, bounds);
            footing.grounds.push((context, ground));
        }
        let controller = controller.bypass_change_detection();
        for surface in unseen {
            if controller.exclude_colliders.insert(surface) {
                footing.hidden.push((entity, surface));
            }
        }
    }
}

/// Removes all of it again.
pub(super) fn after_controllers(
    mut contexts: Query<(
        &mut RapierContextSimulation,
        &mut RapierContextColliders,
        &mut RapierRigidBodySet,
    )>,
    mut controllers: Query<&mut KinematicCharacterController>,
    mut footing: ResMut<Footing>,
) {
    for (context, ground) in footing.grounds.drain(..) {
        let Ok((mut simulation, mut colliders, mut bodies)) = contexts.get_mut(context) else {
            continue;
        };
        let bodies = &mut *bodies;
        let (islands, soft_bodies) = (&mut simulation.islands, &mut bodies.soft_bodies);
        colliders
            .colliders
            .remove(ground, islands, &mut bodies.bodies, soft_bodies, false);
    }
    for (controller, surface) in footing.hidden.drain(..) {
        if let Ok(mut controller) = controllers.get_mut(controller) {
            controller.bypass_change_detection().exclude_colliders.remove(&surface);
        }
    }
}
