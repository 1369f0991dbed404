//! Rapier's character controllers on moving surfaces.

mod carried;
mod ground;
mod velocity;

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{DT, settle, sheet};

use crate::support::{app, place, set_weights, spawn};

/// From the middle of a character to its soles.
const HALF_HEIGHT: f32 = 0.8;
/// The distance that a controller keeps from everything: a hundredth of its height.
const OFFSET: f32 = 0.016;
/// The height of a character that stands on the ground.
const STANDING: f32 = HALF_HEIGHT + OFFSET;
/// The motion that a game adds in every frame to keep a character on the ground.
const GRAVITY: Vec3 = Vec3::new(0.0, -0.05, 0.0);

/// A capsule with a controller.
fn character(app: &mut App, at: Vec3, more: impl Bundle) -> Entity {
    let parts = (
        Collider::capsule_y(0.5, 0.3),
        KinematicCharacterController::default(),
        Transform::from_translation(at),
        more,
    );
    app.world_mut().spawn(parts).id()
}

/// A sheet of 8 by 8 that rises and slides, and a character in its middle.
fn on_sheet(more: impl Bundle) -> (App, Entity, Entity) {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let walker = character(&mut app, Vec3::new(0.1, STANDING, 0.05), more);
    walk(&mut app, walker, Vec3::ZERO, 10);
    (app, surface, walker)
}

/// Lets a character walk for some frames; returns in how many of them it was on the ground.
fn walk(app: &mut App, walker: Entity, step: Vec3, frames: usize) -> usize {
    (0..frames).filter(|_| walk_once(app, walker, step)).count()
}

fn walk_once(app: &mut App, walker: Entity, step: Vec3) -> bool {
    move_by(app, walker, step + GRAVITY);
    app.update();
    is_grounded(app, walker)
}

/// The motion that a character wants in the next frame.
fn move_by(app: &mut App, walker: Entity, step: Vec3) {
    let mut walker = app.world_mut().entity_mut(walker);
    walker.get_mut::<KinematicCharacterController>().unwrap().translation = Some(step);
}

fn is_grounded(app: &App, walker: Entity) -> bool {
    let output = app.world().get::<KinematicCharacterControllerOutput>(walker);
    output.is_some_and(|output| output.grounded)
}

fn ground(app: &App, walker: Entity) -> MorphCharacterGround {
    *app.world().get::<MorphCharacterGround>(walker).unwrap()
}

/// Walks on a [`sheet`] that rises and slides at these speeds. Returns in how many frames it was on the ground, how far it was
/// carried along the sheet, and the smallest and largest distance of its feet from the sheet.
fn ride(app: &mut App, surface: Entity, walker: Entity, speed: Vec2, frames: usize) -> (usize, Vec3, [f32; 2]) {
    let start = place(app, walker);
    let (mut grounded, mut gaps) = (0, [f32::INFINITY, f32::NEG_INFINITY]);
    for frame in 1..=frames {
        let [rise, slide] = (speed * DT * frame as f32).to_array();
        set_weights(app, surface, &[rise, slide]);
        grounded += usize::from(walk_once(app, walker, Vec3::ZERO));
        let gap = place(app, walker).y - HALF_HEIGHT - rise;
        gaps = [gaps[0].min(gap), gaps[1].max(gap)];
    }
    (grounded, place(app, walker) - start, gaps)
}

/// A level sheet of this size. Its only target moves it along `+X`.
fn sliding(size: f32) -> MorphMesh {
    let mut mesh = morph_collision_models::generated::rigid::grid(size, 8);
    mesh.targets = vec![vec![Vec3::X; mesh.positions.len()]];
    mesh
}
