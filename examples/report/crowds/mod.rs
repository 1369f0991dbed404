//! What a crowd of skinned characters costs in a frame while nothing happens to most of them.

mod appearing;
mod counts;
mod physics;
mod questions;
mod run;

use bevy::math::Vec2;
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use morph_collision_testkit::report::Section;

/// The distances between characters, in decimetres. Nobody is near another one, whatever the moment of their clip.
const APART: Vec2 = Vec2::new(24.0, 24.0);

pub(crate) use physics::{Way, count};
pub(crate) use run::{Crowd, With, count as count_run};

/// The sections of the page.
pub(crate) fn sections(quick: bool) -> Vec<Section<'static>> {
    // The same on every machine.
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(1).build());
    vec![
        ("run-time", Box::new(move || run::times(quick))),
        ("run-instructions", Box::new(counts::of_runs)),
        ("ray-time", Box::new(move || questions::times(quick))),
        ("physics-time", Box::new(move || physics::times(quick))),
        ("physics-instructions", Box::new(counts::of_physics)),
        ("appearing-time", Box::new(move || appearing::times(quick))),
    ]
}
