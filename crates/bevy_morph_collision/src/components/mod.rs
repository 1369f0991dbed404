//! What a game writes: components and settings.
//!
//! - `collider`, `shape`, `convex_hull`: an entity that collides, with its mesh or as a primitive shape. `placed_shape`: where a transform puts that.
//! - `scene`: a scene whose meshes become colliders. `body`: colliders that form one body.
//! - `layers`: what collides with what. `active_hooks`: which colliders ask the app's own rules. `events_enabled`: which colliders get events.
//! - `teleported`: an entity that was put somewhere else.
//! - `settings`: settings for the whole app. `tree_options`: how trees are built. `unit`: the units of settings, for editors.
//!
//! Nothing here knows how the plugin works. Two more components are in the folder of the feature that reads them:
//! [`MorphSelfCollisions`](crate::self_collisions::MorphSelfCollisions) and
//! [`MorphSurfaceAnchor`](crate::surface::MorphSurfaceAnchor).

mod active_hooks;
mod body;
mod collider;
mod convex_hull;
mod events_enabled;
mod layers;
mod placed_shape;
mod scene;
mod settings;
mod shape;
mod teleported;
mod tree_options;
mod unit;

use bevy::prelude::*;

pub use active_hooks::MorphActiveCollisionHooks;
pub use body::{MorphBodyRoot, MorphColliderOf, MorphColliders};
pub(crate) use body::{body_of, give_body};
pub(crate) use collider::LENGTHS;
pub use collider::{MorphCollider, MorphColliderDisabled, MorphCollisionMode};
pub use convex_hull::MorphConvexHull;
pub use events_enabled::MorphCollisionEventsEnabled;
pub use layers::{MorphCollisionLayers, MorphLayerMask};
pub use scene::MorphColliderScene;
pub use settings::MorphCollisionSettings;
pub(crate) use settings::is_running;
pub use shape::MorphShape;
pub use teleported::MorphTeleported;
pub(crate) use teleported::with_descendants;
pub use tree_options::MorphTreeOptions;
pub use unit::MorphUnit;

/// Registers the types for reflection.
pub(crate) fn register(app: &mut App) {
    app.register_type::<MorphCollider>()
        .register_type::<MorphColliderDisabled>()
        .register_type::<MorphCollisionMode>()
        .register_type::<MorphCollisionLayers>()
        .register_type::<MorphActiveCollisionHooks>()
        .register_type::<MorphShape>()
        .register_type::<MorphConvexHull>()
        .register_type::<MorphColliderScene>()
        .register_type::<MorphColliderOf>()
        .register_type::<MorphColliders>()
        .register_type::<MorphBodyRoot>()
        .register_type::<MorphCollisionEventsEnabled>()
        .register_type::<MorphTeleported>()
        .register_type::<MorphCollisionSettings>()
        .register_type::<MorphTreeOptions>()
        .register_type::<MorphUnit>()
        .init_resource::<MorphCollisionSettings>();
}
