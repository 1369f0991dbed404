//! Carries character controllers with the surface that they stand on.

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
use super::step::time_ahead;

/// How surfaces with a [`MorphRapierCollider`] carry a `KinematicCharacterController`.
///
/// Every controller has this component, with its defaults. It is carried while it stands on a surface: while a surface is the first thing
/// below its feet, within the distance at which Rapier calls it grounded, and not steeper than its `max_slope_climb_angle`. What it merely
/// brushes does not move it. Walls stop what carries it. It is turned by nothing, as controllers never are.
///
/// The controller's own output does not include the motion of the ground. [`MorphCharacterGround`] tells what it is.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCharacterGround)]
pub struct MorphCharacterCarry {
    /// Whether the surface carries it. If not, the surface slides away below its feet; it still lifts it.
    pub enabled: bool,
    /// Whether it keeps the velocity of the surface when it leaves the ground, until it lands: a jump off a moving surface goes where the
    /// surface goes. What it hits meanwhile stops it. Only where it is carried.
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

/// The surface that a character controller stands on, of a [`MorphRapierCollider`]. Written when Rapier's controllers have run.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCharacterGround {
    /// The surface's entity. `None` in the air, and on anything else.
    pub surface: Option<Entity>,
    /// The velocity of the surface below its feet during the last step, in world units per second. In the air, the velocity that it keeps; otherwise zero.
    pub velocity: Vec3,
}

/// Moves controllers as their ground moves, after they have moved by themselves.
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
    mut surfaces: Query<(&MorphRapierCollider, &mut RapierSurface)>,
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

        // One that did not run this time stands where it stood.
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
                if let Some((surface, (rapier_collider, mut state))) = surface {
                    let following = &mut state.following;
                    let point = following.closest(hit.witness1, &mut query);
                    let velocity =
                        point.and_then(|point| following.velocity_at(point, rapier_collider.max_acceleration));
                    new.surface = Some(surface);
                    // Rapier moves a dynamic body, and does not carry controllers with it.
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
                // Like Rapier's controller, which takes parents for unrotated.
                transform.translation += moved;
            }
        }
        ground.set_if_neq(new);
    }
}

/// A controller that is moved by something else than itself.
struct Walker<'a> {
    simulation: &'a RapierContextSimulation,
    colliders: &'a RapierContextColliders,
    bodies: &'a RapierRigidBodySet,
    sight: Sight<'a>,
    shape: &'a SharedShape,
    place: Place,
    up: Vec3,
    offset: f32,
    /// The cosine of the steepest slope that it can stand on.
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

    /// How far below it it can stand on something.
    fn reach(&self) -> f32 {
        // On a slope, the gap below is larger than the one to the slope.
        (self.offset + GROUND_PREDICTION) / self.steepest.max(0.5)
    }

    /// The first thing below it that it can stand on.
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

    /// How far it has to go up to be as far from its ground as it keeps from everything. A controller that moves does not push itself out of what
    /// has come closer.
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

    /// Moves it, along what it meets. Returns what is left of the motion when what it was stopped by is taken out.
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
