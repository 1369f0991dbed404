//! What a crowd of skinned characters costs in a frame while nothing happens to most of them.

mod physics;

use morph_collision_testkit::report::Section;

pub(crate) use physics::{Way, count};

/// The sections of the page.
pub(crate) fn sections(quick: bool) -> Vec<Section<'static>> {
    vec![("physics-time", Box::new(move || physics::times(quick)))]
}
