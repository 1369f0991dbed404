//! The files in `assets/` equal the generators' output.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::gltf::write::to_glb;
use morph_collision_models::scenes::Scene;
use morph_collision_testkit::assets;

fn assets_directory() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets")
}

#[test]
fn generating_the_small_models_again_gives_the_same_bytes() -> Result<(), Box<dyn Error>> {
    for (file, mesh, appearance) in assets::models().take(3) {
        let stored = std::fs::read(assets_directory().join(&file))?;
        assert!(stored == to_glb(&mesh, &appearance)?, "{file} differs: run make_assets");
    }
    Ok(())
}

#[test]
fn the_stored_models_are_read() -> Result<(), Box<dyn Error>> {
    for (file, mesh, _) in assets::models() {
        assert_eq!(read_meshes(&assets_directory().join(&file))?, [mesh], "{file}");
    }
    Ok(())
}

#[test]
fn the_stored_scenes_are_the_scripted_ones_and_find_their_models() -> Result<(), Box<dyn Error>> {
    for (file, scripted) in assets::scenes() {
        let path = assets_directory().join(file);
        let stored = Scene::read(&path)?;
        assert_eq!(
            (&stored.bodies, stored.frames.len()),
            (&scripted.bodies, scripted.frames.len())
        );
        for (stored, scripted) in stored.frames.iter().flatten().zip(scripted.frames.iter().flatten()) {
            assert!(
                stored.world_from_model().abs_diff_eq(scripted.world_from_model(), 1e-5),
                "{file}"
            );
        }
        for body in &stored.bodies {
            assert_eq!(read_meshes(&body.model_path(&path))?.len(), 1);
        }
    }
    Ok(())
}
