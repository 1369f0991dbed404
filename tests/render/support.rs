//! Pictures, and what is on them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use image::RgbImage;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::view::models::with_normals;
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::stage::BACKGROUND;
use morph_collision_workspace::view::{Show, clock};

/// One renderer at a time: each takes all processors.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    static RENDERER: Mutex<()> = Mutex::new(());
    RENDERER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A show of this scene, seen from `eye`.
pub(crate) fn scene(eye: Vec3, scene: impl FnOnce(&mut App) + Send + 'static) -> Show {
    Show {
        name: "test",
        about: "",
        keys: &[],
        eye,
        target: Vec3::ZERO,
        pictures: &[],
        scene: Box::new(scene),
    }
}

/// The show without its panel, at its first frame.
pub(crate) fn offscreen(show: Show, size: (u32, u32)) -> Offscreen {
    Offscreen::new(show, size, true).unwrap()
}

/// What a mesh at these weights is spawned with, from `Startup` on.
pub(crate) fn drawn(
    mesh: &MorphMesh,
    weights: Vec<f32>,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
) -> impl Bundle {
    let plain = StandardMaterial {
        base_color: Color::srgb(0.1, 0.3, 0.5),
        unlit: true,
        double_sided: true,
        cull_mode: None,
        ..default()
    };
    (
        Mesh3d(meshes.add(with_normals(mesh))),
        MeshMaterial3d(materials.add(plain)),
        MeshMorphWeights::Value { weights },
    )
}

/// Whether something other than the background is there.
pub(crate) fn is_drawn(picture: &RgbImage, x: u32, y: u32) -> bool {
    let [r, g, b] = BACKGROUND.to_srgba().to_u8_array_no_alpha();
    let pixel = picture.get_pixel(x, y).0;
    pixel.iter().zip([r, g, b]).any(|(&a, b)| a.abs_diff(b) > 8)
}

/// Whether the overlay is there.
pub(crate) fn is_red(picture: &RgbImage, x: u32, y: u32) -> bool {
    let [r, g, b] = picture.get_pixel(x, y).0;
    r > 170 && g < 70 && b < 70
}

/// How many pixels are so.
pub(crate) fn count(picture: &RgbImage, is: impl Fn(&RgbImage, u32, u32) -> bool) -> usize {
    picture
        .enumerate_pixels()
        .filter(|&(x, y, _)| is(picture, x, y))
        .count()
}

/// Where the show is.
pub(crate) fn frame(offscreen: &mut Offscreen) -> f64 {
    offscreen.app_mut().world().resource::<clock::Clock>().frame
}
