//! Scenes to judge answers on: those of the test kit, answered by this crate.

use morph_collision::{BuildOptions, QueryStats};
use morph_collision_testkit::moments;
pub(crate) use morph_collision_testkit::moments::{Moment as Scene, dolphins, generated, pass_through};
use morph_collision_testkit::rivals::{MethodKind, Wanted};

/// All intersecting triangle pairs through trees, and what it took.
pub(crate) fn answer(scene: &Scene, options: &BuildOptions) -> (Vec<[u32; 4]>, QueryStats) {
    scene.answer(MethodKind::Morph, options, Wanted::All).unwrap()
}

/// Two copies of a mesh from a file, slightly turned and apart, with given weights each.
pub(crate) fn from_file(name: &str, weights: impl Fn(usize, usize) -> f32) -> Option<Scene> {
    moments::from_shared_model(name, weights).unwrap()
}
