//! Gives each collider's pose the weights and joints with which its mesh is drawn.
//!
//! - `previous`: begins a run and keeps the state before it.
//! - `weights`: morph weights. `joints`: joint matrices, from `skeletons`, which computes them once per skeleton and frame for all systems; `skeleton_memory`: what a
//!   rollback has to bring back of them.
//! - `lent_poses`: poses for anchors and culling, which follow the drawn mesh and not the last run.

mod joints;
mod lent_poses;
mod previous;
mod skeleton_memory;
mod skeletons;
mod weights;

use bevy::prelude::*;

pub(crate) use joints::read_joints;
pub(crate) use lent_poses::LentPoses;
pub(crate) use previous::remember_previous;
pub(crate) use skeleton_memory::SkeletonMemory;
pub(crate) use skeletons::{AllSkins, BindPoses, Skeletons};
pub use skeletons::{CurrentSkeletons, Skeleton};
pub(crate) use weights::{SharedWeightChanges, read_weights};
pub use weights::{WeightsProblem, drawn_weights, take_weights};

/// Adds the skeletons. Whichever system asks first computes the same.
pub fn add_skeletons(app: &mut App) {
    app.init_resource::<Skeletons>().allow_ambiguous_resource::<Skeletons>();
}
