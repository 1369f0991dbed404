//! What a page's script calls: a stage for the drawn examples, and the check that answers are the same bits here as elsewhere.
//!
//! A page makes a `Stage`, gives it the files that the show needs, and starts it; from then on the show runs by itself, and the page asks
//! for its state. For other machines than a browser's, this crate is empty.
#![cfg(target_arch = "wasm32")]
// What `wasm_bindgen` makes of an export is unsafe; nothing written here is.
#![allow(unsafe_code)]

mod answers;
mod stage;
