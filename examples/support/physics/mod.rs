//! Rigid bodies on morphing surfaces: scenes shared by examples and tests, and the methods that make a surface collide.

pub mod behaviour;
pub mod bullets;
pub mod drops;
pub mod engine;
pub mod player;
mod rivals;

use std::f32::consts::TAU;
use std::path::Path;
use std::time::Duration;

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::MorphAttributes;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::{MorphTrees, prelude::*};
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_models::mesh::MorphMesh;

pub use rivals::{Method, blend};

/// The length of a step.
pub const DT: f32 = 1.0 / 60.0;

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

/// A level sheet of 8 by 8 around the origin. One target lifts it by 1, another moves it by 1 along `+X`.
#[must_use]
pub fn sheet(cells: u32) -> MorphMesh {
    let mut mesh = rigid::grid(8.0, cells);
    mesh.targets = vec![vec![Vec3::Y; mesh.positions.len()], vec![Vec3::X; mesh.positions.len()]];
    mesh.target_names = vec!["rise".into(), "slide".into()];
    mesh
}

/// A mesh as a Bevy [`Mesh`].
#[must_use]
pub fn bevy_mesh(mesh: &MorphMesh) -> Mesh {
    let indices = mesh.triangles.as_flattened().to_vec();
    let mut bevy = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions.clone())
        .with_inserted_indices(Indices::U32(indices));
    if !mesh.targets.is_empty() {
        let difference = |&d: &Vec3| MorphAttributes::new(d, Vec3::ZERO, Vec3::ZERO);
        bevy.set_morph_targets(mesh.targets.iter().flatten().map(difference).collect());
    }
    bevy
}

/// Runs frames until every tree is built and in physics.
pub fn settle(app: &mut App) {
    app.update();
    while app.world().resource::<MorphTrees>().building() > 0 {
        app.update();
    }
    app.update();
    app.update();
}

/// A dynamic body.
pub fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let place = Transform::from_translation(at);
    let body = (RigidBody::Dynamic, collider, place, Velocity::default());
    app.world_mut().spawn(body).id()
}

/// Weights that oscillate, each at its own rate, at `time` seconds.
#[must_use]
pub fn wobbling(time: f32, targets: usize) -> Vec<f32> {
    let weight = |target: usize| {
        let phase = TAU * (0.25 * time - target as f32 / targets.max(1) as f32);
        phase.sin().max(0.0).powi(4)
    };
    (0..targets).map(weight).collect()
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
