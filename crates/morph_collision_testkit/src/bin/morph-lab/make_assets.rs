//! `morph-lab make-assets assets`: makes the models and scenes in `assets/`.

use std::path::PathBuf;

use clap::Args;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_models::gltf::write::write_glb;
use morph_collision_testkit::assets;

/// Make the models and scenes in assets/ again. They are the same, bit for bit.
#[derive(Debug, Args)]
pub(crate) struct MakeAssetsArgs {
    /// The folder to write to.
    directory: PathBuf,
}

pub(crate) fn make_assets(MakeAssetsArgs { directory }: &MakeAssetsArgs) -> Result<Verdict, AnyError> {
    std::fs::create_dir_all(directory.join("scenes"))?;
    for (file, mesh, appearance) in assets::models() {
        let path = directory.join(&file);
        write_glb(&path, &mesh, &appearance)?;
        let (triangles, vertices) = (mesh.triangles.len(), mesh.positions.len());
        println!("{}: {triangles} triangles, {vertices} vertices", path.display());
    }
    for (file, scene) in assets::scenes() {
        let path = directory.join(file);
        scene.write(&path)?;
        println!("{}: {} frames", path.display(), scene.frames.len());
    }
    Ok(Verdict::Clean)
}
