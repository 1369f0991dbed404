//! Rewrites the table of docs/continuous.md in place: the longest updates of an app in which continuous bodies do their worst.
//!
//! `--help` lists the options; `just continuous-report` runs it.

mod scenes;

use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use clap::Parser;
use morph_collision_testkit::bench::{cpu, median};
use morph_collision_workspace::outcome::exit_code;
use morph_collision_workspace::tables::{Section, TableOptions, rewrite};

use self::scenes::{Scene, scenes};

/// The longest updates with continuous bodies that collapse, blow up or slide over each other.
#[derive(Parser)]
struct Options {
    /// The page to rewrite.
    #[arg(default_value = "docs/continuous.md")]
    page: PathBuf,
    #[command(flatten)]
    tables: TableOptions,
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), String> {
    let rounds = if options.tables.quick { 1 } else { 9 };
    let sections: [Section<'_>; 2] = [
        ("machine", Box::new(|| Ok(format!("{}\n", cpu())))),
        ("worst-updates", Box::new(move || table(rounds))),
    ];
    rewrite(&options.page, &options.tables, &sections)
}

/// The longest update of a scene.
struct Worst {
    milliseconds: f64,
    exact_tests: u64,
    is_limited: bool,
}

fn table(rounds: usize) -> Result<String, String> {
    let mut text =
        "| in one frame, unless it says otherwise | ms | not continuous, ms | exact tests | limit reached |\n\
        |---|--:|--:|--:|---|\n"
            .to_owned();
    for scene in scenes()? {
        let [continuous, discrete] = [true, false].map(|is_continuous| median_of(&scene, is_continuous, rounds));
        let (continuous, discrete) = (continuous?, discrete?);
        let limited = if continuous.is_limited { "yes" } else { "no" };
        writeln!(
            text,
            "| {} | {:.2} | {:.2} | {} | {limited} |",
            scene.name, continuous.milliseconds, discrete.milliseconds, continuous.exact_tests
        )
        .map_err(|error| error.to_string())?;
    }
    Ok(text)
}

/// The median time of some rounds, each in a new app, and the work of the last one.
fn median_of(scene: &Scene, is_continuous: bool, rounds: usize) -> Result<Worst, String> {
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..rounds {
        let worst = worst(scene, is_continuous)?;
        times.push(worst.milliseconds);
        last = Some(worst);
    }
    let last = last.ok_or("no rounds")?;
    Ok(Worst {
        milliseconds: median(times.into_iter()),
        ..last
    })
}

fn worst(scene: &Scene, is_continuous: bool) -> Result<Worst, String> {
    let collider = MorphCollider::default().with_continuous(is_continuous);
    let mut stage = scene.stage(collider)?;
    // Both colliders were compared here, so they have a way from here.
    stage.app.update();
    let mut worst = Worst {
        milliseconds: 0.0,
        exact_tests: 0,
        is_limited: false,
    };
    for frame in 1..=scene.frames {
        scene.step(&mut stage, frame);
        let start = Instant::now();
        stage.app.update();
        worst.milliseconds = worst.milliseconds.max(1e3 * start.elapsed().as_secs_f64());
        let diagnostics = stage.app.world().resource::<MorphCollisionDiagnostics>();
        worst.exact_tests = worst.exact_tests.max(diagnostics.swept_stats.exact_feature_tests);
        worst.is_limited |= diagnostics.limited_pairs > 0;
    }
    Ok(worst)
}
