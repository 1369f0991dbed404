//! A player walks on a heaving hill while balls and boxes rain down. The hill is a glTF file that plays its clip; it pushes and
//! carries what is on it.
//!
//! With the feature `render` it is drawn and played with the keyboard, unless `--headless` asks for numbers. `--help` lists the
//! options.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use bevy::asset::AssetPath;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use clap::Parser;
use morph_collision_workspace::app::{is_loaded, locate, ready, update_until, without_collisions};
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::heaving::{self, Game, Hill, MODEL, Player, RATE, Report};
use morph_collision_workspace::options::OutputOptions;
use morph_collision_workspace::outcome::{exit_code, print_report, progress_bar};
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo};

/// A player walks on a heaving hill while balls and boxes rain down.
#[derive(Parser)]
struct Options {
    /// Number of balls and boxes.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    bodies: u32,
    /// Frames of 1/60 s each; physics steps 64 times a second.
    #[arg(long, default_value_t = 900, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// A glTF or glb file with morph targets or joints, used instead of the hill.
    #[arg(long)]
    model: Option<PathBuf>,
    /// Use continuous collision detection for falling bodies.
    #[arg(long)]
    ccd: bool,
    /// Random seed for where and how bodies fall.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    output: OutputOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

/// What makes a deforming mesh part of physics. `heaving` has the player, the rain and the clip.
pub(crate) fn play(app: &mut App) {
    app.add_plugins((
        MorphCollisionPlugin,
        // Physics runs in fixed steps, independently of the frame rate.
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        MorphRapierPlugin,
        heaving::plugin,
    ))
    .insert_resource(Time::<Fixed>::from_hz(RATE))
    .insert_resource(heaving::timestep())
    .add_systems(Startup, spawn_hill);
}

fn spawn_hill(mut commands: Commands, assets: Res<AssetServer>, game: Res<Game>) {
    let file = AssetPath::from_path_buf(game.model.clone());
    commands.spawn((
        Hill::new(assets.load(file.clone())),
        WorldAssetRoot(assets.load(file.with_label("Scene0"))),
        // Adds physics to every deforming mesh below it.
        MorphPhysicsScene::default(),
        Visibility::default(),
    ));
}

fn run(options: &Options) -> Result<(), ExampleError> {
    let game = Game {
        bodies: options.bodies,
        seed: options.seed,
        ccd: options.ccd,
        model: match &options.model {
            Some(model) => locate(model)?,
            None => MODEL.into(),
        },
    };
    if options.output.is_drawn("physics")? {
        #[cfg(feature = "render")]
        return view::run(demo(game), &options.output.view);
    }
    let mut app = begin(game)?;
    let progress = progress_bar(options.frames.into());
    let mut times = Vec::new();
    for _ in 0..options.frames {
        let start = Instant::now();
        app.update();
        times.push(start.elapsed().as_secs_f64() * 1e6);
        progress.inc(1);
    }
    progress.finish_and_clear();
    print_report(&Report::of(&mut app, times), options.output.json);
    Ok(())
}

/// The game without a window. Waits until the hill is loaded, then adds the player and the rain above it.
fn begin(game: Game) -> Result<App, ExampleError> {
    let file = game.model.clone();
    let mut app = without_collisions(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets")));
    app.insert_resource(game).add_plugins(play);
    ready(&mut app);
    let mut hills = app.world_mut().query::<&Hill>();
    let mut players = app.world_mut().query_filtered::<(), With<Player>>();
    update_until(&mut app, &file, |world| {
        if let Ok(hill) = hills.single(world) {
            is_loaded(world.resource::<AssetServer>(), hill.gltf.id().untyped(), &file)?;
        }
        Ok(players.iter(world).next().is_some())
    })?;
    Ok(app)
}

/// The game, drawn.
#[cfg(feature = "render")]
#[must_use]
pub fn demo(game: Game) -> Demo {
    Demo {
        name: "physics",
        about: "A hill rises and falls with a clip from a glTF file: it carries who walks on it, and throws what falls on it. \
            Physics in fixed steps, by Rapier.",
        keys: &[
            ("W A S D, arrows", "walk; alone, it walks by itself"),
            ("Space", "jump"),
        ],
        // Shifted a little to the left, because of the panel.
        eye: Vec3::new(-0.9, 4.3, 8.4),
        target: Vec3::new(-0.9, 0.8, 0.0),
        pictures: &[60, 180, 360, 540],
        scene: Box::new(move |app| {
            app.insert_resource(game)
                .add_plugins((play, MorphBoundsPlugin, heaving::stage::plugin));
        }),
    }
}
