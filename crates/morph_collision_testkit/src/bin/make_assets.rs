//! Makes the files in `assets/`: `cargo run --release -p morph_collision_testkit --bin make_assets -- assets`.

use std::{
    error::Error,
    path::{Path, PathBuf},
    process::ExitCode,
};

use morph_collision_models::gltf::write::write_glb;
use morph_collision_testkit::assets;

fn main() -> ExitCode {
    let Some(directory) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("usage: make_assets DIRECTORY");
        return ExitCode::FAILURE;
    };
    match make(&directory) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn make(directory: &Path) -> Result<(), Box<dyn Error>> {
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
    Ok(())
}
