//! What happens in a frame.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::prelude::Velocity;
use morph_collision_workspace::error::ExampleError;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use crate::actors::{Kind, Way, spawn_body, spawn_shape};
use crate::operations::operate;
use crate::stage::Stage;

/// Frames from one empty stage to the next.
pub(crate) const CYCLE: u64 = 600;
/// The frame of a cycle in which everything is despawned.
const END: u64 = CYCLE - 12;
/// The frame of a cycle after which nothing is left of it: messages are kept for two frames.
pub(crate) const EMPTY: u64 = CYCLE - 1;

/// Bodies below this height have left the ground.
const ABYSS: f32 = -4.0;

pub(crate) struct Game {
    pub(crate) rng: Pcg64Mcg,
    pub(crate) actors: Vec<Actor>,
    /// What is spawned beside the actors: anchors and casters.
    pub(crate) props: Vec<Entity>,
    pub(crate) counts: Actions,
    /// The frame of the cycle in which an asset changes.
    reload_at: u64,
    /// Whether models are also loaded again while they are on the stage.
    reloads_in_play: bool,
}

pub(crate) struct Actor {
    pub(crate) root: Entity,
    pub(crate) kind: Kind,
    way: Way,
    /// Whether it rests where it is.
    pub(crate) is_parked: bool,
}

/// How often the game did what.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Actions {
    pub(crate) spawned: u64,
    pub(crate) reloaded_models: u64,
    pub(crate) replaced_meshes: u64,
    pub(crate) changed_components: u64,
}

impl Game {
    pub(crate) fn new(seed: u64, reloads_in_play: bool) -> Self {
        Self {
            rng: Pcg64Mcg::seed_from_u64(seed),
            actors: Vec::new(),
            props: Vec::new(),
            counts: Actions::default(),
            reload_at: 0,
            reloads_in_play,
        }
    }

    /// The seed of a frame's questions.
    pub(crate) fn question(&mut self) -> u64 {
        self.rng.random()
    }

    /// What happens before a frame of the cycle.
    pub(crate) fn play(&mut self, stage: &mut Stage, frame: u64) -> Result<(), ExampleError> {
        match frame {
            0 => {
                self.reload_at = self.rng.random_range(1..END);
                for kind in [
                    Kind::Hill,
                    Kind::Character,
                    Kind::Dolphin,
                    Kind::Body,
                    Kind::Body,
                    Kind::Shape,
                ] {
                    self.spawn(stage, kind);
                }
            }
            END => self.clear(stage),
            EMPTY if !self.reloads_in_play && self.rng.random_bool(0.1) => self.reload_model(stage)?,
            _ if frame > END => {}
            _ => {
                if self.rng.random_bool(0.15) {
                    operate(self, stage);
                }
                if frame == self.reload_at {
                    self.reload(stage)?;
                }
            }
        }
        self.go_on(stage, frame);
        Ok(())
    }

    /// Another actor, unless there are enough.
    pub(crate) fn spawn(&mut self, stage: &mut Stage, kind: Kind) {
        let there = self.actors.iter().filter(|actor| actor.kind == kind).count();
        if there >= kind.most() {
            return;
        }
        let way = Way::new(kind, &mut self.rng);
        let (at, rotation) = way.at(0.0);
        let root = match kind {
            Kind::Body => spawn_body(stage, &mut self.rng, &way),
            Kind::Shape => spawn_shape(stage, &mut self.rng, &way),
            _ => kind.spawn(stage, Transform::from_translation(at).with_rotation(rotation)),
        };
        self.counts.spawned += 1;
        self.actors.push(Actor {
            root,
            kind,
            way,
            is_parked: false,
        });
    }

    fn clear(&mut self, stage: &mut Stage) {
        let roots = self.actors.drain(..).map(|actor| actor.root);
        for entity in roots.chain(self.props.drain(..)) {
            stage.app.world_mut().despawn(entity);
        }
        stage
            .app
            .world_mut()
            .resource_mut::<MorphCollisionSettings>()
            .max_triangle_pairs = 8192;
    }

    fn reload(&mut self, stage: &mut Stage) -> Result<(), ExampleError> {
        if self.reloads_in_play && self.rng.random_bool(0.3) {
            return self.reload_model(stage);
        }
        self.counts.replaced_meshes += 1;
        stage.reshape(self.rng.random_range(0..20))
    }

    fn reload_model(&mut self, stage: &mut Stage) -> Result<(), ExampleError> {
        self.counts.reloaded_models += 1;
        // The last one is small.
        let model = [0, 1, 2, 2, 2, 2][self.rng.random_range(0..6)];
        stage.reload(model)
    }

    /// Moves what the game moves.
    fn go_on(&mut self, stage: &mut Stage, frame: u64) {
        let world = stage.app.world_mut();
        let seconds = frame as f32 / 60.0;
        for actor in self.actors.iter().filter(|actor| !actor.is_parked) {
            let mut entity = world.entity_mut(actor.root);
            let (at, rotation) = actor.way.at(seconds);
            match actor.kind {
                Kind::Hill => {}
                Kind::Character | Kind::Dolphin | Kind::Blob | Kind::Shape => {
                    if let Some(mut place) = entity.get_mut::<Transform>() {
                        (place.translation, place.rotation) = (at, rotation);
                    }
                }
                Kind::Body => {
                    let has_left = |place: &Transform| place.translation.y < ABYSS;
                    if entity.get::<Transform>().is_some_and(has_left) {
                        let place = Transform::from_translation(at).with_rotation(rotation);
                        entity.insert((place, Velocity::default()));
                    }
                }
            }
            if actor.kind == Kind::Blob
                && let Some(mut weights) = entity.get_mut::<MeshMorphWeights>()
                && let MeshMorphWeights::Value { weights } = &mut *weights
            {
                for weight in weights {
                    *weight = (*weight + self.rng.random_range(-0.05..0.05)).clamp(-0.3, 1.0);
                }
            }
        }
    }
}
