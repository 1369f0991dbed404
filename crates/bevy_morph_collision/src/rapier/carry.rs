//! Carries character controllers along with the surface on which they stand.

use bevy::ecs::entity::EntityHashSet;
use bevy::prelude::*;
use bevy_rapier3d::control::{ControllerIgnored, KinematicCharacterController, KinematicCharacterControllerOutput};
use bevy_rapier3d::parry::bounding_volume::BoundingVolume;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::query::ShapeCastHit;
use bevy_rapier3d::parry::query::details::ShapeCastOptions;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextSimulation, RapierRigidBodySet, SimulationToRenderTime,
};
use bevy_rapier3d::plugin::{RapierConfiguration, TimestepMode};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle};
use morph_collision::ShapeQuery;

use super::MorphRapierCollider;
use super::attach::RapierSurface;
use super::character::{Character, GROUND_PREDICTION, Placed, Sight, height, length};
use super::footing::Footing;
use super::timestep::time_ahead;

/// How surfaces with a [`MorphRapierCollider`] carry a `KinematicCharacterController`.
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

/// The surface with a [`MorphRapierCollider`] on which a character controller stands. Updated after Rapier's controllers have
/// run.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCharacterGround {
    /// The surface's entity. `None` in the air and on any other ground.
    pub surface: Option<Entity>,
    /// The velocity of the surface below the controller's feet during the last step, in world units per second. In the air, the
    /// velocity that it keeps; otherwise zero.
    pub velocity: Vec3,
}

/// Moves controllers along with their ground, after they have moved by themselves.
pub(super) fn carry(
    contexts: Query<(
        &RapierContextSimulation,
        &RapierContextColliders,
        &RapierRigidBodySet,
        &RapierConfiguration,
        &SimulationToRenderTime,
    )>,
    mut controllers: Query<(
        Entity,
        &KinematicCharacterController,
        &MorphCharacterCarry,
        &mut MorphCharacterGround,
        Option<&KinematicCharacterControllerOutput>,
        Placed,
    )>,
    mut surfaces: Query<&mut RapierSurface, With<MorphRapierCollider>>,
    mut transforms: Query<&mut Transform>,
    ignored: Query<Entity, With<ControllerIgnored>>,
    footing: Res<Footing>,
    mode: Res<TimestepMode>,
    time: Res<Time>,
    mut query: Local<ShapeQuery>,
) {
    let ignored: EntityHashSet = ignored.iter().collect();
    for (entity, controller, settings, mut ground, output, placed) in &mut controllers {
        let Ok((simulation, colliders, bodies, configuration, behind)) = contexts.get(placed.link.0) else {
            continue;
        };
        let dt = match configuration.physics_pipeline_active {
            true => time_ahead(&mode, &time, behind.diff).0,
            false => 0.0,
        };
        let subdivision = configuration.scaled_shape_subdivision;
        let Some(character) = Character::of(controller, &placed, colliders, bodies, subdivision) else {
            continue;
        };
        let Some(up) = controller.up.try_normalize() else {
            continue;
        };
        let output = output.filter(|_| footing.runs.contains(&entity));
        let sight = Sight::of(controller, &character, &ignored, bodies);
        let height = height(&character.shape, up);
        let mut walker = Walker {
            simulation,
            colliders,
            bodies,
            sight,
            shape: &character.shape,
            place: character.place,
            up,
            offset: length(controller.offset, height),
            steepest: controller.max_slope_climb_angle.cos().max(1e-3),
        };
        walker.place.translation += output.map_or(Vec3::ZERO, |output| output.effective_translation);
        let from = walker.place.translation;

        // A controller that did not run this time is still where it was.
        let grounded = output.is_none_or(|output| output.grounded);
        let reach = walker.reach();
        let near = walker.shape.compute_aabb(&walker.place).loosened(reach);
        let near = grounded && footing.is_near(placed.link.0, &near);
        let support = if near { walker.support(reach) } else { None };
        let mut new = MorphCharacterGround::default();
        match support {
            Some((handle, hit)) => {
                let surface = colliders.collider_entity(handle);
                let surface = surface.and_then(|surface| Some((surface, surfaces.get_mut(surface).ok()?)));
                if let Some((surface, mut state)) = surface {
                    let following = &mut state.following;
                    let point = following.closest(hit.witness1, &mut query);
                    let velocity = point.and_then(|point| following.velocity_at(point));
                    new.surface = Some(surface);
                    // Rapier moves dynamic bodies and does not carry controllers along with them.
                    let velocity = velocity.filter(|_| !walker.is_on_dynamic(handle));
                    new.velocity = velocity.unwrap_or_default().as_vec3();
                    let rise = new.velocity.dot(hit.normal1) / up.dot(hit.normal1);
                    let carried = match settings.enabled {
                        true => new.velocity,
                        false => rise.max(0.0) * up,
                    };
                    let lift = walker.lift(handle, height);
                    walker.slide(carried * dt + lift, &[handle]);
                }
            }
            None if settings.enabled && settings.keep_velocity && ground.velocity != Vec3::ZERO => {
                new.velocity = walker.slide(ground.velocity * dt, &[]);
                new.velocity = if dt > 0.0 { new.velocity / dt } else { ground.velocity };
            }
            None => {}
        }
        let moved = walker.place.translation - from;
        if moved != Vec3::ZERO && moved.is_finite() {
            let body = character.body.and_then(|body| walker.bodies.rigid_body_entity(body));
            if let Ok(mut transform) = transforms.get_mut(body.unwrap_or(entity)) {
                // Like Rapier's controller, this assumes that parents are not rotated.
                transform.translation += moved;
            }
        }
        ground.set_if_neq(new);
    }
}

/// A controller that something else moves.
struct Walker<'a> {
    simulation: &'a RapierContextSimulation,
    colliders: &'a RapierContextColliders,
    bodies: &'a RapierRigidBodySet,
    sight: Sight<'a>,
    shape: &'a SharedShape,
    place: Place,
    up: Vec3,
    offset: f32,
    /// The cosine of the steepest slope on which it can stand.
    steepest: f32,
}

impl Walker<'_> {
    fn cast(
        &self,
        direction: Vec3,
        distance: f32,
        gap: f32,
        except: &[ColliderHandle],
    ) -> Option<(ColliderHandle, ShapeCastHit)> {
        self.sight.filtered(except, |filter| {
            let pipeline = self.simulation.broad_phase.as_query_pipeline(
                self.simulation.narrow_phase.query_dispatcher(),
                &self.bodies.bodies,
                &self.colliders.colliders,
                filter,
            );
            let options = ShapeCastOptions {
                target_distance: gap,
                stop_at_penetration: false,
                max_time_of_impact: distance,
                compute_impact_geometry_on_penetration: true,
            };
            pipeline.cast_shape(&self.place, direction, &*self.shape.0, options)
        })
    }

    /// How far below the controller it can find ground.
    fn reach(&self) -> f32 {
        // On a slope, the vertical gap is larger than the distance to the slope.
        (self.offset + GROUND_PREDICTION) / self.steepest.max(0.5)
    }

    /// The first thing below the controller on which it can stand.
    fn support(&self, reach: f32) -> Option<(ColliderHandle, ShapeCastHit)> {
        let mut walls = Vec::new();
        while walls.len() < 4 {
            let (handle, hit) = self.cast(-self.up, reach, 0.0, &walls)?;
            if hit.normal1.dot(self.up) >= self.steepest {
                return Some((handle, hit));
            }
            walls.push(handle);
        }
        None
    }

    fn is_on_dynamic(&self, collider: ColliderHandle) -> bool {
        let body = self.colliders.colliders.get(collider).and_then(Collider::parent);
        body.and_then(|body| self.bodies.bodies.get(body))
            .is_some_and(RigidBody::is_dynamic)
    }

    /// How far up the controller has to move to keep its usual distance from the ground. A moving controller does not push itself
    /// out of things that came closer.
    fn lift(&self, ground: ColliderHandle, height: f32) -> Vec3 {
        let collider = &self.colliders.colliders.get(ground);
        let Some(collider) = collider else { return Vec3::ZERO };
        let dispatcher = self.simulation.narrow_phase.query_dispatcher();
        let pos12 = self.place.inverse() * *collider.position();
        let contact = dispatcher.contact(&pos12, &*self.shape.0, collider.shape(), self.offset);
        let Ok(Some(contact)) = contact else { return Vec3::ZERO };
        let missing = self.offset - contact.dist;
        let slope = -(self.place.rotation * contact.normal1).dot(self.up);
        if missing < 1e-2 * self.offset || slope < self.steepest {
            return Vec3::ZERO;
        }
        self.up * (missing / slope).min(0.25 * height)
    }

    /// Moves the controller, sliding along obstacles. Returns the motion minus the components that obstacles stopped.
    fn slide(&mut self, motion: Vec3, except: &[ColliderHandle]) -> Vec3 {
        let (mut left, mut kept) = (motion, motion);
        for _ in 0..4 {
            let Some((direction, distance)) = left.try_normalize().map(|direction| (direction, left.length())) else {
                break;
            };
            let Some((_, hit)) = self.cast(direction, distance, self.offset, except) else {
                self.place.translation += left;
                break;
            };
            let way = direction * hit.time_of_impact;
            self.place.translation += way;
            left -= way;
            for motion in [&mut left, &mut kept] {
                *motion -= hit.normal1 * motion.dot(hit.normal1).min(0.0);
            }
        }
        kept
    }
}
