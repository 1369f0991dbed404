//! The plugin together with `avian3d`, in apps without a window.

#[cfg(feature = "render")]
mod cookbook;
mod events;
mod frames;
mod life;
#[path = "../plugin/log.rs"]
mod log;
mod mistakes;
mod moving;
mod presence;
mod queries;
mod scene;
mod skins;
mod solid;
mod support;
