//! Avian in any schedule, and plugins in any order: it works, or the log says what to write.

use avian3d::prelude::*;
use bevy::app::MainScheduleOrder;
use bevy::prelude::*;
use bevy_morph_avian::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::any_engine::schedules::{
    Broken, Own, Setup, ball_on_a_sheet, is_told_once, works_in_any_schedule_and_in_any_order,
};
use crate::log::Errors;
use crate::support::place;

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

#[test]
fn it_works_in_any_schedule_and_in_any_order() {
    works_in_any_schedule_and_in_any_order(SETUPS);
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
    is_told_once(BROKEN);
}
