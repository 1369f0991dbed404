//! The test kit's scenes, answered by this crate.

use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvh, Pose, QueryStats, WorldFromModel};
use morph_collision_testkit::moments;
pub(crate) use morph_collision_testkit::moments::{Moment as Scene, dolphins, generated, pass_through};
use morph_collision_testkit::rivals::{MethodKind, Wanted};

/// All intersecting triangle pairs, found with trees, and the work that took.
pub(crate) fn answer(scene: &Scene, options: &BuildOptions) -> (Vec<[u32; 4]>, QueryStats) {
    scene
        .answer(MethodKind::Morph, &(*options).into(), Wanted::All)
        .unwrap()
}

/// A scene's bodies, posed and placed. Bodies of one mesh share its tree.
pub(crate) fn poses(scene: &Scene, options: &BuildOptions) -> (Vec<Pose>, Vec<WorldFromModel>) {
    let trees: Vec<_> = scene
        .meshes
        .iter()
        .map(|mesh| {
            let model = Arc::new(mesh.to_model().unwrap());
            Arc::new(MorphBvh::build(model, options))
        })
        .collect();
    let pose = |(mesh, weights, _): &(usize, Vec<f32>, _)| {
        let mut pose = Pose::new(trees[*mesh].clone());
        pose.set_weights(weights).unwrap();
        pose
    };
    let place = |(.., place): &(_, _, _)| WorldFromModel::new(*place).unwrap();
    (
        scene.bodies.iter().map(pose).collect(),
        scene.bodies.iter().map(place).collect(),
    )
}

/// Two copies of a mesh from a file, slightly rotated and moved apart. `weights` gives the weights of each.
pub(crate) fn from_file(name: &str, weights: impl Fn(usize, usize) -> f32) -> Option<Scene> {
    moments::from_real_model(name, weights).unwrap()
}
