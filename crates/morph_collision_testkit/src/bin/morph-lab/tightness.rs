//! `morph-lab tightness`: how much larger the boxes of skinned models are than the smallest ones in the same spaces, for their clips and
//! for random poses.
//!
//! It compares costs by the surface-area heuristic, as `morph_collision_testkit::tightness` says.
//!
//! - `leaves tight` uses the smallest boxes for leaves on both sides, `all` uses every box as it is.
//! - `/ morph` is the sum over all boxes divided by that of `morph`, whose boxes are in joint spaces. The boxes of `joint-boxes`
//!   are along the world's axes, over a tree of their own with leaves of the same size.
//!
//! With joints that scale unevenly (`Scaled`) it says little, because areas in stretched spaces are compared with areas in the
//! world.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, Pose};
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::generated::rigs::{self, PoseKind};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::find_real_model;
use morph_collision_testkit::rivals::JointNodes;
use morph_collision_testkit::tightness::{self, Tightness};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

const MODELS: [&str; 4] = [
    "mh_character.glb",
    "mh_character_low.glb",
    "RobotExpressive.glb",
    "Fox.glb",
];

/// Frames per clip, and poses per kind.
const FRAMES: usize = 12;

pub(crate) fn tightness() -> Result<Verdict, AnyError> {
    println!(
        "{:24} {:16} {:12} {:>12} {:>8} {:>8}",
        "model", "poses", "method", "leaves tight", "all", "/ morph"
    );
    let mut meshes = Vec::new();
    for model in MODELS {
        match find_real_model(model) {
            Ok(path) => meshes.extend(read_meshes(&path)?.into_iter().filter(|mesh| mesh.skin.is_some())),
            Err(missing) => println!("{model}: skipped: {missing}"),
        }
    }
    meshes.push(rigs::tube(1, 12, 4, 3));
    meshes.push(rigs::branching(2, 24, 4, 3));
    for mesh in &meshes {
        of_mesh(mesh)?;
    }
    Ok(Verdict::Clean)
}

fn of_mesh(mesh: &MorphMesh) -> Result<(), AnyError> {
    let Some(skin) = &mesh.skin else { return Ok(()) };
    let options = BuildOptions::default();
    let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &options)));
    let joint_boxes = JointNodes::new(mesh, &options.into())?;
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut sums: BTreeMap<String, [Tightness; 2]> = BTreeMap::new();
    let mut add = |poses: String, joints: &[Affine3A]| -> Result<(), AnyError> {
        let weights = weights(&mut rng, mesh.targets.len());
        pose.set_joints(&JointMatrices::new(joints)?)?;
        pose.set_weights(&weights)?;
        let corners = tightness::corners(&mut pose);
        let sums = sums.entry(poses).or_default();
        sums[0].add(&tightness::of_pose(&mut pose, &corners));
        sums[1].add(&tightness::of_nodes(&corners, |visitor| {
            joint_boxes.visit(&weights, joints, visitor);
        }));
        Ok(())
    };
    for clip in &skin.skeleton.clips {
        for frame in 0..FRAMES {
            let seconds = clip.duration() * frame as f32 / FRAMES as f32;
            add("clips".to_owned(), &skin.skeleton.world_from_mesh(Some(clip), seconds))?;
        }
    }
    for kind in [PoseKind::Gentle, PoseKind::Turned, PoseKind::Scaled] {
        for seed in 0..FRAMES as u64 {
            add(format!("{kind:?}"), &kind.draw(&skin.skeleton, seed))?;
        }
    }
    for (poses, of_methods) in sums {
        for (method, costs) in ["morph", "joint-boxes"].iter().zip(&of_methods) {
            let (leaves_tight, all) = (costs.ratio_with_tight_leaves(), costs.ratio());
            let ratio = costs.actual / of_methods[0].actual;
            println!(
                "{:24} {poses:16} {method:12} {leaves_tight:12.3} {all:8.3} {ratio:8.3}",
                mesh.name
            );
        }
    }
    Ok(())
}

/// Weights like those of faces: three quarters of the targets active, with a sum of at most 12, and a quarter of them negative.
fn weights(rng: &mut Pcg64Mcg, targets: usize) -> Vec<f32> {
    let mut one = |_| match rng.random_range(0..16) {
        0..4 => 0.0,
        4..7 => rng.random_range(-0.3..0.0),
        _ => rng.random_range(0.0..0.5),
    };
    (0..targets).map(&mut one).collect()
}
