//! What the tests of every engine need, besides what `support` of an engine's crate offers.

use std::collections::HashMap;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_models::generated::rigid::box_mesh;
use morph_collision_models::mesh::MorphMesh;
pub(crate) use morph_collision_workspace::physics::DT;
use morph_collision_workspace::physics::{bevy_mesh, settle, sheet};

use crate::log::Errors;
use crate::support::{Collider, app, ball, body, place};

/// A mesh in physics, at rest.
pub(crate) fn spawn(app: &mut App, mesh: &MorphMesh, more: impl Bundle) -> Entity {
    let handle = app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh));
    let weights = MeshMorphWeights::Value {
        weights: vec![0.0; mesh.targets.len()],
    };
    let collider = MorphPhysicsCollider::default();
    app.world_mut().spawn((Mesh3d(handle), weights, collider, more)).id()
}

pub(crate) fn set_weights(app: &mut App, entity: Entity, weights: &[f32]) {
    let weights = MeshMorphWeights::Value {
        weights: weights.to_vec(),
    };
    app.world_mut().entity_mut(entity).insert(weights);
}

pub(crate) fn run(app: &mut App, frames: usize) {
    for _ in 0..frames {
        app.update();
    }
}

pub(crate) fn diagnostics(app: &App) -> MorphPhysicsDiagnostics {
    *app.world().resource::<MorphPhysicsDiagnostics>()
}

/// Two entities in ascending order.
pub(crate) fn pair(a: Entity, b: Entity) -> (Entity, Entity) {
    (a.min(b), a.max(b))
}

/// Where [`ball_on_sheet`] puts the ball.
pub(crate) const BALL: Vec3 = Vec3::new(0.1, 0.31, 0.05);

/// A sheet with a ball at rest on it.
pub(crate) fn ball_on_sheet() -> (App, Entity, Entity) {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, ball(0.3), BALL);
    run(&mut app, 30);
    assert!((place(&app, ball).y - 0.3).abs() < 1e-2, "{}", place(&app, ball));
    (app, surface, ball)
}

/// A sheet, and a body that has come to rest on it at height 0.5.
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
