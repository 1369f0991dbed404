//! The API for the pages' scripts: a stage for the drawn examples.
//!
//! It is built twice, because the demos with physics (feature `physics`) need a much larger program.
//!
//! A page creates a `Stage`, gives it the files that the demo needs, and starts it. From then on the demo runs by itself, and the page polls
//! its state. On targets other than wasm32, this crate is empty.
#![cfg(target_arch = "wasm32")]
// The code that `wasm_bindgen` generates for exports is unsafe. Nothing written here is.
#![allow(unsafe_code)]

mod stage;
