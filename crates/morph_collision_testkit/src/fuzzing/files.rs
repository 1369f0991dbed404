//! Files from untrusted sources.

use std::path::Path;

use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::read::{BorrowedClip, ExpressionBind, Extent, GltfFile, Matched, ReadOptions};
use morph_collision_models::inspect::FileReport;
use morph_collision_models::memory::OverBudget;
use morph_collision_models::mesh::InfluenceSet;
use morph_collision_models::scenes::Scene;
use morph_collision_models::skeleton::{JointClip, Skeleton};

/// A model's memory limit, kept small so that fuzzing tries many files.
const MEMORY_LIMIT: u64 = 32 << 20;
/// At most this many scenes of a file are posed, nodes of a scene, and clips as those of another file, because each reads what it
/// needs anew.
const MOST_SCENES: usize = 4;
const MOST_NODES: usize = 24;
const MOST_CLIPS: usize = 8;

/// Parses a JSON scene. The result must be an error with a message, or a scene that survives writing and reading again.
///
/// # Panics
/// Otherwise.
pub fn scene(data: &[u8]) {
    let path = Path::new("fuzz/scene.json");
    let scene = match Scene::parse(data, path) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    for body in &scene.bodies {
        let _found_or_not = body.model_path(path);
    }
    for state in scene.frames.iter().flatten() {
        let _any = state.world_from_model();
    }
    let json = serde_json::to_vec(&scene).expect("what was read can be written");
    assert_eq!(Scene::parse(&json, path).ok().as_ref(), Some(&scene));
}

/// Reads a `.glb` or `.gltf` file without external buffers, strictly or without its bad parts, which depends on its bytes. The result must be
/// an error with a message, or meshes and clips. Those are reported, trees are built for meshes that can collide, and everything that the
/// file draws is posed.
///
/// # Panics
/// Only if the reader or the core library does, which is a bug.
pub fn gltf(data: &[u8]) {
    let options = ReadOptions {
        memory_limit: MEMORY_LIMIT,
        // Any bytes decide, so a mutation may change it.
        skip_bad: data.iter().fold(0, |sum, byte| sum ^ byte) & 1 == 1,
        ..ReadOptions::default()
    };
    let file = match GltfFile::parse(data, Path::new("fuzz/model.glb"), &options) {
        Ok(file) => file,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let report = FileReport::read(&file);
    assert!(!report.to_string().is_empty());
    let _json = serde_json::to_string(&report).expect("a report can be written");
    for expression in file.expressions() {
        let is_whole = |bind: &ExpressionBind| bind.mesh < file.mesh_count() && bind.weight.is_finite();
        assert!(expression.binds.iter().all(is_whole), "{expression:?}");
    }
    let scenes = (0..file.scene_names().len().min(MOST_SCENES)).map(Extent::Scene);
    for extent in scenes.chain([Extent::DefaultScene, Extent::Everything]) {
        file.budget().lend(|| pose_drawing(&file, extent));
    }
}

/// Poses what a file draws, at rest and in its clips.
fn pose_drawing(file: &GltfFile, extent: Extent) {
    let drawing = match file.drawing(extent) {
        Ok(drawing) => drawing,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    assert!(drawing.broken.iter().all(|error| !error.to_string().is_empty()));
    let mut shown: Vec<(usize, Option<usize>)> = drawing.drawn.iter().map(|drawn| (drawn.mesh, drawn.node)).collect();
    shown.dedup();
    for (mesh, node) in shown.into_iter().take(MOST_NODES) {
        file.budget().lend(|| pose(file, mesh, node));
    }
}

/// Poses a mesh as a node shows it.
fn pose(file: &GltfFile, mesh: usize, node: Option<usize>) {
    let Ok(found) = file.mesh(mesh) else { return };
    let targets = found.mesh.targets.len();
    let _weights = file.default_weights(mesh, node, targets);
    for clip in file.clips(mesh, node, targets).clips {
        blend(&clip, targets);
    }
    if let Ok(Some(skin)) = file.skin(mesh, node) {
        let vertices = found.mesh.positions.len();
        let is_whole = |set: &InfluenceSet| set.joints.len() == vertices && set.weights.len() == vertices;
        assert!(skin.sets.iter().all(is_whole));
        play(&skin.skeleton, &skin.skeleton.clips);
        lend_clips(
            file,
            |clip| clip.for_skeleton("other", &skin.skeleton, file.budget()),
            |clip| {
                play(&skin.skeleton, std::slice::from_ref(clip));
            },
        );
    }
    let Some(node) = node else { return };
    if let Ok(placement) = file.placement(mesh, node) {
        assert_eq!(placement.joints.len(), 1);
        play(&placement, &placement.clips);
    }
    let name = file.node_name(node);
    lend_clips(
        file,
        |clip| clip.for_weights("other", &name, &found.mesh, file.budget()),
        |clip| {
            blend(clip, targets);
        },
    );
    let _instances = file.instances(node);
}

/// Uses the file's animations like those of another file.
fn lend_clips<T>(
    file: &GltfFile,
    fit: impl Fn(&BorrowedClip) -> Result<Option<Matched<T>>, OverBudget>,
    play: impl Fn(&T),
) {
    for animation in 0..file.animation_names().len().min(MOST_CLIPS) {
        if let Ok(clip) = file.borrowed_clip(animation)
            && let Ok(Some(matched)) = fit(&clip)
        {
            play(&matched.clip);
        }
    }
}

/// Shares of a clip's length, also before its start and after its end.
const SHARES: [f32; 4] = [-0.1, 0.7, 1.0, 1.2];

fn blend(clip: &WeightAnimation, targets: usize) {
    for share in SHARES {
        let weights = clip.sample(share * clip.duration());
        assert!(weights.is_empty() || weights.len() == targets);
    }
}

fn play(skeleton: &Skeleton, clips: &[JointClip]) {
    let _rest = skeleton.at_rest();
    for clip in clips {
        for share in SHARES {
            let joints = skeleton.world_from_mesh(Some(clip), share * clip.duration());
            assert_eq!(joints.len(), skeleton.joints.len());
        }
    }
}
