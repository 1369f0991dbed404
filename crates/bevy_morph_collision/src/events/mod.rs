//! Reports what started and ended.
//!
//! - `colliders`, `bodies`: messages and entity events of colliders and of bodies.
//! - `frames`: runs in a fixed schedule, as systems of the frame see them.

mod bodies;
mod colliders;
mod frames;

use bevy::prelude::*;

use crate::app::forget_messages;

pub(crate) use bodies::report_body_changes;
pub use bodies::{MorphBodyCollisionEnd, MorphBodyCollisionStart};
pub use colliders::{MorphCollidingEntities, MorphCollisionEnd, MorphCollisionStart};
pub(crate) use colliders::{list_colliding_entities, report_changes};
pub(crate) use frames::{begin_empty_run, show_fixed_runs_to_frames};

/// Forgets messages that nobody has read.
pub(crate) fn forget_unread(world: &mut World) {
    forget_messages::<MorphCollisionStart>(world);
    forget_messages::<MorphCollisionEnd>(world);
    forget_messages::<MorphBodyCollisionStart>(world);
    forget_messages::<MorphBodyCollisionEnd>(world);
}

/// Adds the messages, and registers the types for reflection.
pub(crate) fn add(app: &mut App) {
    app.add_message::<MorphCollisionStart>()
        .add_message::<MorphCollisionEnd>()
        .add_message::<MorphBodyCollisionStart>()
        .add_message::<MorphBodyCollisionEnd>()
        .register_type::<MorphCollisionStart>()
        .register_type::<MorphCollisionEnd>()
        .register_type::<MorphBodyCollisionStart>()
        .register_type::<MorphBodyCollisionEnd>()
        .register_type::<MorphCollidingEntities>();
}
