//! The systems around Rapier's step.

mod collision_events;
mod context_step;
mod frames;
mod hierarchies;
mod input;
mod predict;
mod stages;
mod stepping;
mod systems;

pub(crate) use frames::record_frame;
pub(crate) use hierarchies::mark_moved_hierarchies;
pub(crate) use stepping::Stepping;
pub(crate) use systems::{after_step, before_step, note_step, set_dispatcher};
