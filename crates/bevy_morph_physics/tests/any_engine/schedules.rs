//! An engine in any schedule, and plugins in any order: it works, or the log says what to write.

use std::path::Path;
use std::time::Duration;

use bevy::app::MainScheduleOrder;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_workspace::app::without_collisions;
use morph_collision_workspace::physics::{settle, sheet};

use super::scene::part;
use crate::log::{Errors, start};
use crate::support::{
    ENGINE_PLUGIN, MORE_BROKEN, MORE_SETUPS, OUR_PLUGIN, OurPlugin, ball, body, diagnostics, engine, engine_in, place,
    run, spawn, velocity,
};

/// A schedule of the game's own.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Own;

/// A way to put an app together.
pub(crate) type Setup = (&'static str, fn(&mut App));

/// Those that every engine has. The crate of an engine may have more.
const SETUPS: &[Setup] = &[
    ("the group after the engine", |app| {
        app.add_plugins((engine(), MorphPlugins, OurPlugin));
    }),
    ("the group before the engine", |app| {
        app.add_plugins((MorphPlugins, OurPlugin, engine()));
    }),
    ("in FixedUpdate, the group before the engine", |app| {
        app.add_plugins((MorphPlugins, OurPlugin, engine_in(FixedUpdate)));
    }),
    ("in FixedPostUpdate, collisions in FixedUpdate", |app| {
        let collisions = MorphPlugins.in_schedule(FixedUpdate);
        app.add_plugins((engine_in(FixedPostUpdate), collisions, OurPlugin));
    }),
    ("in PostUpdate, collisions in FixedUpdate", |app| {
        let collisions = MorphPlugins.in_schedule(FixedUpdate);
        app.add_plugins((engine_in(PostUpdate), collisions, OurPlugin));
    }),
    ("in Update", |app| {
        app.add_plugins((engine_in(Update), MorphPlugins, OurPlugin));
    }),
    ("in a schedule within the fixed ones", |app| {
        app.init_schedule(Own)
            .add_systems(FixedUpdate, |world: &mut World| world.run_schedule(Own));
        app.add_plugins((engine_in(Own), MorphPlugins, OurPlugin));
    }),
    ("in a schedule of the main loop", |app| {
        app.init_schedule(Own);
        app.world_mut()
            .resource_mut::<MainScheduleOrder>()
            .insert_after(Update, Own);
        app.add_plugins((MorphPlugins, OurPlugin, engine_in(Own)));
    }),
    ("single plugins, named schedule", |app| {
        let ours = OurPlugin.in_schedule(FixedUpdate);
        app.add_plugins((ours, MorphCollisionPlugin, engine_in(FixedUpdate)));
    }),
];

/// A way to put an app together in which physics cannot feel a mesh, and what the log must name.
pub(crate) type Broken = (&'static str, fn(&mut App), &'static str);

/// Those that every engine has.
const BROKEN: &[Broken] = &[
    (
        "neither the engine nor the plugin for it",
        |app| {
            app.add_plugins(MorphPlugins);
        },
        OUR_PLUGIN,
    ),
    (
        "no plugin for the engine",
        |app| {
            app.add_plugins((engine(), MorphCollisionPlugin));
        },
        OUR_PLUGIN,
    ),
    (
        "the single plugin without the engine",
        |app| {
            app.add_plugins((OurPlugin, MorphCollisionPlugin));
        },
        ENGINE_PLUGIN,
    ),
    (
        "without collisions",
        |app| {
            app.add_plugins((engine(), OurPlugin));
        },
        "MorphCollisionPlugin",
    ),
];

/// Starts an app with one step of 1/64 s in each frame, a sheet and a ball at rest on it. Returns the sheet and the ball.
fn ball_on_a_sheet(set_up: fn(&mut App)) -> (App, Entity, Entity) {
    let mut app = without_collisions(Path::new("."));
    set_up(&mut app);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 64.0)));
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, ball(0.5), Vec3::new(0.1, 0.51, 0.05));
    run(&mut app, 40);
    (app, surface, ball)
}

#[test]
fn it_works_in_any_schedule_and_in_any_order() {
    Errors::collect(|errors| {
        for &(name, set_up) in SETUPS.iter().chain(MORE_SETUPS) {
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
            let wrong = OurPlugin.in_schedule(PostUpdate);
            app.add_plugins((engine_in(FixedUpdate), MorphPlugins, wrong));
        });
        assert!((place(&app, ball).y - 0.5).abs() < 1e-2);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(
            warnings[0].contains(&format!("write {OUR_PLUGIN} alone")),
            "{warnings:?}"
        );
        assert!(warnings[0].contains("FixedUpdate"), "{warnings:?}");
    });
}

#[test]
fn what_cannot_work_is_logged_once() {
    Errors::collect(|errors| {
        for &(name, set_up, names) in BROKEN.iter().chain(MORE_BROKEN) {
            let mut app = without_collisions(Path::new("."));
            set_up(&mut app);
            start(&mut app);
            for _ in 0..2 {
                spawn(&mut app, &sheet(2), ());
                run(&mut app, 5);
            }
            let logged = [errors.take(), errors.take_warnings()].concat();
            assert_eq!(logged.len(), 1, "{name}: {logged:?}");
            assert!(logged[0].contains(names), "{name}: {logged:?}");
        }
    });
}

/// A surface, and a scene with a surface.
fn spawn_both(app: &mut App) {
    spawn(app, &sheet(2), Name::new("surface"));
    let scene = (MorphPhysicsScene::default(), Transform::default(), Name::new("scene"));
    let scene = app.world_mut().spawn(scene).id();
    part(app, scene, "part", &sheet(2), Vec3::X);
}

#[test]
fn components_may_come_before_plugins() {
    let orders: [fn(&mut App); 4] = [
        |app| {
            spawn_both(app);
            app.add_plugins((engine(), MorphPlugins, OurPlugin));
        },
        |app| {
            app.add_plugins((engine(), MorphPlugins));
            spawn_both(app);
            app.add_plugins(OurPlugin);
        },
        |app| {
            app.add_plugins((MorphPlugins, OurPlugin));
            spawn_both(app);
            app.add_plugins(engine());
        },
        |app| {
            app.add_plugins((engine(), OurPlugin));
            spawn_both(app);
            app.add_plugins(MorphPlugins);
        },
    ];
    Errors::collect(|errors| {
        for (order, set_up) in orders.into_iter().enumerate() {
            let mut app = without_collisions(Path::new("."));
            set_up(&mut app);
            start(&mut app);
            settle(&mut app);
            run(&mut app, 3);
            assert_eq!(diagnostics(&app).surfaces, 2, "{order}");
            assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]), "{order}");
        }
    });
}

#[test]
fn a_component_without_an_engine_is_logged_whenever_it_came_unless_it_is_gone() {
    let ways: [Broken; 4] = [
        (
            "before collisions",
            |app| {
                spawn_both(app);
                app.add_plugins(MorphPlugins);
            },
            "`MorphPhysicsCollider` has no effect on entity `surface`",
        ),
        (
            "after collisions",
            |app| {
                app.add_plugins(MorphPlugins);
                spawn_both(app);
            },
            "`MorphPhysicsCollider` has no effect on entity `surface`",
        ),
        (
            "the first one is gone",
            |app| {
                app.add_plugins(MorphPlugins);
                let gone = spawn(app, &sheet(2), ());
                app.world_mut()
                    .spawn((MorphPhysicsScene::default(), Name::new("scene")));
                app.world_mut().despawn(gone);
            },
            "`MorphPhysicsScene` has no effect on entity `scene`",
        ),
        (
            "in a schedule",
            |app| {
                app.add_plugins(MorphPlugins)
                    .add_systems(Startup, |mut commands: Commands| {
                        commands.spawn((MorphPhysicsScene::default(), Name::new("scene")));
                    });
            },
            "`MorphPhysicsScene` has no effect on entity `scene`",
        ),
    ];
    Errors::collect(|errors| {
        for (name, set_up, expected) in ways {
            let mut app = without_collisions(Path::new("."));
            set_up(&mut app);
            start(&mut app);
            assert_eq!(errors.take_warnings(), [""; 0], "{name}: before the first frame");
            run(&mut app, 3);
            spawn_both(&mut app);
            run(&mut app, 3);
            let warnings = errors.take_warnings();
            assert_eq!(warnings.len(), 1, "{name}: {warnings:?}");
            assert!(warnings[0].starts_with(expected), "{name}: {warnings:?}");
            assert!(
                warnings[0].contains("lacks a plugin for a physics engine"),
                "{warnings:?}"
            );
        }
    });
    // Nothing is left to warn of, until something comes.
    Errors::collect(|errors| {
        let mut app = without_collisions(Path::new("."));
        app.add_plugins(MorphPlugins);
        let gone = spawn(&mut app, &sheet(2), ());
        app.world_mut().despawn(gone);
        start(&mut app);
        run(&mut app, 2);
        assert_eq!(errors.take_warnings(), [""; 0]);
        spawn_both(&mut app);
        run(&mut app, 2);
        assert_eq!(errors.take_warnings().len(), 1);
    });
}
