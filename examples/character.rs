//! A skinned and morphed character walks, talks, crouches and waves. Rays stick to its skin, it kicks crates, and its hand turns
//! red where it touches the face.
//!
//! With the feature `render` it is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_workspace::app::{STEP, update_until};
use morph_collision_workspace::character::{self, Dart, HandOnFace, MODEL, Moment, Skin, Tally};
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::options::ViewOptions;
use morph_collision_workspace::outcome::{exit_code, print_report};
use morph_collision_workspace::physics;
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};
use serde::Serialize;

/// A character that walks, talks, crouches and waves, is hit by rays and kicks crates.
#[derive(Parser)]
struct Options {
    /// Frames of 1/60 s each.
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
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
#[derive(Serialize, Default)]
struct Report {
    frames: u32,
    rays: u32,
    hits: u32,
    /// The largest distance of a dart from its triangle.
    darts_off_by: f32,
    kicks: u32,
    /// Frames in which a hand touched the face.
    frames_hand_on_face: u32,
    /// The most pairs of triangles between hand and face in a frame.
    most_pairs: usize,
    /// The largest number of parts of the skin near crates.
    most_parts: u32,
    /// Time of whole frames, in microseconds.
    frame_us: Times,
}

#[derive(Serialize, Default)]
struct Times {
    median: f64,
    worst: f64,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let drawn = options.view.is_drawn("character", options.headless || options.json);
    let done = drawn.and_then(|drawn| if drawn { draw(&options) } else { count(&options) });
    exit_code(done)
}

#[cfg(feature = "render")]
fn draw(options: &Options) -> Result<(), ExampleError> {
    view::run(shows::character(), &options.view)
}

#[cfg(not(feature = "render"))]
fn draw(_: &Options) -> Result<(), ExampleError> {
    Err(ExampleError::NotDrawn("character"))
}

fn count(options: &Options) -> Result<(), ExampleError> {
    let report = run(options.frames)?;
    print_report(&report, options.json);
    Ok(())
}

fn run(frames: u32) -> Result<Report, ExampleError> {
    let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
    let mut app = physics::app_with(assets, character::plugin);
    update_until(&mut app, &assets.join(MODEL), |world| {
        Ok(world.query_filtered::<(), With<Skin>>().iter(world).count() == 1)
    })?;
    physics::settle(&mut app);
    let mut report = Report {
        frames,
        ..Report::default()
    };
    let mut times = Vec::new();
    for frame in 0..frames {
        app.insert_resource(Moment {
            seconds: frame as f32 * STEP.as_secs_f32(),
            started: true,
        });
        let start = Instant::now();
        app.update();
        times.push(start.elapsed().as_secs_f64() * 1e6);
        report.look(&mut app);
    }
    times.sort_by(f64::total_cmp);
    let tenths = |us: f64| (us * 10.0).round() / 10.0;
    let at = |place: usize| times.get(place).copied().map_or(0.0, tenths);
    report.frame_us = Times {
        median: at(times.len() / 2),
        worst: at(times.len().saturating_sub(1)),
    };
    Ok(report)
}

impl Report {
    /// Adds a frame to the report.
    fn look(&mut self, app: &mut App) {
        let tally = app.world().resource::<Tally>().clone();
        (self.rays, self.hits, self.kicks) = (tally.rays, tally.hits, tally.kicks);
        let parts = app.world().resource::<MorphRapierDiagnostics>().parts;
        self.most_parts = self.most_parts.max(parts);
        let look = |darts: Query<(&MorphSurfaceAnchor, &GlobalTransform), With<Dart>>,
                    touching: Query<&HandOnFace>,
                    spatial: MorphSpatialQuery| {
            let mut off = 0.0_f32;
            for (anchor, place) in &darts {
                if let Some([a, b, c]) = spatial.posed_triangle(anchor.collider, anchor.triangle) {
                    let [u, v, w] = anchor.barycentrics.to_array();
                    off = off.max(place.translation().distance(a * u + b * v + c * w));
                }
            }
            (off, touching.iter().map(|HandOnFace(pairs)| pairs.len()).sum::<usize>())
        };
        let (off, pairs) = app.world_mut().run_system_once(look).unwrap_or_default();
        self.darts_off_by = self.darts_off_by.max(off);
        self.frames_hand_on_face += u32::from(pairs > 0);
        self.most_pairs = self.most_pairs.max(pairs);
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} frames", self.frames)?;
        writeln!(f, "  rays that hit    {} of {}", self.hits, self.rays)?;
        writeln!(f, "  darts off by     {:.1e}", self.darts_off_by)?;
        writeln!(f, "  crates kicked    {}", self.kicks)?;
        writeln!(
            f,
            "  hand on face     in {} frames, up to {} pairs of triangles",
            self.frames_hand_on_face, self.most_pairs
        )?;
        writeln!(f, "  parts of skin    up to {} near crates", self.most_parts)?;
        let Times { median, worst } = self.frame_us;
        write!(f, "  per frame        {median:.0} us median, {worst:.0} us worst")
    }
}
