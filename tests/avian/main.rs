//! The plugin together with `avian3d`, in apps without a window.

mod events;
mod frames;
mod life;
#[path = "../plugin/log.rs"]
mod log;
mod moving;
mod presence;
mod queries;
mod scene;
mod skins;
mod solid;
mod support;
mod times;
