//! The resource that a rollback library saves and loads.

use std::fmt;
use std::sync::Arc;

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

use super::memory::Memory;
use crate::contacts::MorphCollisions;

/// What runs of the plugin remember of earlier runs and what later answers or events depend on, for rollback netcode: a run that is simulated
/// again gives the same events, contacts and answers, bit for bit.
///
/// It is for libraries that copy a resource after each frame and put the copy back when they go back to that frame, such as `bevy_ggrs` and
/// `lightyear`. Register it there as a resource that is cloned and whose entities are mapped, and add two systems: [`save`](Self::save) before
/// the library copies, and [`restore`](Self::restore) after it has put everything back and mapped the entities.
///
/// ```
/// # use bevy::ecs::schedule::ScheduleLabel;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// // Schedules of the library.
/// #[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
/// struct SaveWorld;
/// #[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
/// struct LoadWorld;
///
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin));
/// app.add_plugins(MorphPlugins)
///     .init_resource::<MorphCollisionState>()
///     .add_systems(SaveWorld, MorphCollisionState::save)
///     .add_systems(LoadWorld, MorphCollisionState::restore);
/// # app.finish();
/// # app.update();
/// # let world = app.world_mut();
/// # world.run_schedule(SaveWorld);
/// # let saved = world.resource::<MorphCollisionState>().clone();
/// # world.insert_resource(saved);
/// # world.run_schedule(LoadWorld);
/// ```
///
/// `docs/netcode.md` in the repository says which components and resources the game registers itself, what to do with messages of frames that
/// are simulated again, and what is the same on all peers.
///
/// Cloning costs nothing: copies share what is in it. [`save`](Self::save) copies the contacts, and the weights and places of all colliders. Apps
/// that do not use it pay nothing.
#[derive(Resource, Reflect, Clone, Default)]
#[reflect(opaque)]
#[reflect(Resource, Debug, Default, Clone)]
pub struct MorphCollisionState(Arc<Memory>);

impl MorphCollisionState {
    /// A system that stores the state of the last run in the resource, which it inserts if there is none. Run it after
    /// [`MorphCollisionSystems::Events`](crate::app::MorphCollisionSystems::Events), between two runs.
    ///
    /// Cost: one copy of all contacts, and of the weights and places of all colliders.
    pub fn save(world: &mut World) {
        if let Some(memory) = Memory::of(world) {
            world.insert_resource(Self(Arc::new(memory)));
        }
    }

    /// A system that brings the plugin back to the state in the resource; without the resource, to that before the first run. Run it when
    /// entities, components and this resource are those of the earlier frame, before the game's own systems.
    ///
    /// [`MorphCollisions`], spatial queries, [`MorphCollidingEntities`](crate::events::MorphCollidingEntities) and
    /// [`MorphSelfCollisions`](crate::self_collisions::MorphSelfCollisions) are those of the earlier run at once. Messages of the plugin that
    /// nobody has read are dropped, because they are of frames that have not happened. The next run looks at every collider, whatever Bevy's
    /// change detection says.
    pub fn restore(world: &mut World) {
        if world.contains_resource::<MorphCollisions>() {
            let Self(memory) = world.get_resource::<Self>().cloned().unwrap_or_default();
            memory.restore(world);
        }
    }
}

/// Entities that were spawned again have other IDs.
impl MapEntities for MorphCollisionState {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        Arc::make_mut(&mut self.0).map_entities(mapper);
    }
}

impl fmt::Debug for MorphCollisionState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MorphCollisionState").finish_non_exhaustive()
    }
}
