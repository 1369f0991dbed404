//! Parts of surfaces as kinematic Avian bodies.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use avian3d::prelude::{
    ActiveCollisionHooks, AngularVelocity, Collider, CollisionLayers, CollisionMargin, Friction, LinearVelocity,
    Position, Restitution, RigidBody, Rotation, SleepTimer, Sleeping, WakeBody,
};
use bevy::prelude::*;
use parry3d::shape::{SharedShape, Triangle, TrianglePseudoNormals};

use crate::physics::part::{Bodies, Placed};
use crate::physics::triangles::{Ahead, Patch, Triangles};

/// A part of a [`MorphAvianCollider`](crate::MorphAvianCollider)'s surface, near a body that may move.
///
/// Parts are kinematic bodies that the plugin spawns, moves and despawns. Events name their surface instead, and queries do not
/// see them. You can see them in Avian's `ContactGraph` and `Collisions`, and `CollisionHooks` receive them.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[component(immutable)]
pub struct MorphAvianPart {
    /// The entity of the surface to which the part belongs.
    pub surface: Entity,
}

/// What represents a part in Avian.
#[derive(Default)]
pub(super) struct PartBody {
    pub(super) entity: Option<Entity>,
    /// Its triangles, so that moving them does not rebuild a tree.
    triangles: Option<Triangles>,
}

/// Properties that the parts of a surface take from the surface's collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Manners {
    pub(super) friction: Option<Friction>,
    pub(super) restitution: Option<Restitution>,
    pub(super) margin: Option<CollisionMargin>,
    pub(super) layers: CollisionLayers,
    pub(super) hooks: Option<ActiveCollisionHooks>,
}

impl Manners {
    pub(super) fn teach(&self, mut part: EntityCommands) {
        fn set(part: &mut EntityCommands, component: Option<impl Component>) {
            fn remove<C: Component>(part: &mut EntityCommands, _: &Option<C>) {
                part.try_remove::<C>();
            }
            match component {
                Some(component) => {
                    part.try_insert(component);
                }
                none => remove(part, &none),
            }
        }
        set(&mut part, self.friction);
        set(&mut part, self.restitution);
        set(&mut part, self.margin);
        set(&mut part, self.hooks);
        part.try_insert(self.layers);
    }
}

/// The places of parts in the world.
pub(super) type Parts<'w, 's> = Query<
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
pub(super) struct PartBodies<'a, 'w1, 's1, 'w2, 's2> {
    pub(super) surface: Entity,
    pub(super) manners: Manners,
    pub(super) stepping: &'a Arc<AtomicBool>,
    pub(super) commands: &'a mut Commands<'w1, 's1>,
    pub(super) parts: &'a mut Parts<'w2, 's2>,
    /// Colliders that changed, and how far they reach in the step.
    pub(super) changed: &'a mut Vec<(Entity, f32)>,
}

impl Bodies<PartBody> for PartBodies<'_, '_, '_, '_, '_> {
    fn put(
        &mut self,
        part: &mut PartBody,
        placed: &Placed,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    ) {
        let kept = part.triangles.take();
        let triangles = match kept.filter(|kept| !placed.reshaped && kept.len() == triangles.len()) {
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
        let new = Collider::from(SharedShape::new(Patch {
            triangles,
            stepping: self.stepping.clone(),
            reach: placed.reach,
            ahead: Ahead::default(),
            velocity: [placed.linear, placed.angular],
        }));
        let there = part
            .entity
            .and_then(|entity| Some((entity, self.parts.get_mut(entity).ok()?)));
        let entity =
            if let Some((entity, (mut position, mut rotation, mut linear, mut angular, mut collider, sleep))) = there {
                position.0 = placed.origin;
                *rotation = Rotation::IDENTITY;
                linear.0 = placed.linear;
                angular.0 = placed.angular;
                *collider = new;
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
                    new,
                    Transform::from_translation(placed.origin),
                    Position(placed.origin),
                    Rotation::IDENTITY,
                    LinearVelocity(placed.linear),
                    AngularVelocity(placed.angular),
                    self.manners.layers,
                );
                let entity = self.commands.spawn(body).id();
                self.manners.teach(self.commands.entity(entity));
                entity
            };
        part.entity = Some(entity);
        self.changed.push((entity, placed.reach));
    }

    fn remove(&mut self, part: PartBody) {
        remove(part, self.commands);
    }
}

/// Removes a part from the world.
pub(super) fn remove(part: PartBody, commands: &mut Commands) {
    if let Some(entity) = part.entity {
        commands.entity(entity).try_despawn();
    }
}
