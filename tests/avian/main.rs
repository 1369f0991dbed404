//! The plugin together with `avian3d`, in apps without a window.

mod bullets;
mod characters;
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
mod schedules;
mod skins;
mod solid;
// The report's methods. There are more than these tests use.
#[allow(dead_code)]
#[path = "../../examples/report/avian.rs"]
mod stage;
mod support;
mod times;
mod units;
