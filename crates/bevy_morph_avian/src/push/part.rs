//! Parts of surfaces as kinematic Avian bodies.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use avian3d::prelude::{
    AngularVelocity, Collider, LinearVelocity, Position, RigidBody, Rotation, SleepTimer, Sleeping, WakeBody,
};
use bevy::prelude::*;
use bevy_morph_physics::push::{Bodies, PartMotion};
use bevy_morph_physics::shape::{LookAhead, Patch, Triangles};
use parry3d::shape::{SharedShape, Triangle, TrianglePseudoNormals};

use super::material::ContactMaterial;

/// A part of a [`MorphPhysicsCollider`](crate::MorphPhysicsCollider)'s surface, near a body that may move.
///
/// Parts are kinematic bodies that the plugin spawns, moves and despawns. Events and
/// [`MorphAvianCollisions`](crate::MorphAvianCollisions) name their surface instead, and queries do not see them. You can see them in Avian's `ContactGraph` and `Collisions`, and `CollisionHooks` receive them.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[component(immutable)]
pub struct MorphAvianPart {
    /// The entity of the surface to which the part belongs.
    pub surface: Entity,
}

/// What represents a part in Avian.
#[derive(Default)]
pub(crate) struct PartBody {
    pub(crate) entity: Option<Entity>,
    /// Its triangles, so that moving them does not rebuild a tree.
    triangles: Option<Triangles>,
}

/// Where parts are in the world.
pub(crate) type Parts<'w, 's> = Query<
    'w,
    's,
    (
        &'static mut Position,
        &'static mut Rotation,
        &'static mut LinearVelocity,
        &'static mut AngularVelocity,
        &'static mut Collider,
        (Option<&'static mut SleepTimer>, Has<Sleeping>),
    ),
    With<MorphAvianPart>,
>;

/// The world, and the properties of one surface's parts in it.
pub(crate) struct PartBodies<'a, 'w1, 's1, 'w2, 's2> {
    pub(crate) surface: Entity,
    pub(crate) material: ContactMaterial,
    pub(crate) stepping: &'a Arc<AtomicBool>,
    pub(crate) commands: &'a mut Commands<'w1, 's1>,
    pub(crate) parts: &'a mut Parts<'w2, 's2>,
    /// Colliders that changed, and how far they reach in the step.
    pub(crate) changed: &'a mut Vec<(Entity, f32)>,
}

impl Bodies<PartBody> for PartBodies<'_, '_, '_, '_, '_> {
    fn set(
        &mut self,
        part: &mut PartBody,
        motion: &PartMotion,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    ) {
        let kept = part.triangles.take();
        let triangles = match kept.filter(|kept| !motion.reshaped && kept.len() == triangles.len()) {
            Some(mut kept) => {
                kept.move_to(triangles);
                kept
            }
            None => {
                let (corners, normals) = triangles.unzip();
                Triangles::new(Vec::new(), corners, normals)
            }
        };
        part.triangles = Some(triangles.clone());
        // Avian stores a shape twice, so it cannot be changed in place.
        let collider_now = Collider::from(SharedShape::new(Patch {
            triangles,
            stepping: self.stepping.clone(),
            reach: motion.reach,
            look_ahead: LookAhead::default(),
            velocity: [motion.linear, motion.angular],
        }));
        let existing = part
            .entity
            .and_then(|entity| Some((entity, self.parts.get_mut(entity).ok()?)));
        let entity = if let Some((entity, (mut position, mut rotation, mut linear, mut angular, mut collider, sleep))) =
            existing
        {
            position.0 = motion.origin;
            *rotation = Rotation::IDENTITY;
            linear.0 = motion.linear;
            angular.0 = motion.angular;
            *collider = collider_now;
            // Kinematic bodies fall asleep too, and then have no velocity for others.
            let (timer, asleep) = sleep;
            if asleep {
                self.commands.queue_silenced(WakeBody(entity));
            } else if let Some(mut timer) = timer {
                timer.0 = 0.0;
            }
            entity
        } else {
            let body = (
                MorphAvianPart { surface: self.surface },
                RigidBody::Kinematic,
                collider_now,
                Transform::from_translation(motion.origin),
                Position(motion.origin),
                Rotation::IDENTITY,
                LinearVelocity(motion.linear),
                AngularVelocity(motion.angular),
                self.material.layers,
            );
            let entity = self.commands.spawn(body).id();
            self.material.apply_to(self.commands.entity(entity));
            entity
        };
        part.entity = Some(entity);
        self.changed.push((entity, motion.reach));
    }

    fn remove(&mut self, part: PartBody) {
        remove(part, self.commands);
    }
}

/// Removes a part from the world.
pub(crate) fn remove(part: PartBody, commands: &mut Commands) {
    if let Some(entity) = part.entity {
        commands.entity(entity).try_despawn();
    }
}
