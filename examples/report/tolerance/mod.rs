//! How much time a tolerance saves, and how large the error is, as a table and a plot.

mod follower;
mod stage;

use std::collections::BTreeSet;

use morph_collision_testkit::bench::median;
use morph_collision_testkit::report::{Axis, Figure, NOTHING, Panel, Series, Store, Table};
use morph_collision_workspace::outcome::progress_bar;

use follower::{Follower, Now};
use stage::{SCENES, Scene, Stage};

/// Tolerances, in sizes of a body. The others are compared with the first.
const TOLERANCES: [f32; 5] = [0.0, 0.001, 0.0025, 0.005, 0.01];

/// Measurements of a scene at one tolerance.
#[derive(Default)]
struct Row {
    /// Times of the plugin, divided by those without a tolerance in the same frame.
    ratios: Vec<f64>,
    times: Vec<f64>,
    /// Colliders that collisions saw in the state of an earlier frame, and the count of all colliders.
    held: usize,
    colliders: usize,
    /// Pairs that were compared.
    compared: u64,
    /// Sums over all frames: pairs that touch without a tolerance, pairs that were missed, and pairs that were reported
    /// wrongly.
    touching: usize,
    missed: usize,
    false_alarms: usize,
    /// The largest distance of a vertex from where collisions see it, in sizes of a body.
    found: f64,
    /// The mean of the bound divided by the true largest distance, over held colliders and frames.
    looseness: Vec<f64>,
}

/// Measures all scenes and draws the plot.
pub(crate) fn table(quick: bool, store: &Store) -> Result<String, String> {
    let frames = if quick { 20 } else { 180 };
    let mut text = String::new();
    let (mut times, mut errors) = (Vec::new(), Vec::new());
    for scene in &SCENES {
        let rows = measure(scene, frames)?;
        text += &of_scene(scene, &rows, frames);
        let percent = TOLERANCES.map(|tolerance| 100.0 * f64::from(tolerance));
        let points = |of: &dyn Fn(&Row) -> f64| percent.into_iter().zip(rows.iter().map(of)).collect();
        times.push(series(scene.name, points(&|row| median(row.ratios.iter().copied()))));
        errors.push(series(scene.name, points(&|row| 100.0 * row.found)));
    }
    let promised = TOLERANCES.map(|tolerance| 100.0 * f64::from(tolerance));
    errors.push(series(
        "promised",
        promised.map(|promised| (promised, promised)).to_vec(),
    ));
    let axis = |label| Axis { label, log: false };
    let tolerance = axis("tolerance, % of body size");
    let figure = Figure {
        name: "tolerance".into(),
        panels: vec![
            Panel {
                title: "Time of a frame, relative to tolerance 0".into(),
                x: tolerance,
                y: axis("time ratio"),
                series: times,
            },
            Panel {
                title: "Largest displacement found".into(),
                x: tolerance,
                y: axis("% of body size"),
                series: errors,
            },
        ],
    };
    let alt = "Time of a frame, and the largest displacement found, against the tolerance";
    let picture = store.plot(&figure, alt).map_err(|error| error.to_string())?;
    Ok(format!("{text}\n{picture}"))
}

fn series(name: &str, points: Vec<(f64, f64)>) -> Series {
    Series {
        name: name.into(),
        points,
        marked: true,
    }
}

fn measure(scene: &Scene, frames: usize) -> Result<Vec<Row>, String> {
    let bar = progress_bar(2 * frames as u64);
    let stages: Result<Vec<Stage>, String> = TOLERANCES
        .iter()
        .map(|&tolerance| Stage::new(scene, tolerance))
        .collect();
    let mut stages = stages?;
    let mut rows: Vec<Row> = TOLERANCES.iter().map(|_| Row::default()).collect();
    for frame in 0..frames {
        let mut times = vec![0.0; stages.len()];
        // Stages take turns, and each is sometimes the first of its frame.
        for turn in 0..stages.len() {
            let stage = (turn + frame) % stages.len();
            times[stage] = stages[stage].update(scene);
        }
        for (row, &time) in rows.iter_mut().zip(&times) {
            row.ratios.push(time / times[0]);
            row.times.push(time);
        }
        bar.inc(1);
    }
    let mut followers: Vec<Vec<Follower>> = stages.iter().map(|_| Vec::new()).collect();
    for frame in 0..frames {
        let mut exact = BTreeSet::new();
        for (index, (stage, row)) in stages.iter_mut().zip(&mut rows).enumerate() {
            if frame == 0 {
                jump(stage, scene)?;
            } else {
                stage.update(scene);
            }
            let touching = stage.touching();
            if index == 0 {
                exact.clone_from(&touching);
            }
            row.touching += exact.len();
            row.missed += exact.difference(&touching).count();
            row.false_alarms += touching.difference(&exact).count();
            let diagnostics = stage.diagnostics();
            row.compared += diagnostics.candidate_pairs - diagnostics.skipped_unchanged;
            row.look(stage, &mut followers[index], f64::from(TOLERANCES[index]))?;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(rows)
}

/// Makes collisions see every collider in its current state, so that a follower knows where to start.
fn jump(stage: &mut Stage, scene: &Scene) -> Result<(), String> {
    use bevy_morph_collision::prelude::*;
    let edit = |stage: &mut Stage, tolerance: Option<f32>| -> Vec<f32> {
        let mut colliders = stage.app.world_mut().query::<&mut MorphCollider>();
        let set = |mut collider: bevy::prelude::Mut<'_, MorphCollider>| {
            let before = collider.tolerance;
            collider.tolerance = tolerance.unwrap_or(before);
            before
        };
        colliders.iter_mut(stage.app.world_mut()).map(set).collect()
    };
    let before = edit(stage, Some(0.0));
    let first = before.first().copied().ok_or("there are no colliders")?;
    stage.update(scene);
    edit(stage, Some(first));
    // The first frame with a tolerance updates every collider.
    stage.update(scene);
    Ok(())
}

impl Row {
    /// Compares the positions of vertices with where collisions see them.
    fn look(&mut self, stage: &Stage, followers: &mut Vec<Follower>, tolerance: f64) -> Result<(), String> {
        let size = f64::from(stage.size);
        let is_first = followers.is_empty();
        let mut held = 0;
        for (index, part) in stage.parts.iter().enumerate() {
            let now = Now::new(stage.app.world(), part, &stage.meshes);
            let mut now = now.ok_or("a collider has no tree or no place")?;
            if is_first {
                followers.push(Follower::new(&now));
                continue;
            }
            let (moved, bound) = followers[index].update(&mut now, f64::from(tolerance as f32 * stage.size));
            held += usize::from(bound > 0.0);
            self.found = self.found.max(moved / size);
            if moved > 0.0 {
                self.looseness.push(bound / moved);
            }
        }
        self.held += held;
        self.colliders += stage.parts.len();
        let reported = stage.diagnostics().held_colliders as usize;
        // Joint matrices may be rounded differently here.
        if held.abs_diff(reported) > 1 + stage.parts.len() / 50 {
            return Err(format!(
                "{reported} colliders were held, by the rule it should be {held}"
            ));
        }
        Ok(())
    }
}

fn of_scene(scene: &Scene, rows: &[Row], frames: usize) -> String {
    let Scene { name, count, model, .. } = scene;
    let mut table = Table::new([
        "tolerance, promised",
        "found",
        "time",
        "colliders held",
        "pairs compared",
        "bound / true",
        "missed",
        "false",
    ]);
    let all = rows.first().map_or(1, |row| row.compared).max(1) as f64;
    for (row, tolerance) in rows.iter().zip(TOLERANCES) {
        let looseness = match row.looseness.is_empty() {
            true => NOTHING.to_owned(),
            false => format!("{:.2}", median(row.looseness.iter().copied())),
        };
        let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
        table.row([
            format!("{:.2} %", 100.0 * tolerance),
            format!("{:.3} %", 100.0 * row.found),
            format!("{:.2}", median(row.ratios.iter().copied())),
            format!("{:.0} %", share(row.held, row.colliders)),
            format!("{:.0} %", 100.0 * row.compared as f64 / all),
            looseness,
            format!("{:.2} %", share(row.missed, row.touching)),
            format!("{:.2} %", share(row.false_alarms, row.touching)),
        ]);
    }
    format!(
        "\n**{count} {name}** (`{model}`). {frames} frames; a time of 1 is {:.0} us.\n\n{table}",
        rows.first().map_or(0.0, |row| median(row.times.iter().copied()))
    )
}
