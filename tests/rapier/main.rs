//! The plugin together with `bevy_rapier3d`, in apps without a window.

mod bad_places;
mod bullets;
mod characters;
#[cfg(feature = "render")]
mod cookbook;
mod dynamic;
mod events;
mod extremes;
mod falls;
mod heaving;
mod life;
#[path = "../plugin/log.rs"]
mod log;
mod many;
mod mistakes;
mod moving;
mod presence;
mod queries;
mod scene;
mod schedules;
mod shapes;
mod skins;
mod solid;
mod support;
mod times;
mod units;
mod whole;
