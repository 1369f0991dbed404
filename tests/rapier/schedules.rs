//! Rapier in any schedule, and plugins in any order: it works, or the log says what to write.

use std::path::Path;
use std::time::Duration;

use bevy::app::MainScheduleOrder;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::app::without_collisions;
use morph_collision_workspace::physics::{body, settle, sheet};

use crate::log::{Errors, start};
use crate::support::{place, run, spawn, velocity};

/// A schedule of the game's own.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Own;

type Rapier = RapierPhysicsPlugin<NoUserData>;

/// A way to put an app together.
type Setup = (&'static str, fn(&mut App));

fn own_in_fixed_update(app: &mut App) {
    app.init_schedule(Own)
        .add_systems(FixedUpdate, |world: &mut World| world.run_schedule(Own));
}

fn set_up_by_hand(app: &mut App, schedule: impl ScheduleLabel + Clone) {
    for set in [
        PhysicsSet::SyncBackend,
        PhysicsSet::StepSimulation,
        PhysicsSet::Writeback,
    ] {
        app.add_systems(schedule.clone(), Rapier::get_systems(set));
    }
    app.configure_sets(
        schedule,
        (
            PhysicsSet::SyncBackend,
            PhysicsSet::StepSimulation,
            PhysicsSet::Writeback,
        )
            .chain(),
    )
    .init_resource::<TimestepMode>();
}

const SETUPS: &[Setup] = &[
    ("the group after Rapier", |app| {
        app.add_plugins((Rapier::default(), MorphPlugins, MorphRapierPlugin));
    }),
    ("the group before Rapier", |app| {
        app.add_plugins((MorphPlugins, MorphRapierPlugin, Rapier::default()));
    }),
    ("in the fixed schedule", |app| {
        app.add_plugins((Rapier::default().in_fixed_schedule(), MorphPlugins, MorphRapierPlugin));
    }),
    ("in the fixed schedule, the group before Rapier", |app| {
        app.add_plugins((MorphPlugins, MorphRapierPlugin, Rapier::default().in_fixed_schedule()));
    }),
    ("in FixedPostUpdate, collisions in FixedUpdate", |app| {
        let rapier = Rapier::default().in_schedule(FixedPostUpdate);
        app.add_plugins((rapier, MorphPlugins.in_schedule(FixedUpdate), MorphRapierPlugin));
    }),
    ("in Update", |app| {
        app.add_plugins((Rapier::default().in_schedule(Update), MorphPlugins, MorphRapierPlugin));
    }),
    ("in PreUpdate", |app| {
        app.add_plugins((
            Rapier::default().in_schedule(PreUpdate),
            MorphPlugins,
            MorphRapierPlugin,
        ));
    }),
    ("in Last", |app| {
        app.add_plugins((Rapier::default().in_schedule(Last), MorphPlugins, MorphRapierPlugin));
    }),
    ("in a schedule within the fixed ones", |app| {
        own_in_fixed_update(app);
        app.add_plugins((Rapier::default().in_schedule(Own), MorphPlugins, MorphRapierPlugin));
    }),
    ("in a schedule of the main loop", |app| {
        app.init_schedule(Own);
        app.world_mut()
            .resource_mut::<MainScheduleOrder>()
            .insert_after(Update, Own);
        app.add_plugins((MorphPlugins, MorphRapierPlugin, Rapier::default().in_schedule(Own)));
    }),
    ("single plugins, named schedule", |app| {
        app.add_plugins((
            MorphRapierPlugin.in_schedule(FixedUpdate),
            MorphCollisionPlugin,
            Rapier::default().in_fixed_schedule(),
        ));
    }),
    ("systems added by hand, before", |app| {
        app.add_plugins(Rapier::default().with_default_system_setup(false));
        set_up_by_hand(app, FixedUpdate);
        app.add_plugins((MorphPlugins, MorphRapierPlugin));
    }),
    ("systems added by hand, after", |app| {
        app.add_plugins((
            Rapier::default().with_default_system_setup(false),
            MorphPlugins,
            MorphRapierPlugin,
        ));
        set_up_by_hand(app, FixedPostUpdate);
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
    let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
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
            let wrong = MorphRapierPlugin.in_schedule(PostUpdate);
            app.add_plugins((Rapier::default().in_fixed_schedule(), MorphPlugins, wrong));
        });
        assert!((place(&app, ball).y - 0.5).abs() < 1e-2);
        let said = errors.take_warnings();
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].contains("write MorphRapierPlugin alone"), "{said:?}");
        assert!(said[0].contains("FixedUpdate"), "{said:?}");
    });
}

/// A way to put an app together in which physics cannot feel a mesh, and what the log must name.
type Broken = (&'static str, fn(&mut App), &'static str);

const BROKEN: &[Broken] = &[
    (
        "neither Rapier nor the plugin for it",
        |app| {
            app.add_plugins(MorphPlugins);
        },
        "MorphRapierPlugin",
    ),
    (
        "no plugin for Rapier",
        |app| {
            app.add_plugins((Rapier::default(), MorphCollisionPlugin));
        },
        "MorphRapierPlugin",
    ),
    (
        "the single plugin without Rapier",
        |app| {
            app.add_plugins((MorphRapierPlugin, MorphCollisionPlugin));
        },
        "RapierPhysicsPlugin",
    ),
    (
        "without collisions",
        |app| {
            app.add_plugins((Rapier::default(), MorphRapierPlugin));
        },
        "MorphCollisionPlugin",
    ),
    (
        "Rapier's systems nowhere",
        |app| {
            app.add_plugins((
                Rapier::default().with_default_system_setup(false),
                MorphPlugins,
                MorphRapierPlugin,
            ));
        },
        "MorphRapierPlugin.in_schedule(FixedUpdate)",
    ),
    (
        "Rapier's systems twice",
        |app| {
            app.add_plugins(Rapier::default());
            set_up_by_hand(app, FixedUpdate);
            app.add_plugins((MorphPlugins, MorphRapierPlugin));
        },
        "MorphRapierPlugin.in_schedule(FixedUpdate)",
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
