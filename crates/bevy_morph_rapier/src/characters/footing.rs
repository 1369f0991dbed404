//! Provides ground to Rapier's character controllers while they run.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use bevy_morph_physics::shape::{Triangles, box_in_range};
use bevy_rapier3d::control::{ControllerIgnored, KinematicCharacterController};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextEntityLink, RapierContextSimulation, RapierRigidBodySet,
};
use bevy_rapier3d::prelude::RapierColliderHandle;
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, Collider, ColliderBuilder, ColliderHandle};

use super::character::{Character, CharacterFilter, ControllerComponents, GROUND_PREDICTION, height, length};
use crate::queries::Ground;
use crate::surface::RapierSurface;

/// A surface that controllers may touch.
struct NearbySurface {
    entity: Entity,
    context: Entity,
    collider: ColliderHandle,
    /// In world space, in the pose of the last step.
    bounds: Aabb,
}

/// What exists while controllers run.
#[derive(Resource, Default)]
pub(crate) struct Footing {
    surfaces: Vec<NearbySurface>,
    /// With their contexts.
    grounds: Vec<(Entity, ColliderHandle)>,
    /// The controllers that run.
    pub(crate) runs: EntityHashSet,
    /// Pairs of a controller and a surface that was hidden from it.
    hidden: Vec<(Entity, Entity)>,
}

impl Footing {
    /// Whether there is any surface near a box.
    pub(crate) fn is_near(&self, context: Entity, bounds: &Aabb) -> bool {
        let mut surfaces = self.surfaces.iter();
        surfaces.any(|surface| surface.context == context && surface.bounds.intersects(bounds))
    }
}

type Contexts<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut RapierContextSimulation,
        &'static mut RapierContextColliders,
        &'static RapierRigidBodySet,
        &'static RapierConfiguration,
    ),
>;

type Surfaces<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static RapierSurface,
        &'static RapierColliderHandle,
        &'static RapierContextEntityLink,
    ),
>;

/// The surfaces that controllers may touch.
fn find_surfaces(surfaces: &Surfaces, contexts: &Contexts) -> Vec<NearbySurface> {
    let found = surfaces.iter().filter_map(|(entity, surface, handle, link)| {
        let (_, colliders, ..) = contexts.get(link.0).ok()?;
        let collider = colliders.colliders.get(handle.0)?;
        let bounds = || surface.moving.surface.lock().bounds();
        collider.is_enabled().then(|| NearbySurface {
            entity,
            context: link.0,
            collider: handle.0,
            bounds: bounds().transform_by(collider.position()),
        })
    });
    found.collect()
}

/// Adds the triangles near each controller, in the pose of the last step, as ground that Rapier's own casts can hit.
///
/// They are colliders without a body, even if the surface has one: Rapier would drag a controller along with a kinematic body
/// that it brushes.
pub(crate) fn before_controllers(
    mut contexts: Contexts,
    mut controllers: Query<(Entity, &mut KinematicCharacterController, ControllerComponents)>,
    surfaces: Surfaces,
    ignored: Query<Entity, With<ControllerIgnored>>,
    mut footing: ResMut<Footing>,
) {
    let footing = &mut *footing;
    footing.runs.clear();
    footing.surfaces.clear();
    if surfaces.is_empty() || controllers.is_empty() {
        return;
    }
    footing.surfaces.extend(find_surfaces(&surfaces, &contexts));
    let ignored: EntityHashSet = ignored.iter().collect();
    for (entity, mut controller, components) in &mut controllers {
        let Some(translation) = controller.translation else {
            continue;
        };
        let context = components.link.0;
        let Ok((mut simulation, mut colliders, bodies, configuration)) = contexts.get_mut(context) else {
            continue;
        };
        let subdivision = configuration.scaled_shape_subdivision;
        let Some(character) = Character::of(&controller, &components, &colliders, bodies, subdivision) else {
            continue;
        };
        footing.runs.insert(entity);
        let region =
            character
                .shape
                .compute_aabb(&character.isometry)
                .loosened(reach(&controller, translation, &character));
        if !box_in_range(&region) {
            continue;
        }
        let filter = CharacterFilter::of(&controller, &character, &ignored, bodies);
        let mut hidden = Vec::new();
        for nearby in &footing.surfaces {
            if nearby.context != context || !nearby.bounds.intersects(&region) {
                continue;
            }
            let collider = colliders.colliders.get(nearby.collider);
            let Some((collider, (_, surface, ..))) = collider.zip(surfaces.get(nearby.entity).ok()) else {
                continue;
            };
            let region = region.transform_by(&collider.position().inverse());
            let triangles = surface.moving.surface.lock().triangles_in(&region, true);
            if triangles.is_empty() {
                continue;
            }
            if !filter.includes(nearby.collider, &colliders.colliders, &bodies.bodies) {
                // Other controllers may see the surface, and its ground does not have the body that this controller ignores.
                hidden.push(nearby.entity);
                continue;
            }
            let ground = ground(collider, triangles);
            let (bounds, parameters) = (ground.compute_aabb(), simulation.integration_parameters);
            let ground = colliders.colliders.insert(ground);
            simulation.broad_phase.set_aabb(&parameters, ground, bounds);
            footing.grounds.push((context, ground));
        }
        let controller = controller.bypass_change_detection();
        for surface in hidden {
            if controller.exclude_colliders.insert(surface) {
                footing.hidden.push((entity, surface));
            }
        }
    }
}

/// The farthest that a controller can move, whatever it slides along, plus its search for ground from there.
fn reach(controller: &KinematicCharacterController, translation: Vec3, character: &Character) -> f32 {
    let height = height(&character.shape, controller.up);
    let snap = controller.snap_to_ground.map_or(0.0, |snap| length(snap, height));
    let step = controller.autostep.map_or(0.0, |step| length(step.max_height, height));
    translation.length() + length(controller.offset, height) + GROUND_PREDICTION + snap + step
}

/// Triangles of a surface as ground.
fn ground(surface: &Collider, triangles: Triangles) -> Collider {
    ColliderBuilder::new(SharedShape::new(Ground(triangles)))
        .position(*surface.position())
        .density(0.0)
        .active_collision_types(ActiveCollisionTypes::empty())
        .collision_groups(surface.collision_groups())
        .sensor(surface.is_sensor())
        .user_data(surface.user_data)
        .build()
}

/// Removes all of it again.
pub(crate) fn after_controllers(
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
