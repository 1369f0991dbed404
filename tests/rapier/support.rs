//! An app with physics, a sheet that morphs, and bodies on it.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy_morph_collision::{MorphTrees, prelude::*};
use bevy_rapier3d::prelude::*;
use morph_collision_testkit::{mesh::MorphMesh, models::rigid};
use morph_collision_workspace::app::{headless, ready};

/// The length of a step.
pub(crate) const DT: f32 = 1.0 / 60.0;

/// An app with physics in steps of [`DT`], ready for its first frame.
pub(crate) fn app() -> App {
    let mut app = headless(std::path::Path::new("."));
    app.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphRapierPlugin))
        .insert_resource(TimestepMode::Fixed { dt: DT, substeps: 1 });
    ready(&mut app);
    app
}

/// A level sheet of 8 by 8 around the origin, with a target that lifts it by 1 and one that moves it by 1 along `+X`.
pub(crate) fn sheet() -> MorphMesh {
    let mut mesh = rigid::grid(8.0, 32);
    mesh.targets = vec![vec![Vec3::Y; mesh.positions.len()], vec![Vec3::X; mesh.positions.len()]];
    mesh.target_names = vec!["rise".into(), "slide".into()];
    mesh
}

pub(crate) fn add_mesh(app: &mut App, mesh: &MorphMesh) -> Handle<Mesh> {
    let indices = mesh.triangles.as_flattened().to_vec();
    let difference = |&d: &Vec3| MorphAttributes::new(d, Vec3::ZERO, Vec3::ZERO);
    let targets = mesh.targets.iter().flatten().map(difference).collect();
    let mut bevy = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions.clone())
        .with_inserted_indices(Indices::U32(indices));
    bevy.set_morph_targets(targets);
    app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy)
}

/// A mesh in physics, at rest.
pub(crate) fn spawn(app: &mut App, mesh: &MorphMesh, more: impl Bundle) -> Entity {
    let handle = add_mesh(app, mesh);
    let weights = MeshMorphWeights::Value {
        weights: vec![0.0; mesh.targets.len()],
    };
    let collider = MorphRapierCollider::default();
    app.world_mut().spawn((Mesh3d(handle), weights, collider, more)).id()
}

pub(crate) fn set_weights(app: &mut App, entity: Entity, weights: &[f32]) {
    let weights = MeshMorphWeights::Value {
        weights: weights.to_vec(),
    };
    app.world_mut().entity_mut(entity).insert(weights);
}

/// Runs frames until every tree is there and in physics.
pub(crate) fn settle(app: &mut App) {
    app.update();
    while app.world().resource::<MorphTrees>().building() > 0 {
        app.update();
    }
    app.update();
    app.update();
}

pub(crate) fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let place = Transform::from_translation(at);
    app.world_mut()
        .spawn((RigidBody::Dynamic, collider, place, Velocity::default()))
        .id()
}

pub(crate) fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().entity(entity).get::<Transform>().unwrap().translation
}

pub(crate) fn velocity(app: &App, entity: Entity) -> Vec3 {
    app.world().entity(entity).get::<Velocity>().unwrap().linear
}

pub(crate) fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}
