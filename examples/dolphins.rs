//! Twelve dolphins swim closely together as a group, roll, and touch now and then.
//!
//! This is the second experiment of the paper on which this project is based (its Fig. 7). It uses what a game would use: the asset
//! server, the glTF loader, Bevy's animation and the collision plugin. With the feature `render` the dolphins are drawn, unless
//! `--headless` asks for numbers. `--help` lists the options.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::{Parser, builder::PossibleValuesParser};
#[cfg(feature = "render")]
use morph_collision_models::scenes::dolphins as lanes;
use morph_collision_workspace::app;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::instances::Instances;
use morph_collision_workspace::options::OutputOptions;
use morph_collision_workspace::outcome::{exit_code, print, print_report, progress_bar};
use morph_collision_workspace::report::Report;
use morph_collision_workspace::touching::TouchingBodies;
#[cfg(feature = "render")]
use morph_collision_workspace::view::{self, Demo, clock::*, group::*};

/// Morphing dolphins that swim as a group and touch now and then.
///
/// Prints collisions as they start and end, and a summary of what they cost.
#[derive(Parser)]
struct Options {
    /// Frames to run, at 60 per second.
    #[arg(long, default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Triangles per dolphin.
    #[arg(long, default_value = "564", value_parser = PossibleValuesParser::new(["564", "2256", "9024", "36096"]))]
    triangles: String,
    /// Any glTF or glb file with morph targets, used instead of the dolphins.
    #[arg(long, conflicts_with = "triangles")]
    model: Option<PathBuf>,
    /// Number of swimmers.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    count: u32,
    #[command(flatten)]
    output: OutputOptions,
}

fn main() -> ExitCode {
    let options = Options::parse();
    exit_code(run(&options))
}

fn run(options: &Options) -> Result<(), ExampleError> {
    let (frames, count) = (options.frames as usize, options.count as usize);
    let model = options.model.clone().unwrap_or_else(|| {
        let assets = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
        assets.join(format!("dolphin_{}.glb", options.triangles))
    });
    let file = app::locate(&model)?;
    if options.output.is_drawn("dolphins")? {
        #[cfg(feature = "render")]
        return view::run(demo(&file, count, options.model.is_some()), &options.output.view);
    }
    let kind = if options.model.is_some() { "body" } else { "dolphin" };

    let mut app = app::headless(file.parent().unwrap_or(&file));
    app.add_plugins(app::log());
    app::ready(&mut app);
    let instances = Instances::spawn(&mut app, &file, count, options.model.is_some())?;

    let mut report = Report::of(&instances);
    let mut touching = TouchingBodies::default();
    let progress = progress_bar(frames as u64);
    for frame in 0..frames {
        instances.advance(app.world_mut(), frame, frames);
        app.update();

        let changes = touching.update(app.world());
        report.add(
            app.world().resource::<MorphCollisionDiagnostics>(),
            &changes,
            touching.len(),
        );
        if !options.output.json && (!changes.started.is_empty() || !changes.ended.is_empty()) {
            progress.suspend(|| print(&changes.describe(frame, kind, &instances.roots)));
        }
        progress.inc(1);
        progress.set_message(format!("{} touching", touching.len()));
    }
    progress.finish_and_clear();

    report.finish();
    print_report(&report, options.output.json);
    Ok(())
}

/// Closer together than in the timed scene, so that more contacts can be seen.
#[cfg(feature = "render")]
const CLOSER: Vec3 = Vec3::new(1.0, 0.8, 0.8);

/// `count` instances of the glTF file `model`: an asset's name, or any path. A `foreign` model is not a dolphin.
#[cfg(feature = "render")]
#[must_use]
pub fn demo(model: &Path, count: usize, foreign: bool) -> Demo {
    let group = Group::new(model, count, foreign);
    Demo {
        name: "dolphins",
        about: "Dolphins, morphed by the GPU, swim as a group. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(1.15, 1.1, 2.5),
        target: Vec3::new(0.0, -0.1, 0.0),
        pictures: &[20, 60, 240, 380],
        scene: Box::new(move |app| {
            group.join(app);
            app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin))
                .add_systems(Update, swim.run_if(started));
        }),
    }
}

#[cfg(feature = "render")]
fn swim(mut dolphins: Query<(&Member, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let frames = lanes::FRAMES * FRACTIONS;
    let now = clock.fractions() % frames;
    for (&Member(index), mut place) in &mut dolphins {
        let lane = lanes::placement(index, group.count, now, frames);
        let (_, rotation, translation) = lane.to_scale_rotation_translation();
        // The camera swims along.
        let translation = (translation - Vec3::X * lanes::way(now, frames)) * CLOSER;
        *place = group.place(Transform::from_translation(translation).with_rotation(rotation));
    }
}
