//! Ways to put an app together that only Rapier has, besides those of every engine.

use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;

use crate::any_engine::schedules::{Broken, Setup};

type Rapier = RapierPhysicsPlugin<NoUserData>;

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

pub(crate) const MORE_SETUPS: &[Setup] = &[
    ("in the fixed schedule", |app| {
        app.add_plugins((Rapier::default().in_fixed_schedule(), MorphPlugins, MorphRapierPlugin));
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

pub(crate) const MORE_BROKEN: &[Broken] = &[
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
