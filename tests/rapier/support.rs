//! An app with physics, meshes in it that morph, and what they are in truth.

use std::path::Path;

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::{MorphRapierDiagnostics, prelude::*};
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierRigidBodySet};
use bevy_rapier3d::prelude::*;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::physics::{self, bevy_mesh, state};

pub(crate) fn app() -> App {
    physics::app(Path::new("."))
}

/// A mesh in physics, at rest.
pub(crate) fn spawn(app: &mut App, mesh: &MorphMesh, more: impl Bundle) -> Entity {
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh));
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

pub(crate) fn place(app: &App, entity: Entity) -> Vec3 {
    state(app, entity).0
}

pub(crate) fn velocity(app: &App, entity: Entity) -> Vec3 {
    state(app, entity).1
}

pub(crate) fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

pub(crate) fn diagnostics(app: &App) -> MorphRapierDiagnostics {
    *app.world().resource::<MorphRapierDiagnostics>()
}

/// Bodies and colliders that Rapier has.
pub(crate) fn population(app: &mut App) -> (usize, usize) {
    let mut contexts = app
        .world_mut()
        .query::<(&RapierRigidBodySet, &RapierContextColliders)>();
    let (bodies, colliders) = contexts.single(app.world()).expect("there is one context");
    (bodies.bodies.len(), colliders.colliders.len())
}

/// Runs a system that asks Rapier, once.
pub(crate) fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&RapierContext) -> T + Send + Sync + 'static) -> T {
    let system = move |context: ReadRapierContext| ask(&context.single().expect("there is one context"));
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// A mesh as it stands in the world, as Parry's own shape.
pub(crate) fn truth(mesh: &MorphMesh, weights: &[f32], place: &GlobalTransform) -> TriMesh {
    let posed = posed_vertices(&mesh.positions, &mesh.targets, weights);
    let world = world_vertices(&posed, &place.affine());
    let world = world.into_iter().map(DVec3::as_vec3).collect();
    TriMesh::new(world, mesh.triangles.clone()).expect("a mesh with triangles")
}

pub(crate) fn global(app: &App, entity: Entity) -> GlobalTransform {
    *app.world().entity(entity).get::<GlobalTransform>().unwrap()
}
