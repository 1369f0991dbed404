//! Characters that play a clip, each from a different time, in a single-threaded app; and how apps are timed.

use std::path::PathBuf;

use bevy::camera::visibility::{DynamicSkinnedMeshBounds, VisibilityPlugin};
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use morph_collision_testkit::bench::{Stopwatch, median};
use morph_collision_workspace::app::{ready, update_until, without_collisions};
use morph_collision_workspace::crowd::{self, edit_players, root_of};
use morph_collision_workspace::drawn::{self, Part};

use crate::model::{Model, run_on_one_thread};

/// An app with characters.
pub(crate) struct Stage {
    pub(crate) app: App,
    pub(crate) roots: Vec<Entity>,
    /// The skinned primitives of all characters, in the order of their roots.
    pub(crate) parts: Vec<Part>,
    clips: Vec<crowd::NamedClip>,
    file: PathBuf,
}

impl Stage {
    /// Places characters in a single-threaded app; `add` adds plugins to it. Bevy keeps boxes around joints only if it is told
    /// to.
    pub(crate) fn new(
        model: &Model,
        places: &[Transform],
        on_roots: impl Bundle + Clone,
        add: impl FnOnce(&mut App),
    ) -> Result<Self, String> {
        let mut app = without_collisions(model.folder());
        app.add_plugins(VisibilityPlugin);
        add(&mut app);
        ready(&mut app);
        run_on_one_thread(&mut app);
        let (roots, clips) =
            crowd::spawn(&mut app, &model.file, places, on_roots).map_err(|error| error.to_string())?;
        let is_skinned = |part: &Part| model.meshes[part.mesh].skin.is_some();
        let mut parts = drawn::parts::<()>(app.world_mut(), &model.meshes);
        parts.retain(is_skinned);
        parts.sort_by_cached_key(|part| root_of(app.world(), part.entity, &roots));
        let mut stage = Self {
            app,
            roots,
            parts,
            clips,
            file: model.file.clone(),
        };
        stage.settle()?;
        Ok(stage)
    }

    /// Runs frames until every tree is built.
    fn settle(&mut self) -> Result<(), String> {
        self.app.update();
        let is_ready = |world: &mut World| {
            Ok(world
                .get_resource::<MorphTrees>()
                .is_none_or(|trees| trees.building() == 0))
        };
        update_until(&mut self.app, &self.file, is_ready).map_err(|error| error.to_string())?;
        self.app.update();
        self.app.update();
        Ok(())
    }

    pub(crate) fn clip_names(&self) -> Vec<String> {
        self.clips.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Makes every character play a clip in a loop, each from a different time. Returns the clip's length in seconds.
    pub(crate) fn play(&mut self, clip: &str) -> Result<f32, String> {
        let found = self.clips.iter().find(|(name, _)| name == clip);
        let (_, clip) = found.ok_or_else(|| format!("{}: there is no clip {clip:?}", self.file.display()))?;
        let from = |index: usize, length: f32| (0.618_034 * index as f32).fract() * length;
        let length = crowd::play(&mut self.app, clip, &self.roots, from);
        edit_players(&mut self.app, |player| {
            for (_, playing) in player.playing_animations_mut() {
                playing.repeat();
            }
        });
        // The graph is a new asset, and players take a few frames to notice it.
        for _ in 0..4 {
            self.app.update();
        }
        Ok(length)
    }

    /// Turns Bevy's boxes around joints on or off.
    pub(crate) fn set_dynamic_bounds(&mut self, on: bool) {
        for part in &self.parts {
            let mut entity = self.app.world_mut().entity_mut(part.entity);
            if on {
                entity.insert(DynamicSkinnedMeshBounds);
            } else {
                entity.remove::<DynamicSkinnedMeshBounds>();
            }
        }
    }

    /// The vertices of a part as they are drawn.
    pub(crate) fn vertices(&self, model: &Model, part: &Part) -> Vec<DVec3> {
        drawn::vertices(self.app.world(), &model.meshes[part.mesh], part.entity)
    }

    /// The character that a part, or any other descendant of a root, belongs to.
    pub(crate) fn character(&self, entity: Entity) -> Option<usize> {
        root_of(self.app.world(), entity, &self.roots)
    }
}

/// Places on a square grid, `apart` from each other, each turned a little.
pub(crate) fn grid(count: usize, apart: Vec2) -> Vec<Transform> {
    let side = (count as f32).sqrt().ceil() as usize;
    let place = |index: usize| {
        let at = Vec2::new((index % side) as f32, (index / side) as f32) * apart;
        let turn = 0.4 * (1.7 * index as f32).sin();
        Transform::from_xyz(at.x, 0.0, at.y).with_rotation(Quat::from_rotation_y(turn))
    };
    (0..count).map(place).collect()
}

/// Consecutive frames of one app, so that its caches are as warm as in a game of its own.
const TURN: usize = 10;

/// Medians of whole frames of several apps, in microseconds of processor time. The apps take turns.
pub(crate) fn frame_times(stages: &mut [Stage], frames: usize) -> Vec<f64> {
    let mut times = vec![Vec::new(); stages.len()];
    for turn in 0..=frames.div_ceil(TURN) {
        for (stage, times) in stages.iter_mut().zip(&mut times) {
            for frame in 0..TURN {
                let watch = Stopwatch::start();
                stage.app.update();
                // The first turn, and the first frames of each turn, fill caches.
                if turn > 0 && frame >= TURN / 4 {
                    times.push(watch.elapsed().as_secs_f64() * 1e6);
                }
            }
        }
    }
    times.into_iter().map(|times| median(times.into_iter())).collect()
}
