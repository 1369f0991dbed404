//! The determinism test, scene by scene: answers have the same bits here as elsewhere.

use morph_collision_testkit::determinism::{Line, Scene, answer, differences, scenes};
use wasm_bindgen::prelude::*;

/// The determinism test and its progress.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Answers {
    scenes: Vec<Scene>,
    lines: Vec<Line>,
}

#[wasm_bindgen]
impl Answers {
    /// Starts the test before its first scene.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self {
            scenes: scenes(),
            lines: Vec::new(),
        }
    }

    /// The number of scenes.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.scenes.len()
    }

    /// Runs the next scene's queries for several leaf sizes. Returns the scene's line of hashes, or `None` after the last scene.
    ///
    /// # Errors
    /// Fails if two trees, or two sets of instructions, give different answers.
    pub fn next(&mut self) -> Result<Option<String>, String> {
        let Some(scene) = self.scenes.get(self.lines.len()) else {
            return Ok(None);
        };
        let line = answer(scene, &[1])?;
        let text = line.to_string();
        self.lines.push(line);
        Ok(Some(text))
    }

    /// The differences from the expected hashes, once all scenes have run. Empty if the test passes.
    pub fn differences(&self) -> Vec<String> {
        differences(&self.lines)
    }
}

impl Default for Answers {
    fn default() -> Self {
        Self::new()
    }
}
