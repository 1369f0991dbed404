//! Time that stands still, and surfaces that the game puts somewhere else.

use std::time::Duration;

use avian3d::prelude::*;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::start;
use crate::support::{body, place, run, set_weights, spawn, velocity};

/// Where physics runs, and how long frames are. Fixed steps take 1/64 s.
type Schedule = (InternedScheduleLabel, f64);

fn schedules() -> [Schedule; 4] {
    [
        (FixedPostUpdate.intern(), 1.0 / 60.0),
        (FixedPostUpdate.intern(), 1.0 / 144.0),
        (FixedUpdate.intern(), 1.0 / 30.0),
        (PostUpdate.intern(), 1.0 / 60.0),
    ]
}

/// What is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Change {
    Weights,
    Transform,
    /// The transform of a kinematic body on which the surface is.
    Body,
}

const CHANGES: [Change; 3] = [Change::Weights, Change::Transform, Change::Body];

/// A sheet, with a body at rest on it. Returns the entity to move, the sheet and the body.
fn on_a_sheet(
    (schedule, frame): Schedule,
    change: Change,
    max_acceleration: f32,
    collider: Collider,
) -> (App, [Entity; 3]) {
    let mut app = headless(std::path::Path::new("."));
    app.add_plugins((PhysicsPlugins::new(schedule), MorphAvianPlugin.in_schedule(schedule)))
        .insert_resource(Time::<Fixed>::from_hz(64.0))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(frame)));
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    let trusting = MorphPhysicsCollider {
        max_acceleration,
        ..default()
    };
    app.world_mut().entity_mut(surface).insert(trusting);
    let mut root = surface;
    if change == Change::Body {
        let parts = (RigidBody::Kinematic, Transform::default(), Visibility::default());
        root = app.world_mut().spawn(parts).id();
        app.world_mut().entity_mut(surface).insert(ChildOf(root));
    }
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, 0.51, 0.05));
    run(&mut app, (0.4 / frame) as usize);
    assert!((place(&app, body).y - 0.5).abs() < 1e-2, "{}", place(&app, body));
    (app, [root, surface, body])
}

fn raise(app: &mut App, [root, surface, _]: [Entity; 3], change: Change, to: f32) {
    if change == Change::Weights {
        set_weights(app, surface, &[to, 0.0]);
    } else {
        app.world_mut().get_mut::<Transform>(root).unwrap().translation.y = to;
    }
}

/// The highest place of a body while it comes to rest.
fn highest(app: &mut App, body: Entity, frame: f64) -> f32 {
    let mut highest = f32::MIN;
    for _ in 0..(0.8 / frame) as usize {
        run(app, 1);
        highest = highest.max(place(app, body).y);
    }
    highest
}

/// How time stands still.
#[derive(Clone, Copy, Debug)]
enum Pause {
    /// The clock of the game is paused.
    Clock,
    /// It runs at speed 0.
    SpeedZero,
    /// That of physics is paused.
    Physics,
}

fn pause(app: &mut App, how: Pause, on: bool) {
    let world = app.world_mut();
    match how {
        Pause::Clock if on => world.resource_mut::<Time<Virtual>>().pause(),
        Pause::Clock => world.resource_mut::<Time<Virtual>>().unpause(),
        Pause::SpeedZero => {
            let speed = if on { 0.0 } else { 1.0 };
            world.resource_mut::<Time<Virtual>>().set_relative_speed(speed);
        }
        Pause::Physics if on => world.resource_mut::<Time<Physics>>().pause(),
        Pause::Physics => world.resource_mut::<Time<Physics>>().unpause(),
    }
}

#[test]
fn what_changes_during_a_pause_throws_nothing() {
    let mut wrong = Vec::new();
    for (setting, schedule) in schedules().into_iter().enumerate() {
        for (kind, how) in [Pause::Clock, Pause::SpeedZero, Pause::Physics].into_iter().enumerate() {
            let changes = [
                (Change::Weights, 0.02),
                (Change::Weights, 0.2),
                (Change::Weights, -0.2),
                (Change::Transform, 0.2),
                (Change::Body, 0.02),
                (Change::Body, 0.2),
            ];
            // Avian does one more step after its clock was paused. Of short frames, not every one has a step.
            let first = match how {
                Pause::Physics if schedule.1 < 1.0 / 64.0 => 5,
                Pause::Physics => 1,
                _ => 0,
            };
            for (number, (change, by)) in changes.into_iter().enumerate() {
                // At once or later, in turn: each schedule sees both, and so does each change.
                let later = if (setting + kind + number) % 2 == 0 { first } else { 5 };
                let (mut app, all) = on_a_sheet(schedule, change, 100.0, Collider::sphere(0.5));
                pause(&mut app, how, true);
                run(&mut app, later);
                raise(&mut app, all, change, by);
                run(&mut app, 5);
                pause(&mut app, how, false);
                let highest = highest(&mut app, all[2], schedule.1);
                let rests = place(&app, all[2]).y;
                if highest > 0.51 + by.max(0.0) || (rests - 0.5 - by).abs() > 1e-2 {
                    wrong.push(format!(
                        "{schedule:?}, {how:?}, {change:?} by {by}, {later} frames later: thrown to {highest}, rests at {rests}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_put_elsewhere_pushes_out_but_throws_nothing() {
    let mut wrong = Vec::new();
    for schedule in schedules() {
        for change in CHANGES {
            for paused in [false, true] {
                // Every change counts as motion, unless the game says otherwise.
                let (mut app, all) = on_a_sheet(schedule, change, f32::INFINITY, Collider::sphere(0.5));
                app.world_mut().resource_mut::<MorphCollisionSettings>().paused = paused;
                if paused {
                    // It stays there, and counts again when it is inserted again.
                    app.world_mut().entity_mut(all[0]).insert(MorphTeleported);
                    run(&mut app, 10);
                }
                raise(&mut app, all, change, 0.2);
                app.world_mut().entity_mut(all[0]).insert(MorphTeleported);
                let highest = highest(&mut app, all[2], schedule.1);
                let rests = place(&app, all[2]).y;
                if highest > 0.71 || (rests - 0.7).abs() > 1e-2 {
                    wrong.push(format!(
                        "{schedule:?}, {change:?}, collisions paused: {paused}: thrown to {highest}, rests at {rests}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_put_elsewhere_carries_nothing_along() {
    for schedule in schedules() {
        let (mut app, [_, surface, cuboid]) = on_a_sheet(
            schedule,
            Change::Transform,
            f32::INFINITY,
            Collider::cuboid(1.0, 1.0, 1.0),
        );
        let before = place(&app, cuboid).x;
        let there = (Transform::from_xyz(0.3, 0.0, 0.0), MorphTeleported);
        app.world_mut().entity_mut(surface).insert(there);
        run(&mut app, 60);
        let after = place(&app, cuboid).x;
        assert!((after - before).abs() < 1e-3, "{schedule:?}: {before} to {after}");
    }
}

#[test]
fn a_jump_of_the_entity_does_not_throw() {
    for schedule in schedules() {
        for change in CHANGES {
            let (mut app, all) = on_a_sheet(schedule, change, 100.0, Collider::sphere(0.5));
            // Its weights change once a frame.
            for i in 0..20 {
                set_weights(&mut app, all[1], &[1e-4 * i as f32, 0.0]);
                run(&mut app, 1);
            }
            raise(&mut app, all, change, 0.4);
            let highest = highest(&mut app, all[2], schedule.1);
            assert!(highest < 0.91, "{schedule:?}, {change:?}: thrown to {highest}");
        }
    }
}

#[test]
fn very_many_steps_in_a_frame_throw_nothing() {
    // In `PostUpdate`, there is a single step, however long the frame is.
    for schedule in schedules()
        .into_iter()
        .filter(|schedule| schedule.0 != PostUpdate.intern())
    {
        let (mut app, [_, surface, ball]) = on_a_sheet(schedule, Change::Weights, 100.0, Collider::sphere(0.5));
        app.world_mut()
            .resource_mut::<Time<Virtual>>()
            .set_max_delta(Duration::from_secs(10));
        let mut height = 0.0;
        let mut rise = |app: &mut App, frame: f64| {
            app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(frame)));
            height += 0.05 * frame as f32;
            set_weights(app, surface, &[height, 0.0]);
            run(app, 1);
            (height, velocity(app, ball).y)
        };
        let mut fastest: f32 = 0.0;
        let lengths = [schedule.1; 60].into_iter().chain([4.0]).chain([schedule.1; 120]);
        let mut last = 0.0;
        for length in lengths {
            let (height, speed) = rise(&mut app, length);
            (last, fastest) = (height, fastest.max(speed));
        }
        assert!(fastest < 0.1, "{schedule:?}: thrown at {fastest}");
        let rests = place(&app, ball).y - 0.5;
        assert!((rests - last).abs() < 0.01, "{schedule:?}: at {rests}, not at {last}");
    }
}
