//! An app with Avian, and morphing meshes in it.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::log::start;
pub(crate) use crate::stage::Method;

/// The length of a step in seconds, and of a frame unless a test sets another one.
pub(crate) const DT: f32 = 1.0 / 60.0;

const STEP: Duration = Duration::from_nanos(16_666_667);

/// An app with one step per frame.
pub(crate) fn app() -> App {
    let mut app = unfinished();
    start(&mut app);
    app
}

/// The same app, to which more plugins can be added.
pub(crate) fn unfinished() -> App {
    let mut app = headless(Path::new("../.."));
    app.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

/// A mesh in physics, at rest.
pub(crate) fn spawn(app: &mut App, mesh: &MorphMesh, more: impl Bundle) -> Entity {
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh));
    let weights = MeshMorphWeights::Value {
        weights: vec![0.0; mesh.targets.len()],
    };
    let collider = MorphPhysicsCollider::default();
    app.world_mut().spawn((Mesh3d(handle), weights, collider, more)).id()
}

pub(crate) fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let body = (RigidBody::Dynamic, collider, Transform::from_translation(at));
    app.world_mut().spawn(body).id()
}

/// A ball.
pub(crate) fn ball(radius: f32) -> Collider {
    Collider::sphere(radius)
}

pub(crate) fn set_weights(app: &mut App, entity: Entity, weights: &[f32]) {
    let weights = MeshMorphWeights::Value {
        weights: weights.to_vec(),
    };
    app.world_mut().entity_mut(entity).insert(weights);
}

pub(crate) fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Position>(entity).expect("a body").0
}

pub(crate) fn velocity(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<LinearVelocity>(entity).expect("a body").0
}

pub(crate) fn is_asleep(app: &App, entity: Entity) -> bool {
    app.world().entity(entity).contains::<Sleeping>()
}

pub(crate) fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

pub(crate) fn diagnostics(app: &App) -> MorphPhysicsDiagnostics {
    *app.world().resource::<MorphPhysicsDiagnostics>()
}

/// The number of all colliders, and of the parts among them.
pub(crate) fn population(app: &mut App) -> (usize, usize) {
    let world = app.world_mut();
    let colliders = world.query::<&Collider>().iter(world).count();
    let parts = world.query::<&MorphAvianPart>().iter(world).count();
    (colliders, parts)
}

/// Runs a system once that queries Avian.
pub(crate) fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&SpatialQuery) -> T + Send + Sync + 'static) -> T {
    let system = move |query: SpatialQuery| ask(&query);
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// All hits of a ray straight down from a height of 5, with their heights.
pub(crate) fn below(app: &mut App, x: f32, z: f32) -> Vec<(Entity, f32)> {
    let mut hits = ask(app, move |query| {
        query.ray_hits(
            Vec3::new(x, 5.0, z),
            Dir3::NEG_Y,
            100.0,
            100,
            true,
            &SpatialQueryFilter::DEFAULT,
        )
    });
    hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    hits.iter().map(|hit| (hit.entity, 5.0 - hit.distance)).collect()
}

/// Where [`ball_on_sheet`] puts the ball.
pub(crate) const BALL: Vec3 = Vec3::new(0.1, 0.31, 0.05);

/// A sheet with a ball at rest on it.
pub(crate) fn ball_on_sheet() -> (App, Entity, Entity) {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.3), BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{}", place(&app, ball));
    (app, surface, ball)
}

/// A sheet, and a body that has come to rest on it at height 1.
pub(crate) fn on_the_sheet(collider: Collider) -> (App, Entity, Entity) {
    let mut app = app();
    let sheet = spawn(&mut app, &sheet(32), ());
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, 0.51, 0.05));
    run(&mut app, 60);
    let rests = place(&app, body);
    assert!((rests.y - 0.5).abs() < 1e-2, "it rests at {rests}");
    (app, sheet, body)
}

/// Moves a body elsewhere, at rest.
pub(crate) fn put(app: &mut App, body: Entity, at: Vec3) {
    let velocity = (LinearVelocity::ZERO, AngularVelocity::ZERO);
    app.world_mut().entity_mut(body).insert((Position(at), velocity));
}
