//! What connects surfaces to a physics engine.
//!
//! An engine's crate implements [`Engine`], and its plugin calls [`build`] and [`finish`]. In [`Engine::build`] it adds the systems that
//! every engine has ([`add_systems`]) and its own around the engine's step:
//!
//! - Before the step, for each [`PhysicsSurface`]: find the engine's collider and body, predict where they will be, call
//!   [`PhysicsSurface::advance`] and [`PhysicsSurface::set_sides`], give the engine the shape, and call
//!   [`NearbyParts`](crate::push::NearbyParts) for colliders that may move. Parts are bodies that only exist for the step.
//! - After the step: [`Passage::move_back`](crate::push::Passage::move_back).
//! - If no step comes: [`Sources::rest`].
//! - In each frame, if physics runs in a fixed schedule: [`Sources::record`].

mod attach;
mod frames;
mod plugin;
mod schedule;
mod sources;
mod surface;
mod teleport;
mod velocity;

use std::sync::Arc;

use bevy::ecs::schedule::InternedScheduleLabel;
use bevy::prelude::*;

pub use attach::{attach_surfaces, detach_surface};
pub use frames::record_transforms;
pub use plugin::{add_systems, build, finish};
pub use schedule::{runs_fixed, schedules_with};
pub use sources::Sources;
pub use surface::{Exclusion, PhysicsSurface, Sides};
pub use velocity::MorphSurfaceVelocity;

use crate::shape::{MeshLayout, MorphSurface};

/// A physics engine.
pub trait Engine: Sized + Send + Sync + 'static {
    /// What the engine's crate keeps for each surface, such as its parts near bodies.
    type State: Send + Sync + 'static;
    /// The engine's component for colliders.
    type Collider: Component;
    /// What messages call the engine and its plugins.
    const NAMES: EngineNames;

    /// Whether the engine's own plugin is in the app.
    fn is_present(app: &App) -> bool;

    /// The schedules in which it steps.
    fn schedules(app: &App) -> Vec<InternedScheduleLabel>;

    /// Adds the systems of the engine's crate.
    fn build(app: &mut App, schedule: InternedScheduleLabel);

    /// Whether a collider is the surface of a mesh, and not the game's own.
    fn is_surface(collider: &Self::Collider) -> bool;

    /// The state of a new surface.
    fn new_state(entity: Entity, layout: Arc<MeshLayout>) -> Self::State;

    /// Gives an entity with a new surface the components that the engine needs.
    fn attach(entity: &mut EntityCommands, surface: &MorphSurface);

    /// Removes them. A surface of another tree follows if it is `replaced`.
    fn detach(entity: &mut EntityCommands, replaced: bool);
}

/// What messages call an engine and its plugins.
#[derive(Clone, Copy, Debug)]
pub struct EngineNames {
    /// The plugin of the engine's crate.
    pub plugin: &'static str,
    /// The engine's own plugin.
    pub engine_plugin: &'static str,
    /// What to write to add that.
    pub engine_plugin_value: &'static str,
    /// Where the engine steps.
    pub step: &'static str,
}
