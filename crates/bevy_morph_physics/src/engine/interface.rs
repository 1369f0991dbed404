//! What an engine's crate implements.

use std::sync::Arc;

use bevy::ecs::schedule::InternedScheduleLabel;
use bevy::prelude::*;

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
