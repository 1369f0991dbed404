//! Looking into a running game.
//!
//! - `gizmos`: draws boxes, contacts and touching triangles. `diagnostics_store`: publishes counts in Bevy's `DiagnosticsStore`.

#[cfg(feature = "diagnostics")]
mod diagnostics_store;
#[cfg(feature = "gizmos")]
mod gizmos;

#[cfg(feature = "diagnostics")]
pub use diagnostics_store::MorphCollisionDiagnosticsPlugin;
#[cfg(feature = "gizmos")]
pub use gizmos::{MorphGizmos, MorphGizmosPlugin};
