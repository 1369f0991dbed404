//! Reads real models by other people: the head in `assets/`, and more if they are available.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;

const HEAD: &str = "mh_head_eyes_teeth_arkit52.glb";

/// All glTF files in `assets/`, and in the folder of models beside the repository if it exists.
fn all_models() -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let repository = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut models = Vec::new();
    for folder in ["assets", "../shared/models"] {
        let folder = repository.join(folder);
        if !folder.is_dir() {
            println!("skipped: there is no {}", folder.display());
            continue;
        }
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|end| end == "glb" || end == "gltf") {
                models.push(path);
            }
        }
    }
    Ok(models)
}

fn with_most_targets(path: &Path) -> Result<MorphMesh, Box<dyn Error>> {
    let meshes = read_meshes(path)?;
    let mesh = meshes.into_iter().max_by_key(|mesh| mesh.targets.len());
    Ok(mesh.ok_or("it has no mesh")?)
}

#[test]
fn every_model_is_read_whole_and_accepted() -> Result<(), Box<dyn Error>> {
    let models = all_models()?;
    assert!(
        models.iter().any(|path| path.ends_with(HEAD)),
        "the head is not in assets/"
    );
    for path in models {
        for mesh in read_meshes(&path)? {
            let (vertices, targets) = (mesh.positions.len(), mesh.targets.len());
            assert!(
                mesh.targets.iter().all(|target| target.len() == vertices),
                "{}",
                path.display()
            );
            assert_eq!(mesh.target_names.len(), targets);
            let covered: u32 = mesh.primitives.iter().map(|range| range.end - range.start).sum();
            assert_eq!(covered as usize, mesh.triangles.len());
            for clip in &mesh.animations {
                assert!(
                    clip.weights.iter().all(|weights| weights.len() == targets),
                    "{}",
                    clip.name
                );
            }
            let model = mesh
                .to_model()
                .map_err(|error| format!("{}: {error}", path.display()))?;
            println!(
                "{}: {} welded of {vertices} vertices, {} triangles, {targets} targets, {} clips",
                path.display(),
                model.vertex_count(),
                model.triangle_count(),
                mesh.animations.len()
            );
        }
    }
    Ok(())
}

#[test]
fn the_known_counts_of_some_models_are_found() -> Result<(), Box<dyn Error>> {
    let head = with_most_targets(&real_model(HEAD).ok_or("the head is not in assets/")?)?;
    let (positions, triangles) = (head.positions.len(), head.triangles.len());
    assert_eq!((triangles, head.targets.len(), head.animations.len()), (9534, 52, 0));
    assert_eq!(head.to_model()?.vertex_count(), 4838, "of {positions} vertices");
    assert_eq!(head.target_names.iter().filter(|name| *name == "jawOpen").count(), 1);
    for (file, triangles, targets, clips) in [
        ("mh_head_eyes_teeth_arkit52_dao.glb", 9534, 52, 1),
        ("mh_body_arkit52.glb", 26756, 52, 0),
        ("ict_face_skin.glb", 22288, 57, 1),
        ("AnimatedMorphCube.gltf", 12, 2, 1),
        ("SimpleMorph.gltf", 1, 2, 1),
    ] {
        let Some(path) = real_model(file) else { continue };
        let mesh = with_most_targets(&path)?;
        let found = (mesh.triangles.len(), mesh.targets.len(), mesh.animations.len());
        assert_eq!(found, (triangles, targets, clips), "{file}");
    }
    Ok(())
}

/// Needs a capture that is only in the folder beside the repository. `gltf/reading.rs` reads generated animations
/// everywhere.
#[test]
fn a_face_capture_has_weights_that_sum_to_more_than_one() -> Result<(), Box<dyn Error>> {
    let Some(path) = real_model("mh_head_eyes_teeth_arkit52_dao.glb") else {
        return Ok(());
    };
    let mesh = with_most_targets(&path)?;
    let clip = &mesh.animations[0];
    assert_eq!(clip.times.len(), 180);
    let sums = clip.weights.iter().map(|weights| weights.iter().sum::<f32>());
    let largest = sums.fold(0.0, f32::max);
    assert!((12.0..13.0).contains(&largest), "the largest sum is {largest}");
    Ok(())
}
