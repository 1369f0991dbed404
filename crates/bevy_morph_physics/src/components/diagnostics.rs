//! Counts of a step.

use std::time::Duration;

use bevy::prelude::*;

/// Counts of [`MorphPhysicsCollider`](crate::MorphPhysicsCollider)s in the last physics step. In an app with several engines, that is the step of the engine that
/// stepped last.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphPhysicsDiagnostics {
    /// Surfaces in physics, except those that are switched off, too large, or not at a finite position.
    pub surfaces: u32,
    /// Surfaces that moved or morphed.
    pub moving: u32,
    /// Surfaces that looked for triangles near a body, because it was in their box, and was awake or the surface moved. The others only
    /// take their pose.
    pub awake: u32,
    /// Parts of surfaces near bodies. Each part is a body in the physics world.
    pub parts: u32,
    /// Parts whose vertices were blended for the step.
    pub blended: u32,
    /// Fast bodies whose way was compared with the motion of triangles, so that they do not pass through.
    pub compared_bodies: u32,
    /// Fast bodies that were not compared, because others were already compared with 200,000 triangles. They may pass through.
    pub limited_bodies: u32,
    /// Time spent before and after the step.
    pub duration: Duration,
}
