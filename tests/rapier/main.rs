//! The plugin together with `bevy_rapier3d`, in apps without a window.

mod moving;
mod support;
