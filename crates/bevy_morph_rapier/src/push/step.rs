//! What surfaces need to know about a step.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy_morph_physics::push::StepParams;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

use super::listeners::ContactListeners;
use super::movers::Movers;
use super::obstacles::Obstacles;

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
