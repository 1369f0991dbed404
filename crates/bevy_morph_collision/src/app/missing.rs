//! What is logged if a plugin does nothing because another one is missing.

use bevy::prelude::*;
#[cfg(any(feature = "picking", feature = "gizmos", feature = "diagnostic_ui"))]
use tracing::{debug, error};

/// Marks an app that added the whole group, so no plugin was requested by name.
pub(crate) struct InGroup;

impl Plugin for InGroup {
    fn build(&self, _: &mut App) {}
}

/// Logs that a plugin does nothing because another one is missing. This is an error unless the plugin came with the group. Returns
/// whether it is.
#[cfg(any(feature = "picking", feature = "gizmos", feature = "diagnostic_ui"))]
pub(crate) fn missing(app: &App, message: &str) -> bool {
    let is_error = !app.is_plugin_added::<InGroup>();
    if is_error {
        error!("{message}");
    } else {
        debug!("{message}");
    }
    is_error
}
