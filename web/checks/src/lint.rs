//! Lint of a model in memory.

use std::cell::RefCell;

use morph_collision_cli::lint::{Lint, LintPage};
use morph_collision_cli::{Message, listen};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// An object of the page's script that is told how far the work is.
    pub type Page;

    /// What is being done, the steps that are done, and all steps: 0 if they are not counted.
    #[wasm_bindgen(method)]
    fn progress(this: &Page, what: &str, done: f64, all: f64);

    /// What is left out of the report, and why.
    #[wasm_bindgen(method)]
    fn warning(this: &Page, text: &str);

    /// A bug in this program.
    #[wasm_bindgen(method)]
    fn panicked(this: &Page, text: &str);
}

thread_local! {
    static PAGE: RefCell<Option<Page>> = const { RefCell::new(None) };
}

/// A finished report.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Report(LintPage);

#[wasm_bindgen]
impl Report {
    /// A page that needs no other file.
    #[wasm_bindgen(getter)]
    pub fn html(&self) -> String {
        self.0.html.clone()
    }

    /// The number of findings.
    #[wasm_bindgen(getter)]
    pub fn findings(&self) -> usize {
        self.0.findings
    }

    /// The number of shapes that were tried.
    #[wasm_bindgen(getter)]
    pub fn shapes(&self) -> usize {
        self.0.shapes
    }
}

/// Lints a .glb or .gltf file. `pairs`, `suggest` and `prove` are the options of `morph-collide lint`.
///
/// # Errors
/// Fails with a message that names the file if it cannot be read, has no mesh that can collide, or takes too much memory.
#[wasm_bindgen]
pub fn lint(name: &str, bytes: &[u8], pairs: bool, suggest: bool, prove: bool, page: Page) -> Result<Report, String> {
    PAGE.set(Some(page));
    listen(hear);
    std::panic::set_hook(Box::new(|panic| {
        let text = panic.to_string();
        with_page(|page| page.panicked(&text));
    }));
    let lint = Lint { pairs, suggest, prove };
    lint.page(name, bytes).map(Report)
}

fn hear(told: Message<'_>) {
    with_page(|page| match told {
        Message::Progress { what, steps } => {
            let (done, all) = steps.unwrap_or_default();
            page.progress(what, done as f64, all as f64);
        }
        Message::Warning(text) => page.warning(text),
    });
}

fn with_page(tell: impl FnOnce(&Page)) {
    PAGE.with_borrow(|page| page.as_ref().map(tell));
}
