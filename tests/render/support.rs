//! Pictures, and tests of their pixels.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::math::Affine3A;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use image::RgbImage;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::view::models::with_normals;
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::stage::BACKGROUND;
use morph_collision_workspace::view::{Demo, clock};

/// The colour of meshes made by [`drawn`].
const PLAIN: Color = Color::srgb(0.1, 0.3, 0.5);

/// Allows one renderer at a time, because each uses all processors.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    static RENDERER: Mutex<()> = Mutex::new(());
    RENDERER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A demo of this scene with the plugins of this project, seen from `eye`.
pub(crate) fn scene(eye: Vec3, scene: impl FnOnce(&mut App) + Send + 'static) -> Demo {
    let scene = |app: &mut App| {
        app.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin, MorphPickingPlugin));
        scene(app);
    };
    Demo {
        name: "test",
        about: "",
        keys: &[],
        eye,
        target: Vec3::ZERO,
        pictures: &[],
        scene: Box::new(scene),
    }
}

/// The demo without its panel, at its first frame.
pub(crate) fn offscreen(demo: Demo, size: (u32, u32)) -> Offscreen {
    Offscreen::new(demo, size, true).unwrap()
}

/// The skeleton of a mesh whose joints have these matrices.
pub(crate) fn skeleton(
    joints: &[Affine3A],
    bind_poses: &mut Assets<SkinnedMeshInverseBindposes>,
    commands: &mut Commands,
) -> SkinnedMesh {
    let spawn = |joint: &Affine3A| commands.spawn(Transform::from_matrix(Mat4::from(*joint))).id();
    SkinnedMesh {
        inverse_bindposes: bind_poses.add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; joints.len()])),
        joints: joints.iter().map(spawn).collect(),
    }
}

/// A character that crouches, waves and talks: its mesh, weights and joint matrices, 1.7 high around the origin.
pub(crate) fn character(seconds: f32) -> (MorphMesh, Vec<f32>, Vec<Affine3A>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/mh_character_low.glb");
    let mesh = read_meshes(&path).unwrap().swap_remove(0);
    let skeleton = &mesh.skin.as_ref().unwrap().skeleton;
    let clip = skeleton.clip("wave_and_crouch").unwrap();
    let small = Affine3A::from_scale(Vec3::splat(0.1));
    let joints = skeleton.world_from_mesh(Some(clip), seconds);
    let joints = joints.into_iter().map(|joint| small * joint).collect();
    let weights = (0..mesh.targets.len()).map(|target| if target % 3 == 0 { 0.6 } else { 0.0 });
    let weights = weights.collect();
    (mesh, weights, joints)
}

/// The components to spawn a mesh at these weights, from `Startup` on.
pub(crate) fn drawn(
    mesh: &MorphMesh,
    weights: Vec<f32>,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
) -> impl Bundle {
    let mut shown = with_normals(mesh);
    if let Some(set) = mesh.skin.as_ref().and_then(|skin| skin.sets.first()) {
        let joints = VertexAttributeValues::Uint16x4(set.joints.clone());
        shown.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
        shown.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, set.weights.clone());
    }
    let plain = StandardMaterial {
        base_color: PLAIN,
        unlit: true,
        double_sided: true,
        cull_mode: None,
        ..default()
    };
    (
        Mesh3d(meshes.add(shown)),
        MeshMaterial3d(materials.add(plain)),
        MeshMorphWeights::Value { weights },
    )
}

/// Whether the pixel shows something other than the background.
pub(crate) fn is_drawn(picture: &RgbImage, x: u32, y: u32) -> bool {
    let [r, g, b] = BACKGROUND.to_srgba().to_u8_array_no_alpha();
    let pixel = picture.get_pixel(x, y).0;
    pixel.iter().zip([r, g, b]).any(|(&a, b)| a.abs_diff(b) > 8)
}

/// Whether a mesh made by [`drawn`] covers the whole pixel.
pub(crate) fn is_covered(picture: &RgbImage, x: u32, y: u32) -> bool {
    let [r, g, b] = PLAIN.to_srgba().to_u8_array_no_alpha();
    let pixel = picture.get_pixel(x, y).0;
    pixel.iter().zip([r, g, b]).all(|(&a, b)| a.abs_diff(b) <= 8)
}

/// Whether the pixel shows the overlay.
pub(crate) fn is_red(picture: &RgbImage, x: u32, y: u32) -> bool {
    let [r, g, b] = picture.get_pixel(x, y).0;
    r > 170 && g < 70 && b < 70
}

/// The number of pixels for which `is` holds.
pub(crate) fn count(picture: &RgbImage, is: impl Fn(&RgbImage, u32, u32) -> bool) -> usize {
    picture
        .enumerate_pixels()
        .filter(|&(x, y, _)| is(picture, x, y))
        .count()
}

/// The demo's current frame.
pub(crate) fn frame(offscreen: &mut Offscreen) -> f64 {
    offscreen.app_mut().world().resource::<clock::Clock>().frame
}
