//! Twelve dolphins swim closely together as a group, roll, and touch now and then.
//!
//! This is the second experiment of the paper on which this project is based. It uses what a game would use: the asset server,
//! the glTF loader, Bevy's animation and the collision plugin. With the feature `render` the dolphins are drawn, unless
//! `--headless` asks for numbers. `--help` lists the options.

use std::path::PathBuf;
use std::process::ExitCode;

use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::{Parser, builder::PossibleValuesParser};
use indicatif::{ProgressBar, ProgressStyle};
use morph_collision_workspace::outcome::{exit_code, print, print_report};
use morph_collision_workspace::{
    app,
    error::ExampleError,
    instances::Instances,
    options::ViewOptions,
    report::Report,
    touching::{Changes, TouchingBodies},
};
#[cfg(feature = "render")]
use morph_collision_workspace::{shows, view};

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
    /// Print numbers instead of drawing. Always on without the feature `render`.
    #[arg(long)]
    headless: bool,
    /// Print only the summary, as one JSON object.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    view: ViewOptions,
}

fn main() -> ExitCode {
    let options = Options::parse();
    exit_code(run(&options))
}

fn run(options: &Options) -> Result<(), ExampleError> {
    let (frames, count) = (options.frames as usize, options.count as usize);
    let model = options.model.clone().unwrap_or_else(|| {
        let assets = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/assets"));
        assets.join(format!("dolphin_{}.glb", options.triangles))
    });
    let file = app::locate(&model)?;
    if options.view.is_drawn("dolphins", options.headless || options.json)? {
        #[cfg(feature = "render")]
        return view::run(shows::dolphins(&file, count, options.model.is_some()), &options.view);
    }
    let kind = if options.model.is_some() { "body" } else { "dolphin" };

    let mut app = app::headless(file.parent().unwrap_or(&file));
    // Files that cannot be loaded are reported below, by name.
    app.add_plugins(LogPlugin {
        filter: "error,bevy_asset=off".into(),
        ..LogPlugin::default()
    });
    app::ready(&mut app);
    let instances = Instances::spawn(&mut app, &file, count, options.model.is_some())?;

    let mut report = Report::of(&instances);
    let mut touching = TouchingBodies::default();
    let progress = progress_bar(frames);
    for frame in 0..frames {
        instances.advance(app.world_mut(), frame, frames);
        app.update();

        let changes = touching.follow(app.world());
        report.add(
            app.world().resource::<MorphCollisionDiagnostics>(),
            &changes,
            touching.len(),
        );
        if !options.json && (!changes.started.is_empty() || !changes.ended.is_empty()) {
            progress.suspend(|| print(&describe(frame, &changes, kind, &instances.roots)));
        }
        progress.inc(1);
        progress.set_message(format!("{} touching", touching.len()));
    }
    progress.finish_and_clear();

    report.finish();
    print_report(&report, options.json);
    Ok(())
}

/// A progress bar, if stderr is a terminal.
fn progress_bar(frames: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("frame {pos}/{len} {wide_bar} {per_sec}, {msg}");
    ProgressBar::new(frames as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// One line per pair that started or stopped touching.
fn describe(frame: usize, changes: &Changes, kind: &str, roots: &[Entity]) -> String {
    let number = |body: Entity| roots.iter().position(|&root| root == body).unwrap_or(roots.len());
    let line = |&(a, b): &(Entity, Entity), what: &str| {
        let (a, b) = (number(a).min(number(b)), number(a).max(number(b)));
        format!("frame {frame}  {kind} {a} {what} touching {kind} {b}\n")
    };
    let started = changes.started.iter().map(|pair| line(pair, "started"));
    let ended = changes.ended.iter().map(|pair| line(pair, "stopped"));
    started.chain(ended).collect()
}
