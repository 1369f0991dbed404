//! A slap at ten frames a second. The hand is on one side of the face in one frame and on the other side in the next, so a discrete
//! collider misses. A continuous one tells when, where and how fast it hit.
//!
//! With the feature `render` it is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_workspace::app::{self, update_until};
use morph_collision_workspace::character::MODEL;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::outcome::{exit_code, print_report};
use morph_collision_workspace::slap::{self, Felt, Moment, PERIOD, Role, TICK, Tally};
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};
use serde::Serialize;

/// A slap between two frames, with a discrete and with a continuous collider.
#[derive(Parser)]
struct Options {
    /// Number of slaps.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    slaps: u32,
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
    slaps: u32,
    felt_discrete: u32,
    felt_continuous: u32,
    /// When the last one hit, as a share of the time between two frames.
    share: Option<f64>,
    /// The speed of the hand then, in metres per second.
    speed: f32,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let drawn = options.view.is_drawn("slap", options.headless || options.json);
    let done = drawn.and_then(|drawn| if drawn { draw(&options) } else { count(&options) });
    exit_code(done)
}

#[cfg(feature = "render")]
fn draw(options: &Options) -> Result<(), ExampleError> {
    view::run(shows::slap(), &options.view)
}

#[cfg(not(feature = "render"))]
fn draw(_: &Options) -> Result<(), ExampleError> {
    Err(ExampleError::NotDrawn("slap"))
}

fn count(options: &Options) -> Result<(), ExampleError> {
    let report = run(options.slaps)?;
    print_report(&report, options.json);
    Ok(())
}

fn run(slaps: u32) -> Result<Report, ExampleError> {
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
    let mut app = app::headless(assets);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(TICK))
        .add_plugins(slap::plugin);
    app::ready(&mut app);
    let model = assets.join(MODEL);
    app.init_resource::<Ready>();
    app.add_observer(|_: On<MorphColliderSceneReady>, mut ready: ResMut<Ready>| ready.0 += 1);
    update_until(&mut app, &model, |world| {
        let actors = world.query_filtered::<(), With<Role>>().iter(world).count();
        Ok(actors > 0 && world.resource::<Ready>().0 == actors)
    })?;
    for tick in 0..slaps * PERIOD {
        app.insert_resource(Moment { tick, started: true });
        app.update();
    }
    let Tally { slaps, felt, last } = app.world().resource::<Tally>().clone();
    let [_, last] = last;
    Ok(Report {
        slaps,
        felt_discrete: felt[0],
        felt_continuous: felt[1],
        share: last.and_then(|felt| felt.share),
        speed: last.map_or(0.0, |Felt { speed, .. }| speed),
    })
}

/// The number of characters that are ready to collide.
#[derive(Resource, Default)]
struct Ready(usize);

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} slaps, at {} frames a second",
            self.slaps,
            1.0 / TICK.as_secs_f32()
        )?;
        writeln!(f, "  discrete      felt {}", self.felt_discrete)?;
        write!(f, "  continuous    felt {}", self.felt_continuous)?;
        match self.share {
            Some(share) => write!(
                f,
                "; the last after {:.1} % of a frame, at {:.1} m/s",
                100.0 * share,
                self.speed
            ),
            None => Ok(()),
        }
    }
}
