//! Carries character controllers along with the surface on which they stand.

use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_physics::{MorphCharacterGround, MorphPhysicsCollider};
use bevy_rapier3d::control::{ControllerIgnored, KinematicCharacterController, KinematicCharacterControllerOutput};
use bevy_rapier3d::parry::bounding_volume::BoundingVolume;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextSimulation, RapierRigidBodySet, SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use morph_collision::ShapeQuery;

use super::carried::{CarriedController, Support};
use super::character::{Character, CharacterFilter, ControllerComponents, height, length};
use super::footing::Footing;
use crate::surface::RapierSurface;
use crate::timestep::time_ahead;

/// How surfaces with a [`MorphPhysicsCollider`] carry a `KinematicCharacterController`.
///
/// Every controller has this component, with its defaults. A controller is carried while it stands on a surface. The surface must
/// be the first thing below its feet that is not steeper than its `max_slope_climb_angle`, within the distance at which Rapier calls
/// it grounded. Surfaces that it merely touches do not move it. Walls stop it while it is carried. It is never
/// rotated, like all controllers.
///
/// The controller's own output does not include the motion of the ground; [`MorphCharacterGround`] reports it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCharacterGround)]
pub struct MorphCharacterCarry {
    /// Whether surfaces carry the controller. If not, the surface slides away below its feet, but still lifts it.
    pub enabled: bool,
    /// Whether the controller keeps the velocity of the surface when it leaves the ground, until it lands. A jump off a moving
    /// surface then goes along with the surface. Obstacles stop it. Has no effect unless `enabled` is set.
    pub keep_velocity: bool,
}

impl Default for MorphCharacterCarry {
    fn default() -> Self {
        Self {
            enabled: true,
            keep_velocity: false,
        }
    }
}

/// A character controller.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Controller {
    entity: Entity,
    settings: &'static KinematicCharacterController,
    carry: &'static MorphCharacterCarry,
    ground: &'static mut MorphCharacterGround,
    output: Option<&'static KinematicCharacterControllerOutput>,
    components: ControllerComponents,
}

/// Surfaces on which controllers stand.
#[derive(SystemParam)]
pub(crate) struct Grounds<'w, 's> {
    surfaces: Query<'w, 's, &'static mut RapierSurface, With<MorphPhysicsCollider>>,
    query: Local<'s, ShapeQuery>,
}

impl Grounds<'_, '_> {
    /// Moves a controller along with what supports it. Returns what it stands on.
    fn carry(
        &mut self,
        carried: &mut CarriedController,
        support: &Support,
        enabled: bool,
        dt: f32,
    ) -> MorphCharacterGround {
        let mut ground = MorphCharacterGround::default();
        let surface = carried.colliders.collider_entity(support.collider);
        let surface = surface.and_then(|surface| Some((surface, self.surfaces.get_mut(surface).ok()?)));
        let Some((surface, mut state)) = surface else {
            return ground;
        };
        let moving = &mut state.moving;
        let point = moving.closest(support.hit.witness1, &mut self.query);
        let velocity = point.and_then(|point| moving.velocity_at(point));
        ground.surface = Some(surface);
        // Rapier moves dynamic bodies and does not carry controllers along with them.
        let velocity = velocity.filter(|_| !carried.is_on_dynamic(support.collider));
        ground.velocity = velocity.unwrap_or_default().as_vec3();
        let normal = support.hit.normal1;
        let rise = ground.velocity.dot(normal) / carried.up.dot(normal);
        let carry = match enabled {
            true => ground.velocity,
            false => rise.max(0.0) * carried.up,
        };
        let lift = carried.lift(support.collider);
        carried.slide(carry * dt + lift, &[support.collider]);
        ground
    }
}

/// Moves controllers along with their ground, after they have moved by themselves.
pub(crate) fn carry(
    contexts: Query<(
        &RapierContextSimulation,
        &RapierContextColliders,
        &RapierRigidBodySet,
        &RapierConfiguration,
        &SimulationToRenderTime,
    )>,
    mut controllers: Query<Controller>,
    mut grounds: Grounds,
    mut transforms: Query<&mut Transform>,
    ignored: Query<Entity, With<ControllerIgnored>>,
    footing: Res<Footing>,
    mode: Res<TimestepMode>,
    time: Res<Time>,
) {
    let ignored: EntityHashSet = ignored.iter().collect();
    for mut it in &mut controllers {
        let (controller, components) = (it.settings, &it.components);
        let Ok((simulation, colliders, bodies, configuration, behind)) = contexts.get(components.link.0) else {
            continue;
        };
        let is_active = configuration.physics_pipeline_active;
        let dt = if is_active {
            time_ahead(&mode, &time, behind.diff).0
        } else {
            0.0
        };
        let subdivision = configuration.scaled_shape_subdivision;
        let Some(character) = Character::of(controller, components, colliders, bodies, subdivision) else {
            continue;
        };
        let Some(up) = controller.up.try_normalize() else {
            continue;
        };
        let output = it.output.filter(|_| footing.runs.contains(&it.entity));
        let height = height(&character.shape, up);
        let mut carried = CarriedController {
            simulation,
            colliders,
            bodies,
            filter: CharacterFilter::of(controller, &character, &ignored, bodies),
            shape: &character.shape,
            isometry: character.isometry,
            up,
            height,
            offset: length(controller.offset, height),
            steepest: controller.max_slope_climb_angle.cos().max(1e-3),
        };
        carried.isometry.translation += output.map_or(Vec3::ZERO, |output| output.effective_translation);
        let from = carried.isometry.translation;

        // A controller that did not run this time is still where it was.
        let grounded = output.is_none_or(|output| output.grounded);
        let reach = carried.reach();
        let near = carried.shape.compute_aabb(&carried.isometry).loosened(reach);
        let near = grounded && footing.is_near(components.link.0, &near);
        let support = if near { carried.support(reach) } else { None };
        let mut new = MorphCharacterGround::default();
        let MorphCharacterCarry { enabled, keep_velocity } = *it.carry;
        match support {
            Some(support) => new = grounds.carry(&mut carried, &support, enabled, dt),
            None if enabled && keep_velocity && it.ground.velocity != Vec3::ZERO => {
                new.velocity = carried.coast(it.ground.velocity, dt);
            }
            None => {}
        }
        let moved = carried.isometry.translation - from;
        if moved != Vec3::ZERO && moved.is_finite() {
            let body = character.body.and_then(|body| bodies.rigid_body_entity(body));
            if let Ok(mut transform) = transforms.get_mut(body.unwrap_or(it.entity)) {
                // Like Rapier's controller, this assumes that parents are not rotated.
                transform.translation += moved;
            }
        }
        it.ground.set_if_neq(new);
    }
}
