//! Surfaces that are animated once a frame, while physics steps at other times.
//!
//! - `steady`: surfaces with steady motion push at their speed, in every step.
//! - `gltf`: the same with an animation player.
//! - `sudden`: jumps, long frames, pauses, teleports.
//! - `pauses`: time that stands still.
//! - `flow`: few steps, many steps, time that is set back.
//! - `teleports`: what the game puts elsewhere.
//! - `walking`: characters.

mod flow;
mod gltf;
mod pauses;
mod steady;
mod sudden;
mod teleports;
mod walking;

use std::path::Path;
use std::time::Duration;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::app::{headless, ready};
use morph_collision_workspace::physics::{body, settle, sheet};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::log::run_here;
use crate::support::spawn;

/// When physics steps.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Steps {
    /// In `FixedUpdate`, this many times a second.
    Fixed(f64),
    /// In `PostUpdate`, 60 times a second, with bodies drawn in between.
    Interpolated,
    /// In `PostUpdate`, one step as long as the frame.
    Variable,
    /// In `PostUpdate`, one step of 1/60 s in each frame, however long the frame is.
    PerFrame,
}

/// The length of frames, in seconds.
#[derive(Clone, Copy, Debug)]
enum Frames {
    Every(f64),
    /// Random lengths between these two.
    Between(f64, f64),
}

/// Those in which steps and frames come at different times.
const STEPS: [Steps; 3] = [Steps::Fixed(64.0), Steps::Fixed(60.0), Steps::Interpolated];
/// Every kind.
const EVERY: [Steps; 4] = [
    Steps::Fixed(64.0),
    Steps::Interpolated,
    Steps::Variable,
    Steps::PerFrame,
];
const FRAMES: [Frames; 7] = [
    Frames::Every(1.0 / 144.0),
    Frames::Every(1.0 / 60.0),
    Frames::Every(1.0 / 50.0),
    Frames::Every(1.0 / 40.0),
    Frames::Every(1.0 / 30.0),
    Frames::Between(1.0 / 144.0, 1.0 / 50.0),
    Frames::Between(1.0 / 144.0, 1.0 / 30.0),
];

/// Some of them.
const LENGTHS: [Frames; 4] = [FRAMES[0], FRAMES[1], FRAMES[4], FRAMES[6]];

/// An app that records what bodies do after every step.
fn app(assets: &Path, steps: Steps) -> App {
    let mut app = headless(assets);
    let rapier = RapierPhysicsPlugin::<NoUserData>::default();
    match steps {
        Steps::Fixed(rate) => {
            let dt = (1.0 / rate) as f32;
            app.add_plugins((rapier.in_fixed_schedule(), MorphRapierPlugin.in_schedule(FixedUpdate)))
                .insert_resource(TimestepMode::Fixed { dt, substeps: 1 })
                .insert_resource(Time::<Fixed>::from_hz(rate))
                .add_systems(FixedUpdate, watch.after(PhysicsSet::Writeback));
        }
        _ => {
            let dt = 1.0 / 60.0;
            let mode = match steps {
                Steps::PerFrame => TimestepMode::Fixed { dt, substeps: 1 },
                Steps::Variable => TimestepMode::Variable {
                    max_dt: 0.1,
                    time_scale: 1.0,
                    substeps: 1,
                },
                _ => TimestepMode::Interpolated {
                    dt,
                    time_scale: 1.0,
                    substeps: 1,
                },
            };
            app.add_plugins((rapier, MorphRapierPlugin))
                .insert_resource(mode)
                .add_systems(PostUpdate, watch.after(PhysicsSet::Writeback));
        }
    }
    app.add_systems(Update, animate.run_if(not(resource_exists::<steady::Stop>)));
    ready(&mut app);
    run_here(&mut app);
    app
}

/// Runs frames.
fn frames(app: &mut App, frames: Frames, count: usize) {
    let mut random = Pcg64::seed_from_u64(3);
    for _ in 0..count {
        let length = match frames {
            Frames::Every(length) => length,
            Frames::Between(low, high) => random.random_range(low..high),
        };
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(length)));
        app.update();
    }
}

/// A sheet, and a body at rest on it that is watched from now on.
fn on_a_sheet(steps: Steps, lengths: Frames, collider: Collider) -> (App, Entity, Entity) {
    let mut app = app(Path::new("."), steps);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, 0.5, 0.05));
    frames(&mut app, lengths, 60);
    begin_to_watch(&mut app, body);
    (app, surface, body)
}

/// Weights over time.
type Weights = fn(f32) -> [f32; 2];

/// The weights of a surface as a function of time, since some moment.
#[derive(Resource)]
struct Animated {
    surface: Entity,
    since: f32,
    weights: Weights,
}

/// Begins to animate a surface; returns the start time.
fn begin(app: &mut App, surface: Entity, weights: Weights) -> f32 {
    let since = now(app);
    app.insert_resource(Animated {
        surface,
        since,
        weights,
    });
    since
}

fn now(app: &App) -> f32 {
    app.world().resource::<Time<Virtual>>().elapsed_secs()
}

fn animate(mut surfaces: Query<&mut MeshMorphWeights>, animated: If<Res<Animated>>, time: Res<Time>) {
    let weights = (animated.weights)(time.elapsed_secs() - animated.since).to_vec();
    if let Ok(mut shown) = surfaces.get_mut(animated.surface) {
        *shown = MeshMorphWeights::Value { weights };
    }
}

/// What a body did: its position and velocity after each step.
#[derive(Resource)]
struct Watched {
    body: Entity,
    steps: Vec<(Vec3, Vec3)>,
}

fn begin_to_watch(app: &mut App, body: Entity) {
    let steps = Vec::new();
    app.insert_resource(Watched { body, steps });
}

fn watch(mut watched: If<ResMut<Watched>>, bodies: Query<(&Transform, &Velocity)>) {
    if let Ok((place, velocity)) = bodies.get(watched.body) {
        watched.steps.push((place.translation, velocity.linear));
    }
}

/// The lowest and the highest of some numbers.
fn range(numbers: impl Iterator<Item = f32>) -> (f32, f32) {
    numbers.fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(x), high.max(x)))
}
