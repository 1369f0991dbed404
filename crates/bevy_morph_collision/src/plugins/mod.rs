//! The plugins that an app adds.
//!
//! - `collision`: collision detection, and the order of its systems. `group`: all plugins at once.

mod collision;
mod group;
mod schedule;

pub use collision::MorphCollisionPlugin;
pub use group::MorphPlugins;
pub use schedule::MorphCollisionSchedule;
