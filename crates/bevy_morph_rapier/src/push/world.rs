//! The parts of Rapier's world that surfaces read and change.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::prelude::*;
use bevy_morph_physics::push::StepParams;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::plugin::context::{
    RapierContextColliders, RapierContextJoints, RapierContextSimulation, RapierRigidBodySet, SimulationToRenderTime,
};
use bevy_rapier3d::rapier::dynamics::{
    ImpulseJointSet, IslandManager, MultibodyJointSet, RigidBodyHandle, RigidBodySet, SoftBodySet,
};
use bevy_rapier3d::rapier::geometry::ColliderSet;

use super::listeners::ContactListeners;
use super::movers::Movers;
use super::obstacles::Obstacles;

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

/// What surfaces need to know about a step.
pub(crate) struct Step<'a> {
    pub(crate) params: StepParams,
    /// The speed at which bodies are driven out of solid surfaces.
    pub(crate) expel_speed: f32,
    pub(crate) movers: &'a Movers,
    /// Other obstacles, for surfaces on moving dynamic bodies.
    pub(crate) obstacles: Option<&'a Obstacles>,
    /// Everything besides movers that needs contacts of surfaces.
    pub(crate) listeners: &'a ContactListeners,
    /// Whether Rapier does a single step, perhaps with substeps.
    pub(crate) once: bool,
    /// The body on which the surface is.
    pub(crate) body: Option<RigidBodyHandle>,
    /// Set while a step is in progress.
    pub(crate) stepping: &'a Arc<AtomicBool>,
}
