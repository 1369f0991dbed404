//! The trees of a model's meshes, as `bevy_morph_collision` reads these from Bevy: one primitive, its vertices as Bevy stores them, and the
//! first four influences of each.

use std::sync::Arc;

use glam::Vec3;
use morph_collision::proof::{Effort, ProofOutcome, SelfProof, WeightBox};
use morph_collision::{BuildOptions, InputError, MorphBvh, SavedTree, TreeFile};
use morph_collision_models::gltf::read::{GltfFile, Part};
use morph_collision_models::inspect::MeshError;
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::Skeleton;
use serde::Serialize;

use crate::messages::progress;

/// What is baked, and how.
#[derive(Clone, Copy, Debug, Default)]
pub struct BakeOptions {
    /// Bakes meshes that nothing deforms, too.
    pub rigid: bool,
    /// Proves which triangles never touch for weights from 0 to 1.
    pub certificates: bool,
    /// How trees are built.
    pub tree: BuildOptions,
}

/// The trees of a model.
#[derive(Debug, Default)]
pub struct Trees {
    /// The file to write.
    pub file: TreeFile,
    /// What is in it, in the same order.
    pub baked: Vec<Baked>,
    /// Primitives without a tree. Those that nothing deforms are not among them.
    pub not_baked: Vec<NotBaked>,
}

/// What a tree is of.
#[derive(Debug, Serialize)]
pub struct Baked {
    /// The primitive, as in `Mesh0/Primitive1`.
    pub label: String,
    /// The name of its mesh.
    pub mesh: String,
    /// The number of joints of its skeletons, if any.
    pub joints: Option<u32>,
    /// The number of its triangles.
    pub triangles: usize,
    /// The number of its targets.
    pub targets: usize,
    /// Whether it has certificates.
    pub certificates: bool,
}

/// A primitive without a tree.
#[derive(Debug, Serialize)]
pub struct NotBaked {
    /// The primitive.
    pub label: String,
    /// Why it has none.
    pub reason: String,
}

impl Trees {
    /// Builds them. Rigid meshes, points and lines are passed over.
    #[must_use]
    pub fn bake(file: &GltfFile, options: &BakeOptions) -> Self {
        let mut found = Self::default();
        for mesh in 0..file.mesh_count() {
            for part in 0..file.part_count(mesh) {
                file.budget().lend(|| bake_part(options, file, mesh, part, &mut found));
            }
        }
        found
    }
}

/// Bakes a primitive, once for each number of joints with which nodes show it.
fn bake_part(options: &BakeOptions, file: &GltfFile, mesh: usize, part: usize, found: &mut Trees) {
    let label = format!("Mesh{mesh}/Primitive{part}");
    progress::doing(format!("building the tree of {label}"));
    let mut not_baked = |reason: String| {
        found.not_baked.push(NotBaked {
            label: label.clone(),
            reason,
        });
    };
    let read = match file.part(mesh, part) {
        Ok(part) => part,
        Err(error) => return not_baked(error.to_string()),
    };
    let mut joints: Vec<Option<usize>> = file.joint_counts(mesh).into_iter().collect();
    if joints.is_empty() {
        joints.push(None);
    }
    let is_deformed =
        |joints: Option<usize>| joints.is_some() && !read.influences.is_empty() || !read.mesh.targets.is_empty();
    joints.retain(|&joints| options.rigid || is_deformed(joints));
    if joints.is_empty() || read.mesh.triangles.is_empty() && read.is_list {
        return;
    }
    if !read.is_list {
        return not_baked("it is drawn as strips or fans, and only separate triangles can be baked".to_owned());
    }
    let drawn = as_bevy_draws(read);
    for joints in joints {
        match tree(options, file, &drawn, joints) {
            Ok(tree) => {
                found.baked.push(Baked {
                    label: label.clone(),
                    mesh: file.mesh_name(mesh),
                    joints: joints.map(|count| count as u32),
                    triangles: drawn.mesh.triangles.len(),
                    targets: drawn.mesh.targets.len(),
                    certificates: tree.certificates().is_some(),
                });
                found.file.trees.push(SavedTree {
                    label: label.clone(),
                    joints: joints.map(|count| count as u32),
                    layout: tree.layout(),
                });
            }
            Err(error) => not_baked(error.to_string()),
        }
    }
}

/// Bevy gives the triangles of a mesh without normals their own vertices, and it reads one set of influences.
fn as_bevy_draws(mut part: Part) -> Part {
    part.influences.truncate(1);
    let corners = part.mesh.triangles.as_flattened().to_vec();
    if !part.has_normals
        && corners
            .iter()
            .all(|&corner| (corner as usize) < part.mesh.positions.len())
    {
        let MorphMesh {
            positions,
            triangles,
            targets,
            ..
        } = &mut part.mesh;
        let spread = |of: &mut Vec<Vec3>| *of = corners.iter().map(|&corner| of[corner as usize]).collect();
        spread(positions);
        targets.iter_mut().filter(|target| !target.is_empty()).for_each(spread);
        for InfluenceSet { joints, weights } in &mut part.influences {
            *joints = corners.iter().map(|&corner| joints[corner as usize]).collect();
            *weights = corners.iter().map(|&corner| weights[corner as usize]).collect();
        }
        *triangles = (0..triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
    }
    part
}

fn tree(
    options: &BakeOptions,
    file: &GltfFile,
    part: &Part,
    joints: Option<usize>,
) -> Result<Arc<MorphBvh>, MeshError> {
    let mut mesh = part.mesh.clone();
    mesh.skin = joints.filter(|_| !part.influences.is_empty()).map(|count| MeshSkin {
        sets: part.influences.clone(),
        skeleton: Skeleton::separate(count),
    });
    let what = || "its tree".to_owned();
    file.budget().take(mesh.tree_bytes(), 1, what)?;
    let tree = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &options.tree));
    if options.certificates && mesh.skin.is_none() && !mesh.targets.is_empty() {
        certify(&tree).map_err(|error| MeshError::Pose(error.to_string()))?;
    }
    Ok(tree)
}

/// Proves for weights from 0 to 1 which triangles never touch.
fn certify(tree: &Arc<MorphBvh>) -> Result<(), InputError> {
    let weights = WeightBox::unit(tree.model().target_count());
    let proof = SelfProof::new(tree, &weights, Effort::default())?;
    let steps = progress::count("part of the proof", proof.parts() as u64);
    let mut outcome = ProofOutcome::default();
    for part in 0..proof.parts() {
        outcome.join(proof.run_part(part));
        steps.step();
    }
    tree.set_certificates(proof.certificates(&outcome)?)?;
    Ok(())
}
