//! What follows the surface as it is drawn.
//!
//! - `anchors`: keeps entities on a triangle. `picking`: pointers hit meshes as they are drawn.

mod anchors;
#[cfg(feature = "picking")]
mod picking;

use bevy::prelude::*;

pub use anchors::MorphSurfaceAnchor;
pub(crate) use anchors::move_anchors;
#[cfg(feature = "picking")]
pub use picking::{MorphPick, MorphPickingPlugin, MorphPickingSettings};

/// Registers the types for reflection.
pub(crate) fn register(app: &mut App) {
    app.register_type::<MorphSurfaceAnchor>();
}
