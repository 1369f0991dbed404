//! The plugins that an app adds.
//!
//! - `collision`: collision detection, and the order of its systems. `group`: all plugins at once. `hooks`: adds a game's own rules.

mod collision;
mod group;
mod hooks;
mod schedule;

pub use collision::MorphCollisionPlugin;
pub use group::MorphPlugins;
pub use hooks::MorphCollisionHooksPlugin;
pub use schedule::MorphCollisionSchedule;
