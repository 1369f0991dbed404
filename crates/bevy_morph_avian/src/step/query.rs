//! The components of surfaces and their bodies.

use avian3d::dynamics::joints::joint_graph::JointGraph;
use avian3d::dynamics::solver::SolverConfig;
use avian3d::prelude::{
    ActiveCollisionHooks, AngularVelocity, Collider, ColliderDisabled, ColliderOf, ColliderTransform,
    CollidingEntities, CollisionEventsEnabled, CollisionLayers, CollisionMargin, ComputedCenterOfMass, Friction,
    LinearVelocity, NarrowPhaseConfig, PhysicsLengthUnit, Position, Restitution, RigidBody, RigidBodyDisabled,
    Rotation, Sensor, Sleeping,
};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::components::MorphColliderDisabled;
use bevy_morph_physics::MorphPhysicsCollider;
use bevy_morph_physics::time::SurfaceComponents;

use crate::push::{MorphAvianPart, Parts, Sleep};
use crate::surface::AvianSurface;

/// A surface, and Avian's components on its collider.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Surface {
    pub(super) entity: Entity,
    pub(super) settings: &'static MorphPhysicsCollider,
    pub(super) state: &'static mut AvianSurface,
    pub(super) collider: Option<&'static mut Collider>,
    pub(super) drawn_with: SurfaceComponents,
    pub(super) position: Option<&'static Position>,
    pub(super) rotation: Option<&'static Rotation>,
    pub(super) of: Option<&'static ColliderOf>,
    pub(super) in_body: Option<&'static ColliderTransform>,
    pub(super) friction: Option<&'static Friction>,
    pub(super) restitution: Option<&'static Restitution>,
    pub(super) margin: Option<&'static CollisionMargin>,
    pub(super) layers: Option<&'static CollisionLayers>,
    pub(super) hooks: Option<&'static ActiveCollisionHooks>,
    pub(super) is_sensor: Has<Sensor>,
    pub(super) wants_events: Has<CollisionEventsEnabled>,
    pub(super) wants_colliding: Has<CollidingEntities>,
    pub(super) is_morph_disabled: Has<MorphColliderDisabled>,
    pub(super) is_collider_disabled: Has<ColliderDisabled>,
}

/// A body that a surface is on.
#[derive(QueryData)]
pub(crate) struct Body {
    pub(super) entity: Entity,
    pub(super) kind: &'static RigidBody,
    pub(super) position: &'static Position,
    pub(super) rotation: &'static Rotation,
    pub(super) linear: &'static LinearVelocity,
    pub(super) angular: &'static AngularVelocity,
    pub(super) center_of_mass: &'static ComputedCenterOfMass,
    pub(super) friction: Option<&'static Friction>,
    pub(super) margin: Option<&'static CollisionMargin>,
    pub(super) is_disabled: Has<RigidBodyDisabled>,
    pub(super) is_asleep: Has<Sleeping>,
}

/// Bodies that surfaces are on.
pub(crate) type Bodies<'w, 's> = Query<'w, 's, Body, Without<MorphAvianPart>>;

/// What surfaces read and change in Avian's world.
#[derive(SystemParam)]
pub(crate) struct World<'w, 's> {
    pub(super) commands: Commands<'w, 's>,
    pub(super) bodies: Bodies<'w, 's>,
    pub(super) parts: Parts<'w, 's>,
    pub(super) sleep: Sleep<'w, 's>,
    pub(super) joints: Res<'w, JointGraph>,
    pub(super) narrow_phase: Res<'w, NarrowPhaseConfig>,
    pub(super) solver: Res<'w, SolverConfig>,
    pub(super) length_unit: Res<'w, PhysicsLengthUnit>,
}
