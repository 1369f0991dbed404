//! Looking into a running game.
//!
//! - `gizmos`: draws boxes, contacts and touching triangles. `diagnostics_store`: publishes counts in Bevy's `DiagnosticsStore`.
//! - `panel`: shows them in a panel with Bevy's UI. `panel_rows`: what it says.

#[cfg(feature = "diagnostics")]
mod diagnostics_store;
#[cfg(feature = "gizmos")]
mod gizmos;
#[cfg(feature = "diagnostic_ui")]
mod panel;
#[cfg(feature = "diagnostic_ui")]
mod panel_rows;

#[cfg(feature = "diagnostics")]
pub use diagnostics_store::MorphCollisionDiagnosticsPlugin;
#[cfg(feature = "gizmos")]
pub use gizmos::{MorphGizmos, MorphGizmosPlugin};
#[cfg(feature = "diagnostic_ui")]
pub use panel::{MorphDiagnosticsUi, MorphDiagnosticsUiPlugin, MorphDiagnosticsUiSettings};
