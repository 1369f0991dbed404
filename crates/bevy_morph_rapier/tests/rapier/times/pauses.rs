//! Time that stands still, or goes on without steps: what changes meanwhile throws nothing.

use std::path::Path;

use bevy::prelude::*;
use bevy_rapier3d::plugin::RapierConfiguration;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{EVERY, Frames, Steps, Watched, app, begin, begin_to_watch, frames, now, range};
use crate::support::{place, set_weights, spawn};

/// How time stands still.
#[derive(Clone, Copy, Debug)]
enum Pause {
    /// The clock of the game is paused.
    Clock,
    /// It runs at speed 0.
    SpeedZero,
    /// It goes on, and Rapier does not step.
    Pipeline,
}

const PAUSES: [Pause; 3] = [Pause::Clock, Pause::SpeedZero, Pause::Pipeline];

fn pause(app: &mut App, how: Pause, on: bool) {
    let world = app.world_mut();
    match how {
        Pause::Clock if on => world.resource_mut::<Time<Virtual>>().pause(),
        Pause::Clock => world.resource_mut::<Time<Virtual>>().unpause(),
        Pause::SpeedZero => {
            let speed = if on { 0.0 } else { 1.0 };
            world.resource_mut::<Time<Virtual>>().set_relative_speed(speed);
        }
        Pause::Pipeline => {
            let mut contexts = world.query::<&mut RapierConfiguration>();
            let mut configuration = contexts.single_mut(world).expect("there is one context");
            configuration.physics_pipeline_active = !on;
        }
    }
}

/// What is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Weights,
    Transform,
    /// The transform of a kinematic body on which the surface is.
    Body,
}

/// Changes, and how high they raise the surface.
const CHANGES: [(Change, f32); 6] = [
    (Change::Weights, 0.02),
    (Change::Weights, 1.0),
    (Change::Weights, -0.2),
    (Change::Transform, 0.2),
    (Change::Body, 0.02),
    (Change::Body, 0.2),
];

/// A sheet, with a ball at rest on it. Returns the entity to move, the sheet and the ball.
fn ball_on_a_sheet(steps: Steps, lengths: Frames, change: Change) -> (App, Entity, Entity, Entity) {
    let mut app = app(Path::new("."), steps);
    let surface = spawn(&mut app, &sheet(16), ());
    let mut root = surface;
    if change == Change::Body {
        let parts = (
            RigidBody::KinematicPositionBased,
            Sleeping::disabled(),
            Transform::default(),
            Visibility::default(),
        );
        root = app.world_mut().spawn(parts).id();
        app.world_mut().entity_mut(surface).insert(ChildOf(root));
    }
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
    frames(&mut app, lengths, 30);
    begin_to_watch(&mut app, ball);
    (app, root, surface, ball)
}

fn raise(app: &mut App, (root, surface): (Entity, Entity), change: Change, to: f32) {
    if change == Change::Weights {
        set_weights(app, surface, &[to, 0.0]);
    } else {
        app.world_mut().get_mut::<Transform>(root).unwrap().translation.y = to;
    }
}

#[test]
fn what_changes_during_a_pause_throws_nothing() {
    let lengths = Frames::Every(1.0 / 60.0);
    let mut wrong = Vec::new();
    for (setting, steps) in EVERY.into_iter().enumerate() {
        for (kind, how) in PAUSES.into_iter().enumerate() {
            if steps == Steps::PerFrame && !matches!(how, Pause::Pipeline) {
                // It counts frames, whatever the clock does.
                continue;
            }
            for (number, (change, by)) in CHANGES.into_iter().enumerate() {
                // At once or later, in turn: each way of stepping sees both, and so does each change.
                let later = 5 * ((setting + kind + number) % 2);
                let (mut app, root, surface, ball) = ball_on_a_sheet(steps, lengths, change);
                pause(&mut app, how, true);
                frames(&mut app, lengths, later);
                raise(&mut app, (root, surface), change, by);
                frames(&mut app, lengths, 5);
                pause(&mut app, how, false);
                frames(&mut app, lengths, 80);
                let seen = &app.world().resource::<Watched>().steps;
                let (_, highest) = range(seen.iter().map(|(place, _)| place.y));
                let rests = place(&app, ball).y;
                // While the clock stands still, Rapier itself puts a kinematic body back where it was.
                let is_put_back = change == Change::Body && place(&app, root).y != by;
                let by = if is_put_back { 0.0 } else { by };
                // A ball whose middle is below the surface is pushed down.
                let high = if by < 0.5 { 0.5 + by.max(0.0) } else { 0.5 };
                let lies = by > 0.5 || (rests - 0.5 - by).abs() < 1e-2;
                if highest > high + 1e-2 || !lies {
                    wrong.push(format!(
                        "{steps:?}, {how:?}, {change:?} by {by}, {later} frames later: thrown to {highest}, rests at {rests}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_surface_that_rises_before_and_after_a_pause_keeps_its_speed() {
    // In the pause it is lifted by hand, or nothing happens to it.
    for lifted in [0.0, 0.1] {
        for steps in EVERY {
            let lengths = Frames::Every(1.0 / 60.0);
            let (mut app, _, surface, ball) = ball_on_a_sheet(steps, lengths, Change::Transform);
            let since = begin(&mut app, surface, |time| [0.5 * time, 0.0]);
            frames(&mut app, lengths, 60);
            pause(&mut app, Pause::Clock, true);
            frames(&mut app, lengths, 5);
            app.world_mut().get_mut::<Transform>(surface).unwrap().translation.y = lifted;
            if steps == Steps::PerFrame {
                // The surface stands still in its world.
                frames(&mut app, lengths, 60);
            }
            frames(&mut app, lengths, 5);
            pause(&mut app, Pause::Clock, false);
            begin_to_watch(&mut app, ball);
            frames(&mut app, lengths, 60);
            let seen = &app.world().resource::<Watched>().steps;
            let (low, high) = range(seen.iter().map(|(_, velocity)| velocity.y));
            // A step without motion may cost a step of gravity.
            let least = if lifted > 0.0 { 0.3 } else { 0.49 };
            let least = if steps == Steps::PerFrame { -0.2 } else { least };
            assert!(
                low > least && high < 0.51,
                "{steps:?}, lifted by {lifted}: {low} to {high}"
            );
            let (low, high) = range(seen[30..].iter().map(|(_, velocity)| velocity.y));
            assert!(
                low > 0.49 && high < 0.51,
                "{steps:?}, lifted by {lifted}: {low} to {high} later"
            );
            let behind = (0.5 * (now(&app) - since) + lifted - (place(&app, ball).y - 0.5)) / 0.5;
            assert!(
                (-0.02..0.06).contains(&behind),
                "{steps:?}, lifted by {lifted}: {behind} s behind"
            );
        }
    }
}
