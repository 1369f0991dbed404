//! The same bits as elsewhere: the determinism test, scene by scene.

use morph_collision_testkit::determinism::{Line, Scene, answer, differences, scenes};
use wasm_bindgen::prelude::*;

/// The test, and how far it is.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Answers {
    scenes: Vec<Scene>,
    lines: Vec<Line>,
}

#[wasm_bindgen]
impl Answers {
    /// Before the first scene.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self {
            scenes: scenes(),
            lines: Vec::new(),
        }
    }

    /// How many scenes there are.
    #[wasm_bindgen(getter)]
    pub fn count(&self) -> usize {
        self.scenes.len()
    }

    /// Asks the next scene's questions of trees with several leaf sizes; returns its line of hashes, or `None` after the last scene.
    ///
    /// # Errors
    /// Two trees, or two sets of instructions, give different answers.
    pub fn next(&mut self) -> Result<Option<String>, String> {
        let Some(scene) = self.scenes.get(self.lines.len()) else {
            return Ok(None);
        };
        let line = answer(scene, &[1])?;
        let text = line.to_string();
        self.lines.push(line);
        Ok(Some(text))
    }

    /// What differs from what is expected everywhere, once all are asked; nothing, one hopes.
    pub fn differences(&self) -> Vec<String> {
        differences(&self.lines)
    }
}

impl Default for Answers {
    fn default() -> Self {
        Self::new()
    }
}
