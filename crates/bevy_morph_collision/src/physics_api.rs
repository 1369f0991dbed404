//! What a crate needs that connects a physics engine, besides what a game uses.
//!
//! Physics steps at other times than collision detection runs. Such a crate therefore reads weights, joints and trees itself, with the
//! same code. Items here change more often than the rest of the API; `bevy_morph_physics` is built on them.

pub use crate::app::is_fixed;
pub use crate::misuse::{check_in_next_frame, note_collider_component};
pub use crate::posing::{CurrentSkeletons, Skeleton, WeightsProblem, add_skeletons, drawn_weights, take_weights};
pub use crate::setup::ScenePart;
