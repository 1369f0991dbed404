//! The plugin together with `bevy_rapier3d`, in apps without a window.

mod events;
mod life;
mod moving;
mod queries;
mod shapes;
mod support;
