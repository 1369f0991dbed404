//! The parts of Rapier's world that surfaces read and change.

use bevy::prelude::*;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet, SimulationToRenderTime,
};
use bevy_rapier3d::rapier::dynamics::{
    ImpulseJointSet, IslandManager, MultibodyJointSet, RigidBodyHandle, RigidBodySet, SoftBodySet,
};
use bevy_rapier3d::rapier::geometry::ColliderSet;

/// The physics worlds.
pub(crate) type Contexts<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut RapierContextSimulation,
        &'static mut RapierContextColliders,
        &'static mut RapierContextJoints,
        &'static mut RapierRigidBodySet,
        &'static RapierConfiguration,
        &'static SimulationToRenderTime,
    ),
>;

pub(crate) fn world<'a>(
    simulation: &'a mut RapierContextSimulation,
    colliders: &'a mut RapierContextColliders,
    joints: &'a mut RapierContextJoints,
    bodies: &'a mut RapierRigidBodySet,
) -> World<'a> {
    World {
        bodies: &mut bodies.bodies,
        colliders: &mut colliders.colliders,
        islands: &mut simulation.islands,
        impulse_joints: &mut joints.impulse_joints,
        multibody_joints: &mut joints.multibody_joints,
        soft_bodies: &mut bodies.soft_bodies,
        length_unit: simulation.integration_parameters.length_unit,
    }
}

/// The sets to which bodies are added and from which they are removed.
pub(crate) struct World<'a> {
    pub(crate) bodies: &'a mut RigidBodySet,
    pub(crate) colliders: &'a mut ColliderSet,
    pub(crate) islands: &'a mut IslandManager,
    pub(crate) impulse_joints: &'a mut ImpulseJointSet,
    pub(crate) multibody_joints: &'a mut MultibodyJointSet,
    pub(crate) soft_bodies: &'a mut SoftBodySet,
    pub(crate) length_unit: f32,
}

impl World<'_> {
    /// Removes a body with its colliders.
    pub(crate) fn remove(&mut self, body: RigidBodyHandle) {
        self.bodies.remove(
            body,
            self.islands,
            self.colliders,
            self.impulse_joints,
            self.multibody_joints,
            self.soft_bodies,
            true,
        );
    }
}
