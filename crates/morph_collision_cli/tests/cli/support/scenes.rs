//! Scene files.

use std::error::Error;
use std::path::{Path, PathBuf};

use glam::{Affine3A, Quat, Vec3};
use morph_collision_models::generated;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::scenes::{BodyState, Scene, SceneBody};
use morph_collision_models::weight_list::WeightList;
use serde_json::Value;

/// Writes a scene made of any JSON into `dir`.
pub(crate) fn write_scene(dir: &Path, scene: &Value) -> Result<PathBuf, Box<dyn Error>> {
    let path = dir.join("scene.json");
    std::fs::write(&path, scene.to_string())?;
    Ok(path)
}

/// Six frames of three dolphins, two boxes in one mesh and a flat dolphin that come together and
/// separate.
pub(crate) fn mixed_scene(dir: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let looks = Appearance {
        base_color: [1.0; 4],
        roughness: 1.0,
    };
    write_glb(&dir.join("dolphin.glb"), &generated::dolphin(0), &looks)?;
    let mut boxes = generated::rigid::box_mesh(Vec3::splat(0.3));
    let half = boxes.triangles.len() as u32;
    let (second, offset) = (boxes.positions.clone(), boxes.positions.len() as u32);
    boxes
        .positions
        .extend(second.iter().map(|p| *p + Vec3::new(0.9, 0.2, 0.1)));
    boxes.triangles.extend(
        boxes
            .triangles
            .clone()
            .iter()
            .map(|corners| corners.map(|corner| corner + offset)),
    );
    boxes.primitives = vec![0..half, half..2 * half];
    write_glb(&dir.join("boxes.glb"), &boxes, &looks)?;

    let body = |model: &str| SceneBody {
        model: model.into(),
        ..SceneBody::default()
    };
    let bodies = ["dolphin.glb", "dolphin.glb", "boxes.glb", "dolphin.glb", "dolphin.glb"]
        .map(body)
        .to_vec();
    let frames = (0..6u8).map(|frame| {
        let t = f32::from(frame) / 5.0;
        let turned = Affine3A::from_rotation_translation(Quat::from_rotation_z(t), Vec3::new(2.5 * t - 1.0, 0.2, 0.1));
        vec![
            BodyState::default(),
            BodyState::rigid(&[t, 0.3], &turned),
            BodyState {
                translation: Some([0.5 - t, 0.0, 0.0]),
                ..BodyState::default()
            },
            // Mirrored, stretched, and weights far beyond 1.
            BodyState {
                weights: WeightList::All(vec![2.5 * t, -1.5]),
                scale: Some([-1.0, 1.5, 0.5]),
                translation: Some([0.0, 0.4 - 0.5 * t, 0.0]),
                ..BodyState::default()
            },
            BodyState {
                scale: Some([1.0, 0.0, 1.0]),
                translation: Some([0.1, 0.05, t]),
                ..BodyState::default()
            },
        ]
    });
    let path = dir.join("scene.json");
    Scene {
        bodies,
        frames: frames.collect(),
        ..Scene::default()
    }
    .write(&path)?;
    Ok(path)
}
