//! An app with physics, morphing meshes in it, and their true shapes.

use std::collections::HashMap;
use std::path::Path;

use bevy::ecs::message::MessageCursor;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierRigidBodySet};
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::rigid::box_mesh;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::physics::{self, bevy_mesh, settle, sheet, state};
pub(crate) use morph_collision_workspace::physics::{Method, body};

use crate::log::{Errors, run_here};

pub(crate) fn app() -> App {
    let mut app = physics::app(Path::new("../.."));
    run_here(&mut app);
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

/// A ball.
pub(crate) fn ball(radius: f32) -> Collider {
    Collider::ball(radius)
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

pub(crate) fn diagnostics(app: &App) -> MorphPhysicsDiagnostics {
    *app.world().resource::<MorphPhysicsDiagnostics>()
}

/// The numbers of bodies and colliders in Rapier.
pub(crate) fn population(app: &mut App) -> (usize, usize) {
    let mut contexts = app
        .world_mut()
        .query::<(&RapierRigidBodySet, &RapierContextColliders)>();
    let (bodies, colliders) = contexts.single(app.world()).expect("there is one context");
    (bodies.bodies.len(), colliders.colliders.len())
}

/// Runs a system once that queries Rapier.
pub(crate) fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&RapierContext) -> T + Send + Sync + 'static) -> T {
    let system = move |context: ReadRapierContext| ask(&context.single().expect("there is one context"));
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// A mesh at its place in the world, as Parry's own mesh.
pub(crate) fn truth(mesh: &MorphMesh, weights: &[f32], place: &GlobalTransform) -> TriMesh {
    let posed = posed_vertices(&mesh.positions, &mesh.targets, weights);
    let world = world_vertices(&posed, &place.affine());
    let world = world.into_iter().map(DVec3::as_vec3).collect();
    TriMesh::new(world, mesh.triangles.clone()).expect("a mesh with triangles")
}

pub(crate) fn global(app: &App, entity: Entity) -> GlobalTransform {
    *app.world().entity(entity).get::<GlobalTransform>().unwrap()
}

/// Runs frames and collects the events.
#[derive(Default)]
pub(crate) struct Log {
    cursor: MessageCursor<CollisionEvent>,
    pub(crate) started: Vec<(Entity, Entity)>,
    pub(crate) stopped: Vec<(Entity, Entity)>,
}

impl Log {
    /// A log that skips earlier events.
    pub(crate) fn from_now(app: &App) -> Self {
        let mut log = Self::default();
        log.cursor.clear(app.world().resource());
        log
    }

    pub(crate) fn run(&mut self, app: &mut App, frames: usize, mut each: impl FnMut(&mut App, usize)) {
        for frame in 1..=frames {
            each(app, frame);
            app.update();
            for event in self.cursor.read(app.world().resource()) {
                match *event {
                    CollisionEvent::Started(a, b, _) => self.started.push((a.min(b), a.max(b))),
                    CollisionEvent::Stopped(a, b, _) => self.stopped.push((a.min(b), a.max(b))),
                }
            }
        }
    }
}

pub(crate) fn pair(a: Entity, b: Entity) -> (Entity, Entity) {
    (a.min(b), a.max(b))
}

/// A sheet with a ball at rest on it.
pub(crate) fn ball_on_sheet() -> (App, Entity, Entity) {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2);
    (app, surface, ball)
}

/// Where [`ball_on_sheet`] puts the ball.
pub(crate) const BALL: Vec3 = Vec3::new(0.1, 0.31, 0.05);

/// Moves a body elsewhere, at rest.
pub(crate) fn put(app: &mut App, body: Entity, at: Vec3) {
    app.world_mut()
        .entity_mut(body)
        .insert((Transform::from_translation(at), Velocity::zero()));
}

/// The first hit of a ray straight down from a height of 5: the entity and the height.
pub(crate) fn below(app: &mut App, x: f32, z: f32) -> Option<(Entity, f32)> {
    let hit = ask(app, move |context| {
        context.cast_ray(Vec3::new(x, 5.0, z), -Vec3::Y, 100.0, true, QueryFilter::default())
    });
    hit.map(|(entity, distance)| (entity, 5.0 - distance))
}

/// A closed box around the origin, each side split into many triangles. Its targets: all of it rises by 1, only its upper side
/// rises, its upper side slides by 1 along `+X`, and its upper side moves down by 1.
pub(crate) fn slab(half: Vec3) -> MorphMesh {
    slab_cut(half, 4)
}

/// The same, with each side split into four this many times.
pub(crate) fn slab_cut(half: Vec3, times: usize) -> MorphMesh {
    let mut mesh = box_mesh(half);
    for _ in 0..times {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut finer = Vec::new();
        for &[a, b, c] in &mesh.triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                    mesh.positions
                        .push(mesh.positions[from as usize].midpoint(mesh.positions[to as usize]));
                    mesh.positions.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        mesh.triangles = finer;
    }
    let upper = |way: Vec3| {
        let moved = move |p: &Vec3| if p.y > 0.0 { way } else { Vec3::ZERO };
        mesh.positions.iter().map(moved).collect::<Vec<_>>()
    };
    let all = |way: Vec3| vec![way; mesh.positions.len()];
    mesh.targets = vec![all(Vec3::Y), upper(Vec3::Y), upper(Vec3::X), upper(-Vec3::Y)];
    mesh.target_names = ["rise", "thicken", "slide", "thin"].map(String::from).to_vec();
    mesh
}

/// Runs a test's body and collects the errors that it logs.
///
/// While there is only one collector, `tracing` asks the first thread that reaches a message whether anybody wants it, and that
/// may be another test's thread. With two collectors it asks for each thread.
pub(crate) fn collect_errors(body: impl FnOnce(&Errors)) {
    Errors::collect(|_| Errors::collect(body));
}
