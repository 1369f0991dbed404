//! The plugins of Bevy that this crate's plugins need, and what is logged without them.

use bevy::asset::AssetEvent;
use bevy::prelude::*;
use bevy::transform::TransformPlugin;
use tracing::{error, warn};

use crate::components::{MorphCollider, MorphColliderScene};
use crate::contacts::MorphCollisions;

/// Checks that an app has meshes. Without them, nothing collides, and the app runs on.
pub(crate) fn check_meshes(app: &mut App) {
    let world = app.world();
    let missing = if !world.contains_resource::<AssetServer>() {
        "`AssetPlugin`, and `MeshPlugin` after it"
    } else if !world.contains_resource::<Assets<Mesh>>() {
        "`MeshPlugin`"
    } else {
        return;
    };
    error!("nothing collides, because the app lacks {missing}. `DefaultPlugins` contains all that is needed");
    // Systems stop the app if they do not find these.
    app.init_resource::<Assets<Mesh>>().add_message::<AssetEvent<Mesh>>();
}

/// Checks that something updates global transforms.
pub(crate) fn check_transforms(app: &App) {
    if !app.is_plugin_added::<TransformPlugin>() {
        warn!(
            "`TransformPlugin` is missing. Without it, every `GlobalTransform` stays as it is and everything collides at the origin: add it \
             (`DefaultPlugins` contains it), unless another plugin updates global transforms"
        );
    }
}

/// Where only some of the crate's plugins are in the app: says that colliders need another one.
pub(crate) fn check_collisions(app: &mut App) {
    if app.world().contains_resource::<MorphCollisions>() {
        return;
    }
    let warn_once = |_: On<Add<(MorphCollider, MorphColliderScene)>>, mut is_told: Local<bool>| {
        if !std::mem::replace(&mut *is_told, true) {
            error!(
                "`MorphCollider` and `MorphColliderScene` have no effect: add `MorphPlugins` or `MorphCollisionPlugin` to the app"
            );
        }
    };
    app.add_observer(warn_once);
}
