//! What a frame costs around the queries: crowds that stand still, move apart, touch each other, or play a clip, with and without the
//! plugin.

use bevy::prelude::*;
use bevy_morph_collision::plugins::MorphCollisionPlugin;
use bevy_morph_collision::prelude::*;
use clap::ValueEnum;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_testkit::report::Table;
use morph_collision_workspace::crowd::edit_players;
use morph_collision_workspace::instances::in_crowd;

use super::APART;
use crate::characters::{Stage, grid};
use crate::model::Model;

/// What the crowd does.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum Crowd {
    /// 1,000 dolphins stand still.
    Idle,
    /// 1,000 dolphins move and morph, apart from each other.
    Moving,
    /// 100 dolphins move and morph within each other.
    Dense,
    /// 100 characters play a clip, apart from each other.
    Clip,
}

/// What there is besides Bevy.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(crate) enum With {
    Nothing,
    Collisions,
    /// Collisions, and boxes for culling.
    Bounds,
}

impl Crowd {
    fn count(self) -> usize {
        match self {
            Self::Idle | Self::Moving => 1000,
            Self::Dense | Self::Clip => 100,
        }
    }

    /// The file of the model, its clip, and the distance between two of them in the crowd.
    fn model(self) -> (&'static str, &'static str, f32) {
        match self {
            Self::Idle | Self::Moving => ("dolphin_564.glb", "swim", 5.0),
            Self::Dense => ("dolphin_564.glb", "swim", 0.9),
            Self::Clip => ("mh_character.glb", "walk_and_talk", 0.0),
        }
    }

    fn mode(self) -> MorphCollisionMode {
        match self {
            Self::Dense => MorphCollisionMode::Contacts,
            _ => MorphCollisionMode::First,
        }
    }

    fn places(self, frame: usize) -> Vec<Transform> {
        let (_, _, spacing) = self.model();
        let count = self.count();
        match self {
            Self::Clip => grid(count, APART),
            _ => (0..count)
                .map(|index| in_crowd(index, count, frame as f32 / 60.0, spacing))
                .collect(),
        }
    }

    /// The crowd, ready for its first frame.
    pub(super) fn stage(self, with: With) -> Result<Stage, String> {
        let (file, clip, _) = self.model();
        let model = Model::find(file)?;
        let places = self.places(0);
        let mut stage = if with == With::Nothing {
            Stage::new(&model, &places, (), |_| {})?
        } else {
            let scene = MorphColliderScene {
                collider: MorphCollider::new(self.mode()),
                ..default()
            };
            Stage::new(&model, &places, scene, |app| {
                app.add_plugins(MorphCollisionPlugin);
                if with == With::Bounds {
                    app.add_plugins(MorphBoundsPlugin);
                }
            })?
        };
        stage.play(clip)?;
        if self == Self::Idle {
            edit_players(&mut stage.app, |player| _ = player.stop_all());
        }
        Ok(stage)
    }

    /// Moves the crowd, before a frame.
    fn advance(self, stage: &mut Stage, frame: usize) {
        if let Self::Moving | Self::Dense = self {
            for (place, &root) in self.places(frame).into_iter().zip(&stage.roots) {
                if let Some(mut transform) = stage.app.world_mut().get_mut::<Transform>(root) {
                    *transform = place;
                }
            }
        }
    }
}

/// The frames before those that are counted or timed.
const WARM_UP: usize = 4;
/// The frames that are counted.
pub(super) const COUNTED: usize = 4;

/// Runs a few frames of a crowd, for tools that count instructions in the function `counted_update`.
pub(crate) fn count(crowd: Crowd, with: With) -> Result<(), String> {
    let mut stage = crowd.stage(with)?;
    for frame in 0..WARM_UP + COUNTED {
        crowd.advance(&mut stage, frame);
        if frame < WARM_UP {
            stage.app.update();
        } else {
            counted_update(&mut stage.app);
        }
    }
    if let Some(diagnostics) = stage.app.world().get_resource::<MorphCollisionDiagnostics>() {
        println!(
            "{} colliders, {} pairs compared, {} touch, {} pairs of triangles",
            diagnostics.colliders,
            diagnostics.candidate_pairs - diagnostics.skipped_unchanged,
            diagnostics.touching_pairs,
            diagnostics.triangle_pairs
        );
    }
    Ok(())
}

#[inline(never)]
fn counted_update(app: &mut App) {
    app.update();
}

/// The time of a frame of each crowd. The apps take turns.
pub(super) fn times(quick: bool) -> Result<String, String> {
    let frames = if quick { 20 } else { 180 };
    let mut table = Table::new(["", "Bevy alone, ms", "with collisions, ms", "with bounds, too, ms"]);
    for &crowd in Crowd::value_variants() {
        let ways = With::value_variants().iter();
        let stages: Result<Vec<Stage>, String> = ways.map(|&with| crowd.stage(with)).collect();
        let mut stages = stages?;
        let mut times = vec![Vec::new(); stages.len()];
        for turn in 0..=frames / TURN {
            for (stage, times) in stages.iter_mut().zip(&mut times) {
                for step in 0..TURN {
                    crowd.advance(stage, turn * TURN + step);
                    let watch = Stopwatch::start();
                    stage.app.update();
                    // The first turn, and the first frames of each turn, fill caches.
                    if turn > 0 && step >= TURN / 4 {
                        times.push(watch.elapsed().as_secs_f64() * 1e3);
                    }
                }
            }
        }
        let name = crowd.to_possible_value().map(|value| value.get_name().to_owned());
        let medians = times
            .into_iter()
            .map(|times| format!("{:.3}", median(times.into_iter())));
        table.row(name.into_iter().chain(medians));
    }
    Ok(table.to_string())
}

/// Consecutive frames of one app, so that its caches are as warm as in a game of its own.
const TURN: usize = 10;
