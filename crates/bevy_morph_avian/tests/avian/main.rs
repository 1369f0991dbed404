//! The plugin together with `avian3d`, in apps without a window.

// The app and the scenes of the examples, without those for Rapier. There is more than these tests use.
#[allow(dead_code, unreachable_pub)]
#[path = "../../../../examples/support/app.rs"]
mod app;
#[allow(dead_code, unreachable_pub)]
#[path = "../../../../examples/support/error.rs"]
mod error;
#[allow(dead_code, unreachable_pub)]
#[path = "../../../../examples/support/physics/scenes/mod.rs"]
mod physics;

extern crate self as morph_collision_workspace;

#[path = "../../../bevy_morph_physics/tests/any_engine/mod.rs"]
mod any_engine;
mod characters;
mod collisions;
#[cfg(feature = "cookbook")]
mod cookbook;
mod events;
mod frames;
mod life;
#[path = "../../../../tests/plugin/log.rs"]
mod log;
mod moving;
mod presence;
mod queries;
mod scene;
mod skins;
mod solid;
// The report's methods. There are more than these tests use.
#[allow(dead_code)]
#[path = "../../../../examples/report/avian.rs"]
mod stage;
mod support;
mod times;
#[cfg(feature = "tnua")]
mod tnua;
mod units;
