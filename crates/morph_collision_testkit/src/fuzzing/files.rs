//! Files that anybody may have written.

use std::path::Path;

use crate::gltf_read::parse_meshes;
use crate::scenes::Scene;

/// A JSON scene: an error that says something, or a scene that is the same once written and read again.
///
/// # Panics
/// If it is not.
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

/// A `.glb` or `.gltf` file without buffers in other files: an error that says something, or meshes that the core takes or
/// turns away.
///
/// # Panics
/// Only where the reader or the core does, which is a bug.
pub fn gltf(data: &[u8]) {
    match parse_meshes(data, Path::new("fuzz/model.glb")) {
        Ok(meshes) => {
            for mesh in meshes {
                let _valid_or_not = mesh.to_model();
                for clip in &mesh.animations {
                    let _weights = clip.sample(0.7 * clip.duration());
                }
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
