//! A demo on a web page: what the page passes in, and what it reports back.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use serde::Serialize;

use super::clock::{Clock, Trouble};
use super::counts;
use super::overlay::Overlay;
use super::sliders::Sliders;
use super::stage::{Notes, Playbill};
use super::volumes;

/// The state of a demo, for the page to display and for tests to check.
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
    /// Whether it is paused.
    pub paused: bool,
    /// How many seconds of the demo pass in a second.
    pub speed: f32,
    /// The level of the bounding volumes that are drawn, if any are.
    pub volumes: Option<usize>,
    /// The names of the targets of the model with the most targets.
    pub targets: Vec<String>,
    /// The weights of these targets.
    pub weights: Vec<f32>,
    /// Whether the page has set the weights.
    pub in_hand: bool,
    /// Whether touching triangles are drawn.
    pub touching_drawn: bool,
    /// What it counts and how long that takes: a name and a value in each line.
    pub counts: Vec<(&'static str, String)>,
    /// Values that the demo itself reports.
    pub notes: Vec<(&'static str, String)>,
    /// Why it cannot begin.
    pub trouble: Option<String>,
}

/// The state of the last frame. Clones share the same state.
#[derive(Resource, Clone, Debug, Default)]
pub struct PageState(Arc<Mutex<State>>);

impl PageState {
    /// A copy of the state.
    #[must_use]
    pub fn now(&self) -> State {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The weights that the page's user has set by hand, if any. Clones share the same weights.
#[derive(Resource, Clone, Debug, Default)]
pub struct Hand(Arc<Mutex<Option<Vec<f32>>>>);

impl Hand {
    /// From the next frame on, all models have these weights, one for each of the state's targets; `None` gives them back their own.
    pub fn set(&self, weights: Option<Vec<f32>>) {
        *self.lock() = weights;
    }

    fn lock(&self) -> MutexGuard<'_, Option<Vec<f32>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Updates the state after every frame, and takes the page's weights before.
pub fn plugin(app: &mut App) {
    app.init_resource::<PageState>()
        .init_resource::<Hand>()
        .add_systems(Update, take)
        .add_systems(Last, update_state);
}

fn take(hand: Res<Hand>, mut sliders: ResMut<Sliders>) {
    let mut weights = hand.lock();
    // Another model has replaced theirs.
    if weights
        .as_ref()
        .is_some_and(|weights| weights.len() != sliders.weights.len())
    {
        *weights = None;
    }
    sliders.in_hand = weights.is_some();
    for (slider, &weight) in sliders.weights.iter_mut().zip(weights.iter().flatten()) {
        slider.1 = weight;
    }
}

fn update_state(
    page_state: Res<PageState>,
    bill: Res<Playbill>,
    clock: Res<Clock>,
    (virtual_time, real): (Res<Time<Virtual>>, Res<Time<Real>>),
    diagnostics: Res<MorphCollisionDiagnostics>,
    overlay: Res<Overlay>,
    store: Res<GizmoConfigStore>,
    sliders: Res<Sliders>,
    notes: Res<Notes>,
    trouble: Option<Res<Trouble>>,
    mut starts: MessageReader<MorphCollisionStart>,
) {
    let mut state = page_state.lock();
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
        paused: virtual_time.is_paused(),
        speed: virtual_time.relative_speed(),
        volumes: volumes::level(&store),
        targets: sliders.weights.iter().map(|(name, _)| name.clone()).collect(),
        weights: sliders.weights.iter().map(|&(_, weight)| weight).collect(),
        in_hand: sliders.in_hand,
        touching_drawn: overlay.shown,
        counts: [counts::work(&diagnostics), counts::times(&diagnostics, &real)].concat(),
        notes: notes.0.clone(),
        trouble: trouble.map(|trouble| trouble.0.clone()),
    };
}

/// Puts a demo into the canvas that this CSS selector finds.
#[cfg(target_arch = "wasm32")]
pub fn run(demo: super::Demo, canvas: &str, files: &super::files::Files, page_state: PageState, hand: Hand) {
    use super::stage::{self, Place};

    let window = Window {
        canvas: Some(canvas.into()),
        fit_canvas_to_parent: true,
        ..default()
    };
    let mut app = stage::app(stage::plugins(Some(window)), files);
    super::types::register(&mut app.world().resource::<AppTypeRegistry>().write());
    stage::set(&mut app, demo, Place::Window);
    app.insert_resource(page_state)
        .insert_resource(hand)
        .add_plugins(plugin);
    app.run();
}
