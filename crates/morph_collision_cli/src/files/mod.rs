//! Files that commands read: models, the meshes and clips in them, scenes, and text.

pub(crate) mod clip_files;
pub(crate) mod clips;
pub(crate) mod drawn;
pub(crate) mod model;
pub(crate) mod text;
mod warned_clips;
