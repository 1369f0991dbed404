//! The plugin together with `bevy_rapier3d`, in apps without a window.

mod bad_places;
mod events;
mod extremes;
mod life;
#[path = "../plugin/log.rs"]
mod log;
mod moving;
mod presence;
mod queries;
mod shapes;
mod skins;
mod support;
