//! A slap at ten frames a second. The hand is on one side of the face in one frame and on the other side in the next, so a discrete
//! collider misses. A continuous one tells when, where and how fast it hit.
//!
//! `game` is what you would copy: `with_continuous(true)` on a collider, and an observer that reads the event's `impact`. With the
//! feature `render` it is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::path::Path;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_workspace::app::{self, update_until};
use morph_collision_workspace::character::MODEL;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::options::OutputOptions;
use morph_collision_workspace::outcome::{exit_code, print_report};
use morph_collision_workspace::slap::{self, Felt, Mark, Moment, PERIOD, Report, Role, Side, TICK, Tally};
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo};

/// A slap between two frames, with a discrete and with a continuous collider.
#[derive(Parser)]
struct Options {
    /// Number of slaps.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    slaps: u32,
    #[command(flatten)]
    output: OutputOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn game(app: &mut App) {
    // `slap::plugin` moves arms and faces, and counts.
    app.add_plugins((MorphCollisionPlugin, slap::plugin))
        .add_systems(Startup, spawn);
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>) {
    for side in [Side::Discrete, Side::Continuous] {
        for role in [Role::Slaps, Role::IsSlapped] {
            // Of two colliders, one has to be continuous.
            let is_continuous = role == Role::Slaps && side == Side::Continuous;
            let collider = MorphCollider::new(MorphCollisionMode::First).with_continuous(is_continuous);
            let scene = MorphColliderScene { collider, ..default() };
            let model = WorldAssetRoot(assets.load(GltfAssetLabel::Scene(0).from_asset(MODEL)));
            let mut actor = commands.spawn((side, role, model, scene, Visibility::default(), role.place(side)));
            if role == Role::IsSlapped {
                actor.observe(feel);
            }
        }
    }
}

/// Observes the one who is slapped: remembers that a slap was felt, and marks the place on the skin.
fn feel(
    start: On<MorphBodyCollisionStart>,
    sides: Query<&Side>,
    marks: Query<(Entity, &Side), With<Mark>>,
    moment: Res<Moment>,
    time: Res<Time>,
    mut tally: ResMut<Tally>,
    mut commands: Commands,
) {
    let Ok(&side) = sides.get(start.body1) else { return };
    if !moment.started {
        return;
    }
    // If the app draws several frames in a tick, everything that moves does so in the first of them.
    let slower = time.delta_secs() / TICK.as_secs_f32();
    tally.felt[side as usize] += 1;
    tally.last[side as usize] = Some(Felt {
        tick: moment.tick,
        share: start.impact.map(|impact| impact.earliest),
        speed: start.impact.map_or(0.0, |impact| impact.velocity.length() * slower),
    });
    for (mark, _) in marks.iter().filter(|(_, of)| **of == side) {
        commands.entity(mark).despawn();
    }
    if let Some(MorphImpact {
        triangles,
        barycentrics,
        ..
    }) = start.impact
    {
        let anchor = MorphSurfaceAnchor::new(start.collider1, triangles.triangle_a, barycentrics[0]);
        commands.spawn((Mark, side, anchor));
    }
}

fn run(options: &Options) -> Result<(), ExampleError> {
    if options.output.is_drawn("slap")? {
        #[cfg(feature = "render")]
        return view::run(demo(), &options.output.view);
    }
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
    let mut app = app::without_collisions(assets);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK))
        .add_plugins(game)
        .init_resource::<Ready>()
        .add_observer(|_: On<MorphColliderSceneReady>, mut ready: ResMut<Ready>| ready.0 += 1);
    app::ready(&mut app);
    update_until(&mut app, &assets.join(MODEL), |world| {
        Ok(world.resource::<Ready>().0 == 4)
    })?;
    for tick in 0..options.slaps * PERIOD {
        app.insert_resource(Moment { tick, started: true });
        app.update();
    }
    print_report(&Report::from(app.world().resource::<Tally>()), options.output.json);
    Ok(())
}

/// The number of characters that are ready to collide.
#[derive(Resource, Default)]
struct Ready(usize);

/// Two pairs of the CC0 character.
#[cfg(feature = "render")]
#[must_use]
pub fn demo() -> Demo {
    Demo {
        name: "slap",
        about: "A slap at ten frames a second: lines join the places of the hand in two frames. Left: discrete. Right: continuous.",
        keys: &[],
        eye: Vec3::new(-0.3, 1.25, 2.0),
        target: Vec3::new(-0.3, 0.5, 0.0),
        pictures: &[34, 38, 50],
        scene: Box::new(|app| {
            app.add_plugins((game, MorphBoundsPlugin, slap::stage::plugin));
        }),
    }
}
