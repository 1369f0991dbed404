//! Continuous colliders: what happens between two frames.
//!
//! - `passes`: contacts that begin and end between two frames: their events and state.
//! - `ways`: which motion counts, and for whom.
//! - `times`: times, points, normals and velocities of impacts.
//! - `torture`: motions that collapse, blow up or mirror bodies, and a bound on their work.
//! - `judged`: random motion, compared with brute force over all vertices, faces and edges.

mod judged;
mod passes;
mod times;
mod torture;
mod ways;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;

use crate::support::{Messages, add_mesh, app, cube, settle, spawn};

/// A cube with sides of 1 at x = -2, and a thin wall at x = 0 that no cube is in front of for long.
struct Range {
    app: App,
    bullet: Entity,
    wall: Entity,
    messages: Messages,
}

/// Half the thickness of the wall.
const HALF: f32 = 0.01;

impl Range {
    /// The cube is continuous, the wall is not.
    fn new() -> Self {
        Self::with([true, false])
    }

    fn with([bullet_is, wall_is]: [bool; 2]) -> Self {
        let mut app = app();
        let cube = add_mesh(&mut app, &cube());
        let wall = add_mesh(&mut app, &rigid::box_mesh(Vec3::new(HALF, 3.0, 3.0)));
        let bullet = spawn(&mut app, &cube, -2.0);
        let wall = spawn(&mut app, &wall, 0.0);
        make_continuous(&mut app, bullet, bullet_is);
        make_continuous(&mut app, wall, wall_is);
        settle(&mut app);
        let mut messages = Messages::default();
        messages.read(&app);
        Self {
            app,
            bullet,
            wall,
            messages,
        }
    }

    /// Moves the cube along x, and runs a frame.
    fn shoot(&mut self, x: f32) {
        self.put(x);
        self.app.update();
    }

    fn put(&mut self, x: f32) {
        let mut place = self.app.world_mut().get_mut::<Transform>(self.bullet).unwrap();
        place.translation.x = x;
    }

    /// The events since the last call.
    fn news(&mut self) -> (Vec<MorphCollisionStart>, Vec<MorphCollisionEnd>) {
        self.messages.read(&self.app)
    }

    /// The number of starts and ends since the last call.
    fn counts(&mut self) -> (usize, usize) {
        let (starts, ends) = self.news();
        (starts.len(), ends.len())
    }
}

fn make_continuous(app: &mut App, collider: Entity, is: bool) {
    let mut collider = app.world_mut().get_mut::<MorphCollider>(collider).unwrap();
    *collider = collider.with_continuous(is);
}
