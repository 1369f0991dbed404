//! A show on a web page: what the page passes in, and what it reports back.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use serde::Serialize;

use super::clock::{Clock, Trouble};
use super::overlay::Overlay;
use super::sliders::Sliders;
use super::stage::{Notes, Playbill};

/// The state of a show, for the page to display and for tests to check.
#[derive(Clone, Debug, Default, Serialize)]
pub struct State {
    /// Its name.
    pub show: &'static str,
    /// Whether everything is loaded.
    pub started: bool,
    /// Its time, in 1/60 s.
    pub frame: f64,
    /// Frames drawn since it was put on the page.
    pub drawn: u64,
    /// Number of colliders.
    pub colliders: u64,
    /// Pairs of colliders that touch.
    pub touching: u64,
    /// Pairs of triangles that touch.
    pub triangle_pairs: u64,
    /// Number of red triangles.
    pub red: usize,
    /// How often two colliders started touching.
    pub events: u64,
    /// Time that the plugin took in this frame, in milliseconds.
    pub collision_ms: f64,
    /// The weights that the sliders show: those of the model with the most weights.
    pub weights: Vec<f32>,
    /// Values that the show itself reports.
    pub notes: Vec<(&'static str, String)>,
    /// Why it cannot begin.
    pub trouble: Option<String>,
}

/// The state of the last frame. Clones share the same state.
#[derive(Resource, Clone, Debug, Default)]
pub struct Told(Arc<Mutex<State>>);

impl Told {
    /// A copy of the state.
    #[must_use]
    pub fn now(&self) -> State {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Updates the state after every frame.
pub fn plugin(app: &mut App) {
    app.init_resource::<Told>().add_systems(Last, tell);
}

fn tell(
    told: Res<Told>,
    bill: Res<Playbill>,
    clock: Res<Clock>,
    diagnostics: Res<MorphCollisionDiagnostics>,
    overlay: Res<Overlay>,
    sliders: Res<Sliders>,
    notes: Res<Notes>,
    trouble: Option<Res<Trouble>>,
    mut starts: MessageReader<MorphCollisionStart>,
) {
    let mut state = told.lock();
    *state = State {
        show: bill.name,
        started: clock.started,
        frame: clock.frame,
        drawn: state.drawn + 1,
        colliders: diagnostics.colliders,
        touching: diagnostics.touching_pairs,
        triangle_pairs: diagnostics.triangle_pairs,
        red: overlay.triangles,
        events: state.events + starts.read().count() as u64,
        collision_ms: diagnostics.duration.as_secs_f64() * 1e3,
        weights: sliders.weights.iter().map(|&(_, weight)| weight).collect(),
        notes: notes.0.clone(),
        trouble: trouble.map(|trouble| trouble.0.clone()),
    };
}

/// Puts a show into the canvas that this CSS selector finds.
#[cfg(target_arch = "wasm32")]
pub fn run(show: super::Show, canvas: &str, files: &super::files::Files, told: Told) {
    use super::stage::{self, Place};

    let window = Window {
        canvas: Some(canvas.into()),
        fit_canvas_to_parent: true,
        ..default()
    };
    let mut app = stage::app(stage::plugins(Some(window)), files);
    stage::set(&mut app, show, Place::Window);
    app.insert_resource(told).add_plugins(plugin);
    app.run();
}
