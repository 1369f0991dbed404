//! Files over the whole matrix of what glTF allows: storage, compression, influences, primitives, clips, instances and skins. The reader's
//! posed triangles equal an evaluation of what was written, which shares no code with the reader.

mod animate;
mod choice;
mod compress;
mod curve;
mod description;
mod evaluate;
mod make;
mod numbers;
mod storage;
mod write;

use std::collections::BTreeSet;
use std::path::Path;

use glam::{Affine3A, DVec3};
use morph_collision_models::gltf::read::{DrawnMesh, Extent, GltfFile, ReadError, ReadOptions};
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices, world_vertices};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use self::description::Description;

/// The triangles of what a file draws once, at a time.
fn read(file: &GltfFile, drawn: &DrawnMesh, seconds: f32) -> Result<Vec<[DVec3; 3]>, ReadError> {
    let mesh = file.mesh(drawn.mesh)?.mesh;
    let targets = mesh.targets.len();
    let mut weights = file.default_weights(drawn.mesh, drawn.node, targets)?;
    weights.resize(targets, 0.0);
    let clips = file.clips(drawn.mesh, drawn.node, targets);
    assert!(clips.broken.is_empty(), "{:?}", clips.broken);
    if let Some(clip) = clips.clips.first() {
        weights = clip.sample(seconds);
    }
    let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
    let world = match (file.skin(drawn.mesh, drawn.node)?, drawn.node) {
        (Some(skin), _) => {
            let broken = file.joint_clips(drawn.mesh, drawn.node).broken;
            assert!(broken.is_empty(), "{broken:?}");
            let joints = skin.skeleton.world_from_mesh(skin.skeleton.clips.first(), seconds);
            skinned_vertices(&posed, &skin.sets, &joints)
        }
        (None, Some(node)) => {
            let placement = file.placement(drawn.mesh, node)?;
            let mut place = placement.world_from_mesh(placement.clips.first(), seconds)[0];
            if let Some(instance) = drawn.instance {
                place *= file.instances(node)?.expect("it has instances")[instance];
            }
            world_vertices(&posed, &place)
        }
        (None, None) => world_vertices(&posed, &Affine3A::IDENTITY),
    };
    let triangles = mesh.triangles.iter();
    Ok(triangles
        .map(|corners| corners.map(|corner| world[corner as usize]))
        .collect())
}

/// The distance of two triangles. Compression may start a triangle at another corner.
fn distance(found: [DVec3; 3], expected: [DVec3; 3]) -> f64 {
    let turned = |by: usize| {
        (0..3)
            .map(|i| found[i].distance(expected[(i + by) % 3]))
            .fold(0.0, f64::max)
    };
    (0..3).map(turned).fold(f64::INFINITY, f64::min)
}

/// Compares a file with its description; returns the largest error, relative to the size of what is drawn.
fn compare(description: &Description, file: &GltfFile, times: &[f32], name: &str) -> Result<f64, ReadError> {
    let drawing = file.drawing(Extent::DefaultScene)?;
    assert!(drawing.broken.is_empty(), "{name}: {:?}", drawing.broken);
    let (mut size, mut largest) = (0.0_f64, 0.0_f64);
    for &seconds in times {
        let expected = description.drawn(seconds.into());
        let places: Vec<_> = expected.iter().map(|(place, _)| *place).collect();
        let found: Vec<_> = drawing
            .drawn
            .iter()
            .map(|it| (it.mesh, it.node.expect("it is in a scene"), it.instance))
            .collect();
        assert_eq!(found, places, "{name}");
        for (drawn, (place, triangles)) in drawing.drawn.iter().zip(&expected) {
            let found = read(file, drawn, seconds)?;
            assert_eq!(found.len(), triangles.len(), "{name}: {place:?}");
            for (found, expected) in found.into_iter().zip(triangles) {
                let expected = expected.map(DVec3::from_array);
                size = expected
                    .iter()
                    .fold(size, |size, point| size.max(point.abs().max_element()));
                largest = largest.max(distance(found, expected));
            }
        }
    }
    Ok(largest / size)
}

/// Times of keys, between keys, and beyond both ends.
fn times(description: &Description, rng: &mut Pcg64Mcg) -> Vec<f32> {
    let keys = description.key_times();
    let Some(&last) = keys.last() else { return vec![0.0] };
    let key = keys[rng.random_range(0..keys.len())];
    vec![
        -0.5,
        0.0,
        key,
        rng.random_range(0.0..=last),
        rng.random_range(0.0..=last),
        last,
        last + 1.5,
    ]
}

#[test]
fn posed_triangles_of_every_pair_of_forms() -> Result<(), ReadError> {
    let mut rng = Pcg64Mcg::seed_from_u64(50);
    let choices = choice::choices(&mut rng);
    assert!(choices.len() >= 30);
    let mut counts = BTreeSet::new();
    let (mut worst, mut wrong) = (0.0_f64, Vec::new());
    for (number, choice) in choices.iter().enumerate() {
        let description = make::description(choice, &mut rng);
        counts.extend(description.influence_counts());
        let glb = write::write(&description, choice, rng.random());
        let name = format!("file {number}, {choice:?}");
        let file = GltfFile::parse(&glb, Path::new("matrix.glb"), &ReadOptions::default())?;
        let times = times(&description, &mut rng);
        let error = compare(&description, &file, &times, &name)?;
        if error > 1e-6 {
            wrong.push(format!("{name}: {error:e}"));
        }
        worst = worst.max(error);
    }
    assert!(wrong.is_empty(), "{} files: {wrong:#?}", wrong.len());
    assert_eq!(counts, (1..=12).collect(), "numbers of influences");
    println!("{} files, at most {worst:e} of the size", choices.len());
    Ok(())
}
