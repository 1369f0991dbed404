//! The plugin together with `bevy_rapier3d`, in apps without a window.

#[path = "../../../bevy_morph_physics/tests/any_engine/mod.rs"]
mod any_engine;
mod bad_places;
mod bullets;
mod characters;
#[cfg(feature = "cookbook")]
mod cookbook;
mod dynamic;
mod events;
mod extremes;
mod falls;
mod heaving;
mod life;
#[path = "../../../../tests/plugin/log.rs"]
mod log;
mod many;
mod moving;
mod presence;
mod queries;
mod schedules;
mod shapes;
mod skins;
mod solid;
mod support;
mod times;
mod units;
mod whole;
