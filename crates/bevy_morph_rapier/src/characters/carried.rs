//! A controller that is carried: what supports it, and what stops it.

use bevy::prelude::*;
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::parry::query::ShapeCastHit;
use bevy_rapier3d::parry::query::details::ShapeCastOptions;
use bevy_rapier3d::parry::shape::SharedShape;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle};

use super::character::{CharacterFilter, GROUND_PREDICTION};

/// What a controller stands on.
pub(super) struct Support {
    pub(super) collider: ColliderHandle,
    pub(super) hit: ShapeCastHit,
}

/// A controller that something else moves.
pub(super) struct CarriedController<'a> {
    pub(super) simulation: &'a RapierContextSimulation,
    pub(super) colliders: &'a RapierContextColliders,
    pub(super) bodies: &'a RapierRigidBodySet,
    pub(super) filter: CharacterFilter<'a>,
    pub(super) shape: &'a SharedShape,
    pub(super) isometry: Isometry,
    pub(super) up: Vec3,
    pub(super) height: f32,
    pub(super) offset: f32,
    /// The cosine of the steepest slope on which it can stand.
    pub(super) steepest: f32,
}

impl CarriedController<'_> {
    fn cast(
        &self,
        direction: Vec3,
        distance: f32,
        gap: f32,
        except: &[ColliderHandle],
    ) -> Option<(ColliderHandle, ShapeCastHit)> {
        self.filter.filtered(except, |filter| {
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
            pipeline.cast_shape(&self.isometry, direction, &*self.shape.0, options)
        })
    }

    /// How far below the controller it can find ground.
    pub(super) fn reach(&self) -> f32 {
        // On a slope, the vertical gap is larger than the distance to the slope.
        (self.offset + GROUND_PREDICTION) / self.steepest.max(0.5)
    }

    /// The first thing below the controller on which it can stand.
    pub(super) fn support(&self, reach: f32) -> Option<Support> {
        let mut walls = Vec::new();
        while walls.len() < 4 {
            let (handle, hit) = self.cast(-self.up, reach, 0.0, &walls)?;
            if hit.normal1.dot(self.up) >= self.steepest {
                return Some(Support { collider: handle, hit });
            }
            walls.push(handle);
        }
        None
    }

    pub(super) fn is_on_dynamic(&self, collider: ColliderHandle) -> bool {
        let body = self.colliders.colliders.get(collider).and_then(Collider::parent);
        body.and_then(|body| self.bodies.bodies.get(body))
            .is_some_and(RigidBody::is_dynamic)
    }

    /// How far up the controller has to move to keep its usual distance from the ground. A moving controller does not push itself
    /// out of things that came closer.
    pub(super) fn lift(&self, ground: ColliderHandle) -> Vec3 {
        let collider = &self.colliders.colliders.get(ground);
        let Some(collider) = collider else { return Vec3::ZERO };
        let dispatcher = self.simulation.narrow_phase.query_dispatcher();
        let pos12 = self.isometry.inverse() * *collider.position();
        let contact = dispatcher.contact(&pos12, &*self.shape.0, collider.shape(), self.offset);
        let Ok(Some(contact)) = contact else { return Vec3::ZERO };
        let missing = self.offset - contact.dist;
        let slope = -(self.isometry.rotation * contact.normal1).dot(self.up);
        if missing < 1e-2 * self.offset || slope < self.steepest {
            return Vec3::ZERO;
        }
        self.up * (missing / slope).min(0.25 * self.height)
    }

    /// Moves the controller at a velocity. Returns the velocity minus the components that obstacles stopped.
    pub(super) fn coast(&mut self, velocity: Vec3, dt: f32) -> Vec3 {
        let kept = self.slide(velocity * dt, &[]);
        if dt > 0.0 { kept / dt } else { velocity }
    }

    /// Moves the controller, sliding along obstacles. Returns the motion minus the components that obstacles stopped.
    pub(super) fn slide(&mut self, motion: Vec3, except: &[ColliderHandle]) -> Vec3 {
        let (mut left, mut kept) = (motion, motion);
        for _ in 0..4 {
            let Some((direction, distance)) = left.try_normalize().map(|direction| (direction, left.length())) else {
                break;
            };
            let Some((_, hit)) = self.cast(direction, distance, self.offset, except) else {
                self.isometry.translation += left;
                break;
            };
            let way = direction * hit.time_of_impact;
            self.isometry.translation += way;
            left -= way;
            for motion in [&mut left, &mut kept] {
                *motion -= hit.normal1 * motion.dot(hit.normal1).min(0.0);
            }
        }
        kept
    }
}
