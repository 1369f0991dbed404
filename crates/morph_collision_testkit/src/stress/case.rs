//! Generates the cases of each family.

use std::ops::RangeInclusive;

use glam::{Affine3A, Mat3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::parts::{blobs, direction, overlapping, rotation, turned, vector, weights};
use super::{Family, geometry, skinned};
use crate::verify::Situation;
use morph_collision_models::generated::{degenerate, random};
use morph_collision_models::mesh::MorphMesh;

/// Two meshes in a situation.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// One mesh per body.
    pub meshes: [MorphMesh; 2],
    /// Their weights and placements.
    pub situation: Situation,
}

impl Case {
    /// Case number `index` of a family; the same seed gives the same case.
    #[must_use]
    pub fn new(family: Family, index: u64, seed: u64) -> Self {
        let mixed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ index.wrapping_mul(0xd1b5_4a32_d192_ed03);
        let rng = &mut Pcg64Mcg::seed_from_u64(mixed ^ (family as u64) << 56);
        match family {
            Family::Ordinary | Family::BadInput => ordinary(rng),
            Family::Scale => {
                let scale = 10.0_f32.powf(rng.random_range(-30.0..=30.0));
                scaled(rng, scale)
            }
            Family::FarOut => far_out(rng),
            Family::LastPlace => geometry::last_place(rng, index),
            Family::Coplanar => geometry::coplanar(rng),
            Family::Slivers => slivers(rng, index),
            Family::ZeroArea => zero_area(rng, index),
            Family::Duplicated => geometry::duplicated(rng),
            Family::LargeWeights => {
                let meshes = blobs(rng, 4);
                let largest = 10.0_f32.powf(rng.random_range(1.0..=6.0));
                weighted(rng, meshes, -largest..=largest)
            }
            Family::ManyTargets => {
                let meshes = blobs(rng, 256);
                weighted(rng, meshes, -0.1..=0.2)
            }
            Family::Cancelling => geometry::cancelling(rng),
            Family::Mirrored => linear(rng, |rng| {
                rotation(rng) * Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0))
            }),
            Family::Sheared => linear(rng, |rng| {
                let [x, y, z] = vector(rng, -3.0..=3.0).to_array();
                rotation(rng) * Mat3::from_cols(Vec3::X, Vec3::new(x, 1.0, 0.0), Vec3::new(y, z, 1.0))
            }),
            Family::Flattened => linear(rng, |rng| {
                let mut scale = Vec3::ONE;
                scale[rng.random_range(0..3_usize)] = 0.0;
                scale[rng.random_range(0..3_usize)] = rng.random_range(0..2_i32) as f32;
                // Half of the cases lie along the world's axes, so that flattened bodies share a
                // plane.
                let turn = if rng.random_bool(0.5) {
                    Mat3::IDENTITY
                } else {
                    rotation(rng)
                };
                turn * Mat3::from_diagonal(scale)
            }),
            Family::NotOrthonormal => linear(rng, geometry::any_columns),
            Family::Denormals => geometry::denormals(rng, index),
            Family::Skinned
            | Family::CollapsedJoints
            | Family::UnnormalisedSkin
            | Family::RandomSkin
            | Family::FarJoints => skinned::case(rng, family, index),
        }
    }
}

fn ordinary(rng: &mut Pcg64Mcg) -> Case {
    let meshes = blobs(rng, 4);
    weighted(rng, meshes, 0.0..=0.4)
}

/// Random weights and rotations, with more or less overlap.
pub(super) fn weighted(rng: &mut Pcg64Mcg, meshes: [MorphMesh; 2], range: RangeInclusive<f32>) -> Case {
    let weights = weights(rng, &meshes, range);
    let situation = Situation {
        weights,
        ..Situation::default()
    };
    turned(rng, meshes, situation)
}

/// Ordinary blobs placed with any linear map.
fn linear(rng: &mut Pcg64Mcg, mut matrix: impl FnMut(&mut Pcg64Mcg) -> Mat3) -> Case {
    let Case { meshes, mut situation } = ordinary(rng);
    situation.places = [0, 1].map(|_| Affine3A::from_mat3(matrix(rng)));
    if rng.random_bool(0.5) {
        situation.places[0] = Affine3A::IDENTITY;
    }
    overlapping(rng, meshes, situation)
}

/// Scales the model by `scale`, and brings the bodies together again.
pub(super) fn scaled(rng: &mut Pcg64Mcg, scale: f32) -> Case {
    let Case { mut meshes, situation } = ordinary(rng);
    for mesh in &mut meshes {
        let vectors = mesh.positions.iter_mut().chain(mesh.targets.iter_mut().flatten());
        vectors.for_each(|vector| *vector *= scale);
    }
    overlapping(rng, meshes, situation)
}

fn far_out(rng: &mut Pcg64Mcg) -> Case {
    let Case { meshes, mut situation } = ordinary(rng);
    let size = situation.sizes([&meshes[0], &meshes[1]]);
    situation.places[0].translation = (direction(rng) * 1e7 * size).as_vec3().into();
    overlapping(rng, meshes, situation)
}

/// Slivers that intersect a blob, or each other.
fn slivers(rng: &mut Pcg64Mcg, index: u64) -> Case {
    let slivers = degenerate::slivers(rng.random(), 60);
    if index.is_multiple_of(2) {
        let [blob, _] = blobs(rng, 1);
        return weighted(rng, [slivers, blob], -1.0..=1.0);
    }
    let weights = vec![rng.random_range(-1.0..=1.0)];
    let place = Affine3A::from_mat3(rotation(rng));
    let meshes = [slivers.clone(), slivers];
    let situation = Situation {
        weights: [weights.clone(), weights],
        places: [place; 2],
        ..Situation::default()
    };
    Case { meshes, situation }
}

fn zero_area(rng: &mut Pcg64Mcg, index: u64) -> Case {
    let degenerate = degenerate::zero_area(rng.random(), 60);
    let other = match index % 3 {
        0 => degenerate::zero_area(rng.random(), 60),
        1 => degenerate::all_equal(20),
        _ => random::triangle_soup(rng.random(), 60, 1),
    };
    let mut case = weighted(rng, [degenerate, other], -1.0..=1.0);
    if rng.random_bool(0.5) {
        // On a common grid, where touching is frequent.
        case.situation = Situation {
            weights: [0, 1].map(|_| vec![rng.random_range(-4..=4_i32) as f32 / 4.0]),
            places: [Affine3A::IDENTITY; 2],
            ..Situation::default()
        };
    }
    case
}
