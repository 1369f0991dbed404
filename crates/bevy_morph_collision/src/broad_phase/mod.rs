//! Places colliders in the world and finds pairs that are close enough to compare.
//!
//! - `candidates`: pairs whose boxes overlap (`sweep`). `visits`: which colliders have to be placed anew. `placing`: one of them.
//! - `hooked_pairs`: what hooks say about pairs.
//! - `swept_pairs`: pairs that may touch on their way from the last run. `teleports`: colliders that were put somewhere else, and have no way.

mod candidates;
mod hooked_pairs;
mod placing;
mod sweep;
mod swept_pairs;
mod teleports;
mod visits;

use bevy::prelude::*;

pub(crate) use candidates::{Candidates, CandidatesMemory, find_candidates};
pub use hooked_pairs::MorphCandidatePair;
pub(crate) use hooked_pairs::{HookAnswer, HookAnswers, HookedPairs};
pub(crate) use swept_pairs::SweptPairs;

/// Adds the candidates, and what hooks say about them.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<Candidates>().init_resource::<HookedPairs>();
}
