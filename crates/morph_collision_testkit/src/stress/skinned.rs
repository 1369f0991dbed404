//! Families of skinned meshes.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::parts::{turned, weights};
use super::{Case, Family};
use crate::verify::Situation;
use morph_collision_models::generated::rigs::{PoseKind, branching, random_soup, rigid_pieces, tube, unnormalised};
use morph_collision_models::mesh::MorphMesh;

/// Two skinned meshes, weights of any sign, and joints according to the family.
pub(super) fn case(rng: &mut Pcg64Mcg, family: Family, index: u64) -> Case {
    let meshes = [0, 1].map(|_| mesh(rng, family, index));
    let kinds: &[PoseKind] = match family {
        Family::CollapsedJoints => &[PoseKind::Collapsed, PoseKind::Scaled, PoseKind::OnePoint],
        Family::FarJoints => &[PoseKind::Far, PoseKind::VeryFar],
        _ => &[
            PoseKind::Gentle,
            PoseKind::Turned,
            PoseKind::Scaled,
            PoseKind::Sheared,
            PoseKind::Mirrored,
            PoseKind::Mixed,
        ],
    };
    let joints = [0, 1].map(|body: usize| {
        let kind = kinds[rng.random_range(0..kinds.len())].of_body(body);
        let skeleton = meshes[body].skin.as_ref().map(|skin| &skin.skeleton);
        skeleton.map_or(Vec::new(), |skeleton| kind.draw(skeleton, rng.random()))
    });
    let situation = Situation {
        weights: weights(rng, &meshes, -1.0..=1.0),
        joints,
        ..Situation::default()
    };
    turned(rng, meshes, situation)
}

fn mesh(rng: &mut Pcg64Mcg, family: Family, index: u64) -> MorphMesh {
    let seed = rng.random();
    match family {
        Family::RandomSkin => {
            let joints = [1, 3, 20, 256][rng.random_range(0..4_usize)];
            random_soup(seed, 80, joints, 2, 1 + (index % 2) as usize)
        }
        Family::UnnormalisedSkin => unnormalised(&body(rng, seed, index), seed),
        _ => body(rng, seed, index),
    }
}

fn body(rng: &mut Pcg64Mcg, seed: u64, index: u64) -> MorphMesh {
    let influences = rng.random_range(1..=8);
    match index % 3 {
        0 => tube(seed, rng.random_range(2..8), influences, 3),
        1 => branching(seed, rng.random_range(2..6), influences, 3),
        _ => rigid_pieces(seed, rng.random_range(1..12), 2),
    }
}
