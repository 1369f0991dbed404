//! A game's own rules for pairs of colliders: which are compared, and what becomes of their contacts.
//!
//! - `interface`: the trait that a game implements. `systems`: call it.

mod interface;
mod systems;

pub use interface::{MorphCandidatePair, MorphCollisionHooks};
pub(crate) use systems::{HooksInApp, filter_pairs, modify_contacts};
