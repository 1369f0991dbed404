//! The app around the plugin.
//!
//! - `systems`: the system sets. `state_of`: gives the plugin's state to entities. `schedules`: which schedules are fixed.
//! - `messages`: those that nobody has read. `workers`: Bevy's threads. `ticks`: whether columns of components changed.
//! - `missing`, `suspects`: what is logged about missing plugins and likely mistakes. `names`: what messages call entities and assets.

mod messages;
mod missing;
mod names;
mod schedules;
mod state_of;
mod suspects;
mod systems;
mod ticks;
mod workers;

pub(crate) use messages::forget_messages;
pub(crate) use missing::InGroup;
#[cfg(any(feature = "picking", feature = "gizmos", feature = "diagnostic_ui"))]
pub(crate) use missing::missing;
pub(crate) use names::Names;
pub use schedules::is_fixed;
pub(crate) use state_of::require_state;
pub(crate) use suspects::{PATIENCE, Suspects, WarnOnce};
pub use systems::MorphCollisionSystems;
pub(crate) use ticks::{Column, Rows, any_added, any_changed, blocks, has, is_long_ago, ran_long_ago};
pub use workers::TaskPoolWorkers;
