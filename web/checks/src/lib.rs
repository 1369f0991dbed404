//! The API for the scripts of the pages that draw nothing: lint of the user's own model, and a check that answers have the same bits here as
//! elsewhere. It is a small program without Bevy. On targets other than wasm32, this crate is empty.
#![cfg(target_arch = "wasm32")]
// The code that `wasm_bindgen` generates for exports is unsafe. Nothing written here is.
#![allow(unsafe_code)]

pub mod answers;
pub mod lint;
