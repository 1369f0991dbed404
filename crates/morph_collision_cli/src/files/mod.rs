//! Files that commands read: models, the meshes and clips in them, and scenes.

pub(crate) mod clip_files;
pub(crate) mod clips;
pub(crate) mod drawn;
pub(crate) mod model;
mod warned_clips;
