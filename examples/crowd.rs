//! A thousand morphing bodies with collision on. Measures a frame while nothing moves, while all move apart from each other, and
//! in a dense crowd.
//!
//! With the feature `render` the crowd is drawn, unless `--headless` asks for numbers. `--help` lists the options.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use indicatif::ProgressBar;
use morph_collision_workspace::app;
use morph_collision_workspace::costs::{Cost, Costs, Report};
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::instances::{Instances, in_crowd};
use morph_collision_workspace::options::{OutputOptions, percentage};
use morph_collision_workspace::outcome::{exit_code, print_report, progress_bar};
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo, clock::Clock, clock::started, group::Group, group::Member};

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
    #[command(flatten)]
    output: OutputOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), ExampleError> {
    let count = options.instances as usize;
    let dolphin = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/dolphin_564.glb");
    let file = app::locate(options.model.as_deref().unwrap_or(Path::new(dolphin)))?;
    if options.output.is_drawn("crowd")? {
        #[cfg(feature = "render")]
        return view::run(demo(&file, count, options.model.is_some()), &options.output.view);
    }
    // It has the collision plugin. Each instance gets a `MorphColliderScene`.
    let mut app = app::headless(file.parent().unwrap_or(&file));
    app.add_plugins(app::log());
    app::ready(&mut app);
    let instances = Instances::spawn(&mut app, &file, count, false)?;
    let tolerance = options.tolerance / 100.0 * instances.length();
    // We only ask whether bodies touch.
    let mut parts = app.world_mut().query::<&mut MorphCollider>();
    for mut collider in parts.iter_mut(app.world_mut()) {
        *collider = MorphCollider::new(MorphCollisionMode::First).with_tolerance(tolerance);
    }

    let progress = progress_bar(3 * u64::from(options.frames));
    let time = |app: &mut App, spacing| time(app, &instances, options.frames, spacing, &progress);
    let apart = time(&mut app, Some(2.0));
    let dense = time(&mut app, Some(0.5));
    // The same crowd, standing still.
    let mut players = app.world_mut().query::<&mut AnimationPlayer>();
    for mut player in players.iter_mut(app.world_mut()) {
        player.pause_all();
    }
    let idle = time(&mut app, None);
    progress.finish_and_clear();

    let report = Report {
        instances: count,
        tolerance,
        idle,
        apart,
        dense,
    };
    print_report(&report, options.output.json);
    Ok(())
}

/// Medians over some frames, after a few warm-up frames. `spacing` is the distance between bodies in body lengths; `None` leaves
/// them where they are.
fn time(app: &mut App, instances: &Instances, frames: u32, spacing: Option<f32>, progress: &ProgressBar) -> Cost {
    let mut costs = Costs::default();
    for frame in 0..5 + frames {
        for (index, &root) in instances.roots.iter().enumerate() {
            if let Some(spacing) = spacing
                && let Some(mut place) = app.world_mut().get_mut::<Transform>(root)
            {
                let step = spacing * instances.length();
                *place = in_crowd(index, instances.roots.len(), frame as f32 / 60.0, step);
            }
        }
        let start = Instant::now();
        app.update();
        let took = start.elapsed();
        if frame >= 5 {
            costs.add(took, app.world().resource::<MorphCollisionDiagnostics>());
            progress.inc(1);
        }
    }
    costs.medians()
}

/// `count` instances of the glTF file `model`: an asset's name, or any path. A `foreign` model is not a dolphin.
#[cfg(feature = "render")]
#[must_use]
pub fn demo(model: &Path, count: usize, foreign: bool) -> Demo {
    let group = Group::new(model, count, foreign);
    let side = (count as f32).cbrt().ceil();
    Demo {
        name: "crowd",
        about: "Everyone may touch everyone; only those near each other are compared.",
        keys: &[],
        eye: Vec3::new(0.9, 0.7, 1.2) * side.max(1.0),
        target: Vec3::ZERO,
        pictures: &[0, 60],
        scene: Box::new(move |app| {
            group.join(app);
            app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin))
                .add_systems(Update, mill.run_if(started));
        }),
    }
}

#[cfg(feature = "render")]
fn mill(mut members: Query<(&Member, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let middle = 0.5 * ((group.count as f32).cbrt().ceil() - 1.0);
    for (&Member(index), mut place) in &mut members {
        // Half a dolphin apart.
        let mut dolphin = in_crowd(index, group.count, clock.frame as f32 / 60.0, 1.0);
        dolphin.translation -= middle;
        *place = group.place(dolphin);
    }
}
