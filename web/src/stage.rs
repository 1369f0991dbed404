//! Runs a show in a canvas.

use std::path::Path;

use morph_collision_workspace::shows::{self, Inbox, Judged, Verdict};
use morph_collision_workspace::view::Show;
use morph_collision_workspace::view::files::Files;
use morph_collision_workspace::view::page::{self, Hand, State, Told};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// A show, and the channels to it while it runs.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Stage {
    files: Files,
    told: Told,
    hand: Hand,
    inbox: Inbox,
    verdict: Verdict,
}

/// The state that a page receives.
#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    state: State,
    /// The result of checking the user's own model.
    model: Judged,
}

#[wasm_bindgen]
impl Stage {
    /// Creates a stage without files or a show.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file that the show will request by this name.
    pub fn provide(&self, name: &str, bytes: Vec<u8>) {
        self.files.insert(Path::new(name), bytes);
    }

    /// Starts a show in the canvas that this CSS selector finds. Call it once.
    ///
    /// # Errors
    /// Fails if this program has no show with that name.
    pub fn start(&self, name: &str, canvas: &str) -> Result<(), String> {
        let show = self.show(name).ok_or_else(|| format!("there is no example {name:?}"))?;
        page::run(show, canvas, &self.files, self.told.clone(), self.hand.clone());
        Ok(())
    }

    /// Gives all models these weights, or their own ones again.
    pub fn weigh(&self, weights: Option<Vec<f32>>) {
        self.hand.set(weights);
    }

    /// Passes the user's own model to the show: its file name and content.
    pub fn bring(&self, name: String, bytes: Vec<u8>) {
        self.inbox.put(name, bytes);
    }

    /// The current state of the show, as JSON.
    pub fn state(&self) -> String {
        let report = Report {
            state: self.told.now(),
            model: self.verdict.now(),
        };
        // Numbers and plain names always have a JSON form.
        serde_json::to_string(&report).unwrap_or_default()
    }

    #[cfg(feature = "physics")]
    fn show(&self, name: &str) -> Option<Show> {
        Some(match name {
            "character" => shows::character(),
            "physics" => shows::physics(morph_collision_workspace::heaving::Game::default()),
            _ => return None,
        })
    }

    #[cfg(not(feature = "physics"))]
    fn show(&self, name: &str) -> Option<Show> {
        let dolphin = Path::new("dolphin_564.glb");
        Some(match name {
            "dolphins" => shows::dolphins(Path::new("dolphin_2256.glb"), 12, false),
            "pass_through" => shows::pass_through(),
            "face" => shows::face(),
            "picking" => shows::picking(),
            "culling" => shows::culling(),
            "slap" => shows::slap(),
            "crowd" => shows::crowd(dolphin, 125, false),
            "own" => shows::own(self.inbox.clone(), self.verdict.clone()),
            _ => return None,
        })
    }
}
