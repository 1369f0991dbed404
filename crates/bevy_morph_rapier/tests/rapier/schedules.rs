//! Rapier in any schedule, and plugins in any order: it works, or the log says what to write.

use bevy::app::MainScheduleOrder;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;

use crate::any_engine::schedules::{
    Broken, Own, Setup, ball_on_a_sheet, is_told_once, works_in_any_schedule_and_in_any_order,
};
use crate::log::Errors;
use crate::support::place;

type Rapier = RapierPhysicsPlugin<NoUserData>;

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

#[test]
fn it_works_in_any_schedule_and_in_any_order() {
    works_in_any_schedule_and_in_any_order(SETUPS);
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
    is_told_once(BROKEN);
}
