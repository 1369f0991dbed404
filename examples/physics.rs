//! A player walks on a heaving hill while balls and boxes rain down. The hill is a glTF file that plays its clip; it pushes and
//! carries what is on it.
//!
//! With the feature `render` it is drawn and played with the keyboard, unless `--headless` asks for numbers. `--help` lists the
//! options.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_rapier3d::prelude::Velocity;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use morph_collision_workspace::app::{headless, is_loaded, locate, ready, update_until};
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::heaving::{self, Falling, Game, Hill, MODEL, Player, Tally};
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::outcome::{exit_code, print_report};
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};
use serde::Serialize;

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
    /// Print numbers instead of drawing. Always on without the feature `render`.
    #[arg(long)]
    headless: bool,
    #[command(flatten)]
    view: ViewOptions,
    /// Print only the result, as one JSON object.
    #[arg(long)]
    json: bool,
}

/// The result of a run.
#[derive(Serialize)]
struct Report {
    bodies: usize,
    frames: u32,
    /// Bodies whose centre went through the hill.
    fell_through: usize,
    /// Bodies that hardly move at the end.
    resting: usize,
    /// Steps since the player first stood on something.
    player_steps: u32,
    /// The share of these steps after which it was on the ground, according to Rapier's controller.
    player_grounded: f64,
    /// The share of these steps after which the hill was below its feet.
    player_on_hill: f64,
    /// How far it walked, seen from above.
    player_walked: f64,
    /// Time of whole frames, in microseconds.
    frame_us: Times,
}

#[derive(Serialize)]
struct Times {
    median: f64,
    worst: f64,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
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
    if options.view.is_drawn("physics", options.headless || options.json)? {
        #[cfg(feature = "render")]
        return view::run(shows::physics(game), &options.view);
    }
    let mut app = begin(game)?;
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len}").unwrap_or(ProgressStyle::default_bar());
    let progress = ProgressBar::new(options.frames.into()).with_style(style);
    let mut times = Vec::new();
    for _ in 0..options.frames {
        let start = Instant::now();
        app.update();
        times.push(start.elapsed().as_secs_f64() * 1e6);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let report = report(&mut app, times);
    print_report(&report, options.json);
    Ok(())
}

/// The game without a window. Waits until the hill is loaded, then adds the player and the rain above it.
fn begin(game: Game) -> Result<App, ExampleError> {
    let file = game.model.clone();
    let mut app = headless(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets")));
    app.insert_resource(game).add_plugins(heaving::plugin);
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

fn report(app: &mut App, mut times: Vec<f64>) -> Report {
    let frames = times.len() as u32;
    times.sort_by(f64::total_cmp);
    let tenths = |us: f64| (us * 10.0).round() / 10.0;
    let at = |place: usize| times.get(place).copied().map_or(0.0, tenths);
    let frame_us = Times {
        median: at(times.len() / 2),
        worst: at(times.len().saturating_sub(1)),
    };
    let mut bodies = app.world_mut().query::<(&Falling, &Velocity)>();
    let (mut count, mut fell_through, mut resting) = (0, 0, 0);
    for (falling, velocity) in bodies.iter(app.world()) {
        count += 1;
        fell_through += usize::from(falling.through);
        resting += usize::from(velocity.linear.length() < 0.2);
    }
    let tally = *app.world().resource::<Tally>();
    let thousandths = |x: f32| (f64::from(x) * 1e3).round() / 1e3;
    Report {
        bodies: count,
        frames,
        fell_through,
        resting,
        player_steps: tally.steps,
        player_grounded: thousandths(tally.share(tally.grounded)),
        player_on_hill: thousandths(tally.share(tally.on_hill)),
        player_walked: thousandths(tally.walked),
        frame_us,
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            bodies,
            frames,
            fell_through,
            resting,
            player_steps,
            player_grounded,
            player_on_hill,
            player_walked,
            frame_us: Times { median, worst },
        } = self;
        writeln!(f, "{bodies} bodies, {frames} frames")?;
        writeln!(f, "  fell through   {fell_through}")?;
        writeln!(f, "  resting        {resting}")?;
        writeln!(
            f,
            "  player         {:.1} % of {player_steps} steps on its feet, {:.1} % on the hill, walked {player_walked:.1}",
            100.0 * player_grounded,
            100.0 * player_on_hill
        )?;
        write!(f, "  per frame      {median:.0} us median, {worst:.0} us worst")
    }
}
