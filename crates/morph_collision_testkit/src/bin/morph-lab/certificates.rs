//! `morph-lab certificates COUNT MODEL...`: compares self-queries with and without certificates in random expressions.

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use morph_collision::{BuildOptions, MorphBvh, Pose, SelfQuery, TrianglePair};
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::rivals::within::certify;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::verdict;

/// Compare self-queries with and without certificates, in random expressions.
///
/// The weights are from 0 to 1. Joints are left out, because certificates are about targets alone.
#[derive(Debug, Args)]
pub(crate) struct CertificatesArgs {
    /// Number of expressions of each mesh.
    count: u64,
    /// .glb or .gltf files.
    #[arg(required = true)]
    models: Vec<PathBuf>,
}

/// Prints a row per mesh.
pub(crate) fn certificates(CertificatesArgs { count, models }: &CertificatesArgs) -> Result<Verdict, AnyError> {
    let count = *count;
    let mut compared = 0;
    println!(
        "{:36} {:>9} {:>7} {:>11} {:>12} {:>9}",
        "mesh", "triangles", "targets", "expressions", "pairs", "different"
    );
    let mut different = 0;
    for path in models {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        for (index, mesh) in read_meshes(path).map_err(Box::new)?.into_iter().enumerate() {
            if mesh.targets.is_empty() {
                continue;
            }
            let mesh = MorphMesh { skin: None, ..mesh };
            let (pairs, own) = compare(&mesh, count)?;
            let (triangles, targets) = (mesh.triangles.len(), mesh.targets.len());
            println!(
                "{:36} {triangles:9} {targets:7} {count:11} {pairs:12} {own:9}",
                format!("{file}, {index}")
            );
            different += own;
            compared += count;
        }
    }
    if compared == 0 {
        return Err("nothing was compared: no model has a mesh with targets, or COUNT is 0".into());
    }
    Ok(verdict(different == 0))
}

/// How many pairs were found in all expressions, and in how many expressions the answers differ.
fn compare(mesh: &MorphMesh, count: u64) -> Result<(u64, u64), AnyError> {
    let model = Arc::new(mesh.to_model()?);
    let trees = [(); 2].map(|()| Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default())));
    certify(&trees[0])?;
    let mut poses = trees.map(Pose::new);
    let (mut query, mut rng) = (SelfQuery::new(), Pcg64Mcg::seed_from_u64(26));
    let (mut found, mut different) = (0, 0);
    let mut answers: [Vec<TrianglePair>; 2] = Default::default();
    for _ in 0..count {
        let weights = expression(mesh.targets.len(), &mut rng);
        for (pose, pairs) in poses.iter_mut().zip(&mut answers) {
            pose.set_weights(&weights)?;
            pairs.clear();
            query.all(pose, pairs);
            pairs.sort_unstable();
        }
        found += answers[1].len() as u64;
        different += u64::from(answers[0] != answers[1]);
    }
    Ok((found, different))
}

/// Any number of targets, with any weights from 0 to 1 or at the ends.
fn expression(targets: usize, rng: &mut Pcg64Mcg) -> Vec<f32> {
    let (share, is_extreme) = (rng.random_range(0.0..1.0), rng.random_bool(0.25));
    let weight = |_| match rng.random_bool(share) {
        true if is_extreme => 1.0,
        true => rng.random_range(0.0..=1.0),
        false => 0.0,
    };
    (0..targets).map(weight).collect()
}
