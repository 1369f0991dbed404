//! A show's time: it begins when everything is loaded, can be paused and stepped, and can run at another
//! speed.

use bevy::prelude::*;
use bevy::time::TimeSystems;
use bevy_morph_collision::import::MorphTrees;

use crate::app::STEP;

/// Marks an entity that is not ready yet. The show waits until there are none.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Pending;

/// Why a show cannot begin: a model cannot be loaded.
#[derive(Resource, Clone, Debug)]
pub struct Trouble(pub String);

/// A show's time, in frames of 1/60 s.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Frames since the show began; fractional if the show does not run at full speed.
    pub frame: f64,
    /// Whether everything is loaded.
    pub started: bool,
    /// Whether to advance by one frame while paused.
    pub step: bool,
    /// Frames run since everything was loaded.
    settled: u32,
}

/// The key that pauses, and its name. Shows that need `Space` for something else use another key.
#[derive(Resource, Clone, Copy, Debug)]
pub struct PauseKey(pub KeyCode, pub &'static str);

impl Default for PauseKey {
    fn default() -> Self {
        Self(KeyCode::Space, "Space")
    }
}

/// Subdivisions of a frame, for shows that do not run at full speed.
pub const FRACTIONS: usize = 256;

impl Clock {
    /// Time since the show began, in units of 1/[`FRACTIONS`] frame.
    #[must_use]
    pub fn fractions(&self) -> usize {
        (self.frame * FRACTIONS as f64).round() as usize
    }
}

/// Frames until trees, bounds and transforms have settled.
const SETTLING: u32 = 4;

/// A run condition: everything is loaded.
pub fn started(clock: Res<Clock>) -> bool {
    clock.started
}

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<Clock>()
        .init_resource::<PauseKey>()
        .init_resource::<Typing>()
        .add_systems(Startup, |mut time: ResMut<Time<Virtual>>| {
            time.pause();
            // If frames take longer, the show slows down instead of leaping.
            time.set_max_delta(2 * STEP);
        })
        .add_systems(First, (start, tick).chain().after(TimeSystems))
        .add_systems(PreUpdate, keys.after(bevy::input::InputSystems));
}

fn start(
    mut clock: ResMut<Clock>,
    mut time: ResMut<Time<Virtual>>,
    pending: Query<(), With<Pending>>,
    trees: Res<MorphTrees>,
) {
    if clock.started {
        return;
    }
    let ready = pending.is_empty() && trees.building() == 0;
    clock.settled = if ready { clock.settled + 1 } else { 0 };
    if clock.settled > SETTLING {
        clock.started = true;
        time.unpause();
    }
}

pub(super) fn tick(mut clock: ResMut<Clock>, mut time: ResMut<Time<Virtual>>, mut generic: ResMut<Time>) {
    if std::mem::take(&mut clock.step) && clock.started && time.is_paused() {
        time.advance_by(STEP);
        *generic = time.as_generic();
    }
    if clock.started {
        clock.frame += time.delta().as_secs_f64() / STEP.as_secs_f64();
    }
}

fn keys(
    keys: Res<ButtonInput<KeyCode>>,
    typing: Res<Typing>,
    pause_key: Res<PauseKey>,
    mut clock: ResMut<Clock>,
    mut time: ResMut<Time<Virtual>>,
) {
    if !clock.started || is_typing(typing) {
        return;
    }
    if keys.just_pressed(pause_key.0) {
        pause(&mut time);
    }
    if keys.just_pressed(KeyCode::Period) {
        clock.step = true;
    }
    for (key, factor) in [(KeyCode::Equal, 2.0), (KeyCode::Minus, 0.5)] {
        if keys.just_pressed(key) {
            let speed = time.relative_speed() * factor;
            time.set_relative_speed(speed.clamp(1.0 / 16.0, 4.0));
        }
    }
}

/// Whether the panel wants the keyboard input. Pages have no panel.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Typing(pub bool);

/// A run condition: the panel wants the keyboard input.
pub fn is_typing(typing: Res<Typing>) -> bool {
    typing.0
}

/// Pauses or resumes.
pub(super) fn pause(time: &mut Time<Virtual>) {
    if time.is_paused() {
        time.unpause();
    } else {
        time.pause();
    }
}
