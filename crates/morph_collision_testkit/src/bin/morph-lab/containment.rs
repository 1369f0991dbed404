//! `morph-lab containment [CHECKS]`: looks for vertices outside their blended boxes.

use std::sync::Arc;

use clap::Args;
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, Pose};
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::generated::rigs::{self, PoseKind};
use morph_collision_models::generated::{dolphin, pass_through_body, random};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::verify::{ContainmentViolation, check_containment, check_skinned_containment};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::verdict;

/// Look for vertices outside their blended boxes, with random weights of any size and sign, and joints in every kind of pose.
#[derive(Debug, Args)]
pub(crate) struct ContainmentArgs {
    /// Number of checks of one position and one box, per kind of tree.
    #[arg(default_value_t = 10_000_000)]
    checks: u64,
}

/// Prints a row per leaf size.
pub(crate) fn containment(args: &ContainmentArgs) -> Result<Verdict, AnyError> {
    println!("{:12} {:>12} {:>10}", "leaf size", "checks", "outside");
    let mut outside = 0;
    for leaf_size in [8, 1] {
        let options = BuildOptions::default().with_leaf_size(leaf_size)?;
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut bodies = Vec::new();
        for mesh in meshes() {
            let bvh = MorphBvh::build(Arc::new(mesh.to_model()?), &options);
            bodies.push((mesh, Pose::new(Arc::new(bvh))));
        }
        let (mut done, mut violations, mut first) = (0, 0, None);
        while done < args.checks {
            for (mesh, pose) in &mut bodies {
                // What depends on weights alone stays cached if only joints change.
                if mesh.skin.is_none() || rng.random_bool(0.5) {
                    pose.set_weights(&weights(&mut rng, mesh.targets.len()))?;
                }
                let report = match &mesh.skin {
                    None => check_containment(mesh, pose),
                    Some(skin) => {
                        let kind = PoseKind::ALL[rng.random_range(0..PoseKind::ALL.len())];
                        let joints = kind.draw(&skin.skeleton, rng.random());
                        pose.set_joints(&JointMatrices::new(&joints)?)?;
                        check_skinned_containment(mesh, &joints, pose)
                    }
                };
                done += report.checks;
                violations += report.violations;
                first = first.or(report.first.map(|violation| describe(&mesh.name, pose, &violation)));
            }
        }
        println!("{leaf_size:<12} {done:12} {violations:10}");
        if let Some(first) = first {
            println!("             {first}");
        }
        outside += violations;
    }
    Ok(verdict(outside == 0))
}

fn meshes() -> [MorphMesh; 9] {
    let pieces = rigs::rigid_pieces(9, 10, 4);
    [
        dolphin(0),
        pass_through_body(),
        random::random_blob(5, 3, 12, 0.7),
        random::triangle_soup(6, 300, 5),
        rigs::branching(7, 20, 8, 5),
        rigs::random_soup(8, 300, 40, 3, 2),
        rigs::unnormalised(&pieces, 1),
        rigs::nearly_normalised(&pieces, 2),
        pieces,
    ]
}

/// One-hot, convex, signed, large or huge weights, or one weight among tiny ones as exporters leave them.
fn weights(rng: &mut Pcg64Mcg, targets: usize) -> Vec<f32> {
    let mut weights = vec![0.0; targets];
    match rng.random_range(0..6) {
        0 => weights[rng.random_range(0..targets)] = 1.0,
        1 => {
            weights.fill_with(|| rng.random_range(0.0..1.0));
            let sum: f32 = weights.iter().sum();
            weights.iter_mut().for_each(|w| *w /= sum);
        }
        2 => weights.fill_with(|| rng.random_range(-1.0..1.0)),
        3 => weights.fill_with(|| rng.random_range(0.0..4.0)),
        4 => weights.fill_with(|| rng.random_range(-1e6..1e6)),
        _ => {
            weights.fill_with(|| rng.random_range(-1e-7..1e-7));
            weights[rng.random_range(0..targets)] = rng.random_range(0.0..1.0);
        }
    }
    weights
}

fn describe(name: &str, pose: &Pose, violation: &ContainmentViolation) -> String {
    format!(
        "{name}: vertex {} at {} outside its box at depth {}, weights {:?}",
        violation.vertex,
        violation.position,
        violation.depth,
        pose.weights()
    )
}
