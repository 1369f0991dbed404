//! Rollback: what a run of the plugin remembers of earlier runs, to go back to an earlier one.
//!
//! `docs/netcode.md` in the repository lists what is remembered, what is a cache, and what is the game's own.
//!
//! - `state`: [`MorphCollisionState`], which a rollback library saves and loads. `memory`: what is in it.

mod memory;
mod state;

use bevy::prelude::*;

pub use state::MorphCollisionState;

/// Registers the type for reflection.
pub(crate) fn register(app: &mut App) {
    app.register_type::<MorphCollisionState>();
}
