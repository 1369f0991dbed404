//! Where a collider's own mesh intersects itself.
//!
//! - `list`: the component that a game adds and reads. `state`: what the plugin keeps for it.
//! - `find`: compares meshes with themselves. `rest`: what intersects at rest is left out. `proofs`: so is what can never touch.
//! - `regions`: groups pairs of triangles, and follows the groups from run to run.
//! - `events`: reports which regions started and ended.

mod events;
mod find;
mod list;
mod proofs;
mod regions;
mod rest;
mod state;

use bevy::prelude::*;

use crate::app::{forget_messages, require_state};

pub(crate) use events::report_self_collisions;
pub use events::{MorphSelfCollisionEnd, MorphSelfCollisionStart};
pub(crate) use find::find_self_collisions;
pub use list::{MorphSelfCollisions, MorphSelfContact};
pub(crate) use state::{SelfMemory, SelfState};

/// Forgets messages that nobody has read.
pub(crate) fn forget_unread(world: &mut World) {
    forget_messages::<MorphSelfCollisionStart>(world);
    forget_messages::<MorphSelfCollisionEnd>(world);
}

/// Adds the messages, and registers the types for reflection.
pub(crate) fn add(app: &mut App) {
    require_state::<MorphSelfCollisions, SelfState>(app);
    app.add_message::<MorphSelfCollisionStart>()
        .add_message::<MorphSelfCollisionEnd>()
        .add_observer(events::end_with_component)
        .register_type::<MorphSelfCollisions>()
        .register_type::<MorphSelfContact>()
        .register_type::<MorphSelfCollisionStart>()
        .register_type::<MorphSelfCollisionEnd>();
}
