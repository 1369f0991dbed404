//! The parts of cases of all families: meshes, weights and placements.

use std::ops::RangeInclusive;

use glam::{Affine3A, DVec3, Mat3, Quat, Vec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::Case;
use crate::verify::Situation;
use morph_collision_models::generated::random;
use morph_collision_models::mesh::MorphMesh;

/// Two blobs of 80 triangles.
pub(super) fn blobs(rng: &mut Pcg64Mcg, targets: usize) -> [MorphMesh; 2] {
    [0, 1].map(|_| random::random_blob(rng.random(), 1, targets, 0.5))
}

/// A random weight for each target of both meshes.
pub(super) fn weights(rng: &mut Pcg64Mcg, meshes: &[MorphMesh; 2], range: RangeInclusive<f32>) -> [Vec<f32>; 2] {
    let weights = |mesh: &MorphMesh| mesh.targets.iter().map(|_| rng.random_range(range.clone())).collect();
    meshes.each_ref().map(weights)
}

/// Rotates both bodies at random and brings them together. Their previous placements do not matter.
pub(super) fn turned(rng: &mut Pcg64Mcg, meshes: [MorphMesh; 2], mut situation: Situation) -> Case {
    situation.places = [0, 1].map(|_| Affine3A::from_mat3(rotation(rng)));
    overlapping(rng, meshes, situation)
}

/// Moves the second body to a place in the first or near it.
pub(super) fn overlapping(rng: &mut Pcg64Mcg, meshes: [MorphMesh; 2], mut situation: Situation) -> Case {
    let apart = direction(rng) * rng.random_range(0.0..0.7);
    situation.bring_together([&meshes[0], &meshes[1]], apart);
    Case { meshes, situation }
}

/// Any rotation.
pub(super) fn rotation(rng: &mut Pcg64Mcg) -> Mat3 {
    let [x, y, z] = vector(rng, -3.2..=3.2).to_array();
    Mat3::from_quat(Quat::from_rotation_x(x) * Quat::from_rotation_y(y) * Quat::from_rotation_z(z))
}

/// A vector of length 1.
pub(super) fn direction(rng: &mut Pcg64Mcg) -> DVec3 {
    vector(rng, -1.0..=1.0).as_dvec3().normalize_or(DVec3::X)
}

/// A vector with coordinates in a range.
pub(super) fn vector(rng: &mut Pcg64Mcg, range: RangeInclusive<f32>) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| rng.random_range(range.clone())))
}
