//! The unchanged programs. Their `main` opens a window and is not called.
#![allow(dead_code, reason = "`main` is not called here")]

#[path = "../../../crates/bevy_morph_collision/examples/boss_armour.rs"]
pub(crate) mod boss_armour;
#[path = "../../../crates/bevy_morph_collision/examples/face_zones.rs"]
pub(crate) mod face_zones;
#[path = "../../../crates/bevy_morph_collision/examples/hat.rs"]
pub(crate) mod hat;
#[path = "../../../crates/bevy_morph_collision/examples/loading_screen.rs"]
pub(crate) mod loading_screen;
#[path = "../../../crates/bevy_morph_collision/examples/mouth_trigger.rs"]
pub(crate) mod mouth_trigger;
