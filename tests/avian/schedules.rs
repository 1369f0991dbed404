//! Avian in any schedule, and plugins in any order: it works, or the log says what to write.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::app::MainScheduleOrder;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::without_collisions;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::{Errors, start};
use crate::support::{body, place, run, spawn, velocity};

/// A schedule of the game's own.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Own;

/// A way to put an app together.
type Setup = (&'static str, fn(&mut App));

const SETUPS: &[Setup] = &[
    ("the group after Avian", |app| {
        app.add_plugins((PhysicsPlugins::default(), MorphPlugins, MorphAvianPlugin));
    }),
    ("the group before Avian", |app| {
        app.add_plugins((MorphPlugins, MorphAvianPlugin, PhysicsPlugins::default()));
    }),
    ("in FixedUpdate, the group before Avian", |app| {
        app.add_plugins((MorphPlugins, MorphAvianPlugin, PhysicsPlugins::new(FixedUpdate)));
    }),
    ("in PostUpdate, collisions in FixedUpdate", |app| {
        app.add_plugins((
            PhysicsPlugins::new(PostUpdate),
            MorphPlugins.in_schedule(FixedUpdate),
            MorphAvianPlugin,
        ));
    }),
    ("in Update", |app| {
        app.add_plugins((PhysicsPlugins::new(Update), MorphPlugins, MorphAvianPlugin));
    }),
    ("in a schedule within the fixed ones", |app| {
        app.init_schedule(Own)
            .add_systems(FixedUpdate, |world: &mut World| world.run_schedule(Own));
        app.add_plugins((PhysicsPlugins::new(Own), MorphPlugins, MorphAvianPlugin));
    }),
    ("in a schedule of the main loop", |app| {
        app.init_schedule(Own);
        app.world_mut()
            .resource_mut::<MainScheduleOrder>()
            .insert_after(Update, Own);
        app.add_plugins((MorphPlugins, MorphAvianPlugin, PhysicsPlugins::new(Own)));
    }),
    ("single plugins, named schedule", |app| {
        app.add_plugins((
            MorphAvianPlugin.in_schedule(FixedUpdate),
            MorphCollisionPlugin,
            PhysicsPlugins::new(FixedUpdate),
        ));
    }),
];

/// Starts an app with one step of 1/64 s in each frame, a sheet and a ball at rest on it. Returns the sheet and the ball.
fn ball_on_a_sheet(set_up: fn(&mut App)) -> (App, Entity, Entity) {
    let mut app = without_collisions(Path::new("."));
    set_up(&mut app);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 64.0)));
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, Collider::sphere(0.5), Vec3::new(0.1, 0.51, 0.05));
    run(&mut app, 40);
    (app, surface, ball)
}

#[test]
fn it_works_in_any_schedule_and_in_any_order() {
    Errors::collect(|errors| {
        for &(name, set_up) in SETUPS {
            let (mut app, surface, ball) = ball_on_a_sheet(set_up);
            let height = place(&app, ball).y;
            assert!((height - 0.5).abs() < 1e-2, "{name}: at rest at {height}");
            app.add_systems(
                Update,
                move |mut weights: Query<&mut MeshMorphWeights>, time: Res<Time>, mut height: Local<f32>| {
                    *height += 0.5 * time.delta_secs();
                    let weights_now = vec![*height, 0.0];
                    *weights.get_mut(surface).unwrap() = MeshMorphWeights::Value { weights: weights_now };
                },
            );
            run(&mut app, 60);
            let speed = velocity(&app, ball).y;
            assert!((speed - 0.5).abs() < 0.01, "{name}: {speed}");
            assert_eq!(errors.take(), Vec::<String>::new(), "{name}");
            assert_eq!(errors.take_warnings(), Vec::<String>::new(), "{name}");
        }
    });
}

#[test]
fn a_wrong_schedule_is_put_right_and_the_log_says_what_to_write() {
    Errors::collect(|errors| {
        let (app, _, ball) = ball_on_a_sheet(|app| {
            let wrong = MorphAvianPlugin.in_schedule(PostUpdate);
            app.add_plugins((PhysicsPlugins::default(), MorphPlugins, wrong));
        });
        assert!((place(&app, ball).y - 0.5).abs() < 1e-2);
        let said = errors.take_warnings();
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].contains("write MorphAvianPlugin alone"), "{said:?}");
        assert!(said[0].contains("FixedPostUpdate"), "{said:?}");
    });
}

/// A way to put an app together in which physics cannot feel a mesh, and what the log must name.
type Broken = (&'static str, fn(&mut App), &'static str);

const BROKEN: &[Broken] = &[
    (
        "neither Avian nor the plugin for it",
        |app| {
            app.add_plugins(MorphPlugins);
        },
        "MorphAvianPlugin",
    ),
    (
        "no plugin for Avian",
        |app| {
            app.add_plugins((PhysicsPlugins::default(), MorphCollisionPlugin));
        },
        "MorphAvianPlugin",
    ),
    (
        "the single plugin without Avian",
        |app| {
            app.add_plugins((MorphAvianPlugin, MorphCollisionPlugin));
        },
        "PhysicsPlugins",
    ),
    (
        "without collisions",
        |app| {
            app.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin));
        },
        "MorphCollisionPlugin",
    ),
];

#[test]
fn what_cannot_work_is_told_once() {
    Errors::collect(|errors| {
        for &(name, set_up, names) in BROKEN {
            let mut app = without_collisions(Path::new("."));
            set_up(&mut app);
            start(&mut app);
            for _ in 0..2 {
                spawn(&mut app, &sheet(2), ());
                run(&mut app, 5);
            }
            let said = [errors.take(), errors.take_warnings()].concat();
            assert_eq!(said.len(), 1, "{name}: {said:?}");
            assert!(said[0].contains(names), "{name}: {said:?}");
        }
    });
}
