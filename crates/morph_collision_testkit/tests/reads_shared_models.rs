//! Real models by other people, where they are at hand.

use std::{error::Error, path::Path};

use morph_collision_testkit::{gltf_read::read_meshes, mesh::MorphMesh};

/// The models' folder beside the repository; `None`, with a printed reason, where it is absent.
fn folder() -> Option<&'static Path> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models"));
    if !folder.is_dir() {
        println!("skipped: there are no models in {}", folder.display());
        return None;
    }
    Some(folder)
}

fn read_one(folder: &Path, file: &str) -> Result<Option<MorphMesh>, Box<dyn Error>> {
    let path = folder.join(file);
    if !path.is_file() {
        println!("skipped: there is no {}", path.display());
        return Ok(None);
    }
    let most_targets = read_meshes(&path)?.into_iter().max_by_key(|mesh| mesh.targets.len());
    Ok(most_targets)
}

#[test]
fn every_model_is_read_whole_and_accepted() -> Result<(), Box<dyn Error>> {
    let Some(folder) = folder() else { return Ok(()) };
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if !path
            .extension()
            .is_some_and(|extension| extension == "glb" || extension == "gltf")
        {
            continue;
        }
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
    let Some(folder) = folder() else { return Ok(()) };
    for (file, triangles, targets, clips) in [
        ("mh_head_eyes_teeth_arkit52_dao.glb", 9534, 52, 1),
        ("mh_body_arkit52.glb", 26756, 52, 0),
        ("ict_face_skin.glb", 22288, 57, 1),
        ("AnimatedMorphCube.gltf", 12, 2, 1),
        ("SimpleMorph.gltf", 1, 2, 1),
    ] {
        let Some(mesh) = read_one(folder, file)? else { continue };
        let found = (mesh.triangles.len(), mesh.targets.len(), mesh.animations.len());
        assert_eq!(found, (triangles, targets, clips), "{file}");
    }
    Ok(())
}

#[test]
fn a_face_capture_has_weights_that_sum_to_more_than_one() -> Result<(), Box<dyn Error>> {
    let Some(folder) = folder() else { return Ok(()) };
    let Some(mesh) = read_one(folder, "mh_head_eyes_teeth_arkit52_dao.glb")? else {
        return Ok(());
    };
    let clip = &mesh.animations[0];
    assert_eq!(clip.times.len(), 180);
    let largest = clip
        .weights
        .iter()
        .map(|weights| weights.iter().sum::<f32>())
        .fold(0.0, f32::max);
    assert!((12.0..13.0).contains(&largest), "the largest sum is {largest}");
    Ok(())
}
