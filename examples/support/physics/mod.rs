//! Rigid bodies of Rapier on morphing surfaces, in scenes for any engine, and the methods that make a surface collide.

mod rivals;
mod scenes;

use std::path::Path;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;

pub use rivals::Method;
pub use scenes::*;

/// An app with physics in steps of [`DT`], one per frame, ready for its first frame.
pub fn app(assets: &Path) -> App {
    app_with(assets, |_: &mut App| {})
}

/// The same app with another plugin.
pub fn app_with(assets: &Path, plugin: impl Plugin) -> App {
    app_in_unit(assets, 1.0, plugin)
}

/// The same app in a world with another unit of length. Gravity follows.
pub fn app_in_unit(assets: &Path, unit: f32, plugin: impl Plugin) -> App {
    app_with_steps(assets, unit, DT, plugin)
}

/// The same app with steps of another length, one per frame.
fn app_with_steps(assets: &Path, unit: f32, dt: f32, plugin: impl Plugin) -> App {
    let mut app = crate::app::headless(assets);
    app.add_plugins((
        RapierPhysicsPlugin::<NoUserData>::default().with_length_unit(unit),
        MorphRapierPlugin,
    ))
    .insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(dt)))
    .add_plugins(plugin);
    crate::app::ready(&mut app);
    app
}

/// A dynamic body.
pub fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let place = Transform::from_translation(at);
    let body = (RigidBody::Dynamic, collider, place, Velocity::default());
    app.world_mut().spawn(body).id()
}

/// A body's position and velocity.
#[must_use]
pub fn state(app: &App, body: Entity) -> (Vec3, Vec3) {
    let body = app.world().entity(body);
    (
        body.get::<Transform>()
            .map(|place| place.translation)
            .unwrap_or_default(),
        body.get::<Velocity>()
            .map(|velocity| velocity.linear)
            .unwrap_or_default(),
    )
}
