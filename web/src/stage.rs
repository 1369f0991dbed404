//! Runs a demo in a canvas.

use std::path::Path;

use morph_collision_workspace::demos::{self, Inbox, Judged, Verdict};
use morph_collision_workspace::view::Demo;
use morph_collision_workspace::view::files::Files;
use morph_collision_workspace::view::page::{self, Hand, PageState, State};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// A demo, and the channels to it while it runs.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Stage {
    files: Files,
    page_state: PageState,
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
    /// Creates a stage without files or a demo.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file that the demo will request by this name.
    pub fn provide(&self, name: &str, bytes: Vec<u8>) {
        self.files.insert(Path::new(name), bytes);
    }

    /// Starts a demo in the canvas that this CSS selector finds. Call it once.
    ///
    /// # Errors
    /// Fails if this program has no demo with that name.
    pub fn start(&self, name: &str, canvas: &str) -> Result<(), String> {
        let demo = self.demo(name).ok_or_else(|| format!("there is no example {name:?}"))?;
        page::run(demo, canvas, &self.files, self.page_state.clone(), self.hand.clone());
        Ok(())
    }

    /// Gives all models these weights, or their own ones again.
    pub fn weigh(&self, weights: Option<Vec<f32>>) {
        self.hand.set(weights);
    }

    /// Passes the user's own model to the demo: its file name and content.
    pub fn bring(&self, name: String, bytes: Vec<u8>) {
        self.inbox.put(name, bytes);
    }

    /// The current state of the demo, as JSON.
    pub fn state(&self) -> String {
        let report = Report {
            state: self.page_state.now(),
            model: self.verdict.now(),
        };
        // Numbers and plain names always have a JSON form.
        serde_json::to_string(&report).unwrap_or_default()
    }

    #[cfg(feature = "physics")]
    fn demo(&self, name: &str) -> Option<Demo> {
        Some(match name {
            "character" => demos::character(),
            "physics" => demos::physics(morph_collision_workspace::heaving::Game::default()),
            _ => return None,
        })
    }

    #[cfg(not(feature = "physics"))]
    fn demo(&self, name: &str) -> Option<Demo> {
        let dolphin = Path::new("dolphin_564.glb");
        Some(match name {
            "dolphins" => demos::dolphins(Path::new("dolphin_2256.glb"), 12, false),
            "pass_through" => demos::pass_through(),
            "dust" => demos::dust(),
            "face" => demos::face(),
            "picking" => demos::picking(),
            "culling" => demos::culling(),
            "slap" => demos::slap(),
            "crowd" => demos::crowd(dolphin, 125, false),
            "own" => demos::own(self.inbox.clone(), self.verdict.clone()),
            _ => return None,
        })
    }
}
