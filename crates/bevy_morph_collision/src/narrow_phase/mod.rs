//! Finds intersecting triangles and contacts.
//!
//! - `find`: queries all pairs of meshes at once. `found`: stores what it finds. `participant`: the colliders. `comparison`: two of them, and what is known about them.
//! - `memories`: starts pairs where they touched in the last run.
//! - `contact_queries`: turns the results into contacts. `builders`: also on several threads.
//! - `motion`: compares continuous pairs that did not touch on their way, from where they were (`starts`).

mod builders;
mod comparison;
mod contact_queries;
mod find;
mod found;
mod memories;
mod motion;
mod participant;
mod starts;

use bevy::prelude::*;

pub(crate) use find::find_contacts;
pub(crate) use found::{FoundContacts, PairHistory, store_contacts};

/// Adds what a run finds.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<FoundContacts>();
}
