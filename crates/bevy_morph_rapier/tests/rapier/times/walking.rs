//! Characters that walk in fixed steps on surfaces that frames animate.

use std::path::Path;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use super::{LENGTHS, Steps, Watched, app, begin, begin_to_watch, frames};
use crate::support::spawn;

/// Its own walking speed.
const WALK: f32 = 0.4;

fn walk(mut walkers: Query<&mut KinematicCharacterController>, time: Res<Time>) {
    for mut walker in &mut walkers {
        walker.translation = Some(Vec3::new(WALK * time.delta_secs(), -0.05, 0.0));
    }
}

#[test]
fn a_character_walks_and_is_carried_in_every_step() {
    for rate in [64.0, 60.0] {
        for lengths in LENGTHS {
            for on_a_body in [false, true] {
                let mut app = app(Path::new("."), Steps::Fixed(rate));
                app.add_systems(FixedUpdate, walk.before(PhysicsSet::SyncBackend));
                let surface = spawn(&mut app, &sheet(16), ());
                settle(&mut app);
                let parts = (
                    Collider::capsule_y(0.5, 0.3),
                    KinematicCharacterController::default(),
                    Transform::from_xyz(-3.0, 0.82, 0.05),
                    // The recorded entity needs a velocity; its value is not checked.
                    Velocity::default(),
                );
                let walker = app.world_mut().spawn(parts).id();
                if on_a_body {
                    let mut walker = app.world_mut().entity_mut(walker);
                    walker.insert(RigidBody::KinematicPositionBased);
                }
                begin(&mut app, surface, |time| [0.1 * time, 0.5 * time]);
                frames(&mut app, lengths, 60);
                begin_to_watch(&mut app, walker);
                frames(&mut app, lengths, 150);
                let steps = &app.world().resource::<Watched>().steps;
                let (first, last) = (steps[0].0, steps[steps.len() - 1].0);
                let time = (steps.len() - 1) as f32 / rate as f32;
                let speed = (last - first) / time;
                assert!(
                    (speed.x - WALK - 0.5).abs() < 0.02 && (speed.y - 0.1).abs() < 0.01,
                    "{rate} steps a second, {lengths:?}, on a body: {on_a_body}: {speed}"
                );
            }
        }
    }
}
