//! A thousand morphing bodies with collision on. Measures a frame while nothing moves, while all move apart from each other, and
//! in a dense crowd.
//!
//! It uses what a game would use: the asset server, the glTF loader, Bevy's animation and the collision plugin. With the feature
//! `render` the crowd is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::fmt;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use morph_collision_workspace::outcome::{exit_code, print_report};
use morph_collision_workspace::{
    app,
    error::ExampleError,
    instances::{Instances, in_crowd},
    options::ViewOptions,
};
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};
use serde::Serialize;

/// Time a crowd of morphing bodies: idle, apart and dense.
#[derive(Parser)]
struct Options {
    /// Number of bodies in the crowd.
    #[arg(long, default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=20_000))]
    instances: u32,
    /// Number of frames to time for each of the three.
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: u32,
    /// Any glTF or glb file with morph targets, used instead of the dolphins.
    #[arg(long)]
    model: Option<PathBuf>,
    /// How far bodies may move before their pairs are compared again, in percent of a body's length.
    #[arg(long, default_value_t = 0.0, value_parser = percentage)]
    tolerance: f32,
    /// Print numbers instead of drawing. Always on without the feature `render`.
    #[arg(long)]
    headless: bool,
    #[command(flatten)]
    view: ViewOptions,
    /// Print only the result, as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Median costs of frames.
#[derive(Serialize)]
struct Report {
    instances: usize,
    /// In world units.
    tolerance: f32,
    idle: Cost,
    apart: Cost,
    dense: Cost,
}

#[derive(Serialize)]
struct Cost {
    /// The whole of `App::update`, in microseconds.
    frame_us: f64,
    /// Only the plugin's systems, in microseconds.
    plugin_us: f64,
    /// Bodies that touch.
    pairs: u64,
    /// Colliders that had moved by no more than the tolerance.
    held: u64,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), ExampleError> {
    let count = options.instances as usize;
    let model = options.model.clone().unwrap_or_else(|| {
        let assets = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
        assets.join("dolphin_564.glb")
    });
    let file = app::locate(&model)?;
    if options.view.is_drawn("crowd", options.headless || options.json)? {
        #[cfg(feature = "render")]
        return view::run(shows::crowd(&file, count, options.model.is_some()), &options.view);
    }
    let mut app = app::headless(file.parent().unwrap_or(&file));
    app.add_plugins(LogPlugin {
        filter: "error,bevy_asset=off".into(),
        ..LogPlugin::default()
    });
    app::ready(&mut app);
    let instances = Instances::spawn(&mut app, &file, count, false)?;
    let tolerance = options.tolerance / 100.0 * instances.length();
    // We only ask whether bodies touch.
    let mut parts = app.world_mut().query::<&mut MorphCollider>();
    for mut collider in parts.iter_mut(app.world_mut()) {
        *collider = MorphCollider::new(MorphCollisionMode::Any).with_tolerance(tolerance);
    }

    let progress = progress_bar(3 * u64::from(options.frames));
    let mut crowd = Crowd {
        app,
        instances,
        frames: options.frames,
        progress,
    };
    let apart = crowd.time(Some(2.0));
    let dense = crowd.time(Some(0.5));
    // The same crowd, standing still.
    crowd.pause_animation();
    let idle = crowd.time(None);
    crowd.progress.finish_and_clear();

    let report = Report {
        instances: count,
        tolerance,
        idle,
        apart,
        dense,
    };
    print_report(&report, options.json);
    Ok(())
}

struct Crowd {
    app: App,
    instances: Instances,
    frames: u32,
    progress: ProgressBar,
}

impl Crowd {
    /// Medians over some frames, after a few warm-up frames. `spacing` is the distance between bodies in body lengths; `None`
    /// leaves them where they are.
    fn time(&mut self, spacing: Option<f32>) -> Cost {
        let [mut frames, mut plugin, mut pairs, mut held] = [const { Vec::new() }; 4];
        for frame in 0..5 + self.frames {
            if let Some(spacing) = spacing {
                self.place(frame, spacing);
            }
            let start = Instant::now();
            self.app.update();
            let took = start.elapsed();
            if frame < 5 {
                continue;
            }
            let diagnostics = self.app.world().resource::<MorphCollisionDiagnostics>();
            frames.push(took.as_secs_f64() * 1e6);
            plugin.push(diagnostics.duration.as_secs_f64() * 1e6);
            pairs.push(diagnostics.touching_pairs as f64);
            held.push(diagnostics.held_colliders as f64);
            self.progress.inc(1);
        }
        Cost {
            frame_us: median(frames),
            plugin_us: median(plugin),
            pairs: median(pairs) as u64,
            held: median(held) as u64,
        }
    }

    /// Places bodies on a cubic grid. Each turns and bobs at its own pace.
    fn place(&mut self, frame: u32, spacing: f32) {
        let roots = &self.instances.roots;
        let step = spacing * self.instances.length();
        for (i, &root) in roots.iter().enumerate() {
            if let Some(mut transform) = self.app.world_mut().get_mut::<Transform>(root) {
                *transform = in_crowd(i, roots.len(), frame as f32 / 60.0, step);
            }
        }
    }

    fn pause_animation(&mut self) {
        let mut players = self.app.world_mut().query::<&mut AnimationPlayer>();
        for mut player in players.iter_mut(self.app.world_mut()) {
            player.pause_all();
        }
    }
}

/// A percentage that is finite and not negative.
fn percentage(text: &str) -> Result<f32, String> {
    let percent: f32 = text.parse().map_err(|error| format!("{error}"))?;
    let is_good = (0.0..1e6).contains(&percent);
    is_good
        .then_some(percent)
        .ok_or_else(|| "it must be from 0 to 1000000".to_owned())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} morphing bodies, tolerance {}; medians per frame",
            self.instances, self.tolerance
        )?;
        writeln!(
            f,
            "{:8} {:>12} {:>12} {:>10} {:>10}",
            "", "frame, us", "plugin, us", "touching", "held"
        )?;
        for (name, cost) in [("idle", &self.idle), ("apart", &self.apart), ("dense", &self.dense)] {
            writeln!(
                f,
                "{name:8} {:12.0} {:12.1} {:10} {:10}",
                cost.frame_us, cost.plugin_us, cost.pairs, cost.held
            )?;
        }
        write!(
            f,
            "idle takes {:.2} % of dense",
            100.0 * self.idle.plugin_us / self.dense.plugin_us
        )
    }
}

/// A progress bar, if stderr is a terminal.
fn progress_bar(frames: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("frame {pos}/{len} {wide_bar} {per_sec}");
    ProgressBar::new(frames).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
