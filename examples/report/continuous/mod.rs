//! The longest updates of an app in which continuous bodies do their worst.

mod scenes;

use std::time::Instant;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::bench::median;
use morph_collision_testkit::report::Table;

use scenes::{Scene, scenes};

/// The longest update of a scene.
struct Worst {
    milliseconds: f64,
    exact_tests: u64,
    is_limited: bool,
}

/// The table of all scenes.
pub(crate) fn table(quick: bool) -> Result<String, String> {
    let rounds = if quick { 1 } else { 9 };
    let mut table = Table::new([
        "in one frame, unless it says otherwise",
        "ms",
        "not continuous, ms",
        "exact tests",
        "limit reached",
    ]);
    for scene in scenes()? {
        let [continuous, discrete] = [true, false].map(|is_continuous| median_of(&scene, is_continuous, rounds));
        let (continuous, discrete) = (continuous?, discrete?);
        table.row([
            scene.name,
            format!("{:.2}", continuous.milliseconds),
            format!("{:.2}", discrete.milliseconds),
            continuous.exact_tests.to_string(),
            if continuous.is_limited { "yes" } else { "no" }.to_owned(),
        ]);
    }
    Ok(table.to_string())
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
