//! What a crowd of skinned characters costs and how accurate it is, with this plugin, with Bevy's own bounds and picking, and with
//! capsules in Rapier.

mod capsules;
mod culling;
mod picking;
mod stage;
mod touching;

use morph_collision_testkit::report::Section;

pub(crate) use stage::{Stage, frame_times, grid};

/// The sections of the page.
pub(crate) fn sections(quick: bool) -> Vec<Section<'static>> {
    vec![
        ("contact-time", Box::new(move || touching::times(quick))),
        ("contact-answers", Box::new(move || touching::answers(quick))),
        ("picking-time", Box::new(move || picking::times(quick))),
        ("picking-answers", Box::new(move || picking::answers(quick))),
        ("bounds-size", Box::new(move || culling::sizes(quick))),
        ("bounds-turned", Box::new(move || culling::turned(quick))),
        ("bounds-time", Box::new(move || culling::times(quick))),
    ]
}
