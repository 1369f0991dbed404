//! Files from untrusted sources.

use std::path::Path;

use crate::gltf_read::{GltfFile, ReadOptions};
use crate::inspect::FileReport;
use crate::scenes::Scene;

/// A model's memory limit, kept small so that fuzzing tries many files.
const MEMORY_LIMIT: u64 = 32 << 20;

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

/// Reads a `.glb` or `.gltf` file without external buffers. The result must be an error with a message, or meshes and clips.
/// Those are reported, and trees are built for meshes that can collide.
///
/// # Panics
/// Only if the reader or the core library does, which is a bug.
pub fn gltf(data: &[u8]) {
    let options = ReadOptions {
        memory_limit: MEMORY_LIMIT,
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
    for mesh in &report.meshes {
        let Some(usable) = &mesh.usable else { continue };
        file.budget().lend(|| {
            for clip in file.clips(mesh.index, None, usable.targets.len()).clips {
                let _weights = clip.sample(0.7 * clip.duration());
            }
            if let Ok(Some(skin)) = file.skin(mesh.index, None) {
                let _rest = skin.skeleton.at_rest();
                for clip in &skin.skeleton.clips {
                    let _joints = skin.skeleton.world_from_mesh(Some(clip), 0.7 * clip.duration());
                }
                for animation in 0..report.animations.len() {
                    let borrowed = file.borrowed_clip(animation);
                    let clip = borrowed.map(|clip| clip.for_skeleton("other", &skin.skeleton, file.budget()));
                    if let Ok(Ok(Some(matched))) = clip {
                        let _joints = skin
                            .skeleton
                            .world_from_mesh(Some(&matched.clip), 0.7 * matched.clip.duration());
                    }
                }
            }
        });
    }
}
