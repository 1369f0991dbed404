//! Compares answers about skinned bodies with brute force, and boxes with vertices: rigs of every kind, and characters if
//! available.

use std::error::Error;
use std::path::Path;

use glam::Affine3A;
use morph_collision::BuildOptions;
use morph_collision_models::generated::rigs;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::verify::{Counts, LEAF_SIZES, Meshes, Reproduction, Situation, Trees, verify};

/// The error and its place, without the joints that are at rest.
fn told(reproduction: &Reproduction) -> String {
    let Situation {
        weights,
        places,
        joints,
    } = &reproduction.situation;
    let moved = joints.clone().map(|joints| {
        let all = joints.into_iter().enumerate();
        all.filter(|(_, joint)| *joint != Affine3A::IDENTITY)
            .collect::<Vec<_>>()
    });
    format!("{:?} at {weights:?}, {places:?}, {moved:?}", reproduction.trouble)
}

/// Compares trees of all leaf sizes; returns their total counts.
#[track_caller]
fn assert_right(meshes: Meshes<'_>, frames: u64, seed: u64) -> Result<Counts, Box<dyn Error>> {
    let mut sources = Vec::new();
    for leaf_size in LEAF_SIZES {
        sources.push(Trees::build(
            meshes,
            &BuildOptions::default().with_leaf_size(leaf_size)?,
        )?);
    }
    let verification = verify(meshes, &mut sources, frames, seed, || {})?;
    let smallest = verification
        .smallest
        .as_ref()
        .map(|finding| told(&finding.reproduction));
    assert_eq!(smallest, None);
    let mut total = Counts::default();
    verification.counts.iter().for_each(|counts| total += *counts);
    assert_eq!(total.differences(), 0, "{total:?}");
    let [a, b] = meshes.map(|mesh| &mesh.name);
    println!("{a} and {b}: {total:?}");
    Ok(total)
}

#[test]
fn rigs_of_every_kind_are_answered_right() -> Result<(), Box<dyn Error>> {
    let all = [
        rigs::tube(1, 6, 4, 3),
        rigs::tube(2, 2, 1, 0),
        rigs::branching(3, 16, 8, 4),
        rigs::rigid_pieces(4, 8, 2),
        rigs::random_soup(5, 120, 30, 3, 2),
        rigs::random_soup(6, 200, rigs::MOST_JOINTS, 0, 1),
        rigs::unnormalised(&rigs::branching(7, 10, 4, 2), 8),
        rigs::unnormalised(&rigs::random_soup(9, 100, 9, 2, 2), 10),
        rigs::nearly_normalised(&rigs::rigid_pieces(11, 8, 2), 12),
        rigs::nearly_normalised(&rigs::branching(13, 10, 2, 0), 14),
    ];
    let mut pairs = 0;
    for (index, mesh) in all.iter().enumerate() {
        let seed = index as u64;
        pairs += assert_right([mesh; 2], 6, seed)?.pairs_truth;
        pairs += assert_right([mesh, &all[(index + 1) % all.len()]], 3, seed + 100)?.pairs_truth;
    }
    assert!(pairs > 2_500, "{pairs}");
    Ok(())
}

/// Meshes with more than eight influences per vertex were refused.
#[test]
fn any_number_of_influences_is_answered_right() -> Result<(), Box<dyn Error>> {
    let mut pairs = 0;
    for (influences, seed) in [1, 4, 5, 8, 9, 12, 16].into_iter().zip(20..) {
        let sets = usize::div_ceil(influences, 4);
        let body = rigs::branching(seed, 18, influences, 2);
        let soup = rigs::random_soup(seed, 80, 30, 2, sets);
        for mesh in [&body, &soup] {
            let skin = mesh.skin.as_ref().ok_or("no skin")?;
            assert_eq!(skin.sets.len(), sets);
        }
        let unnormalised = rigs::unnormalised(&body, seed);
        let nearly = rigs::nearly_normalised(&soup, seed);
        for meshes in [[&body, &soup], [&unnormalised, &body], [&nearly, &unnormalised]] {
            pairs += assert_right(meshes, 8, seed)?.pairs_truth;
        }
    }
    assert!(pairs > 5000, "{pairs}");
    let field = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../morph_collision_models/tests/gltf/data/field"
    );
    let twelve = read_meshes(&Path::new(field).join("c01_twelve_influences.glb"))?;
    assert_right([&twelve[0]; 2], 24, 30)?;
    Ok(())
}

#[test]
fn a_skinned_body_and_one_without_a_skin_are_answered_right() -> Result<(), Box<dyn Error>> {
    let (rig, dolphin) = (
        rigs::branching(11, 8, 4, 3),
        morph_collision_models::generated::dolphin(0),
    );
    assert_right([&rig, &dolphin], 15, 1)?;
    assert_right([&dolphin, &rig], 15, 2)?;
    Ok(())
}

fn skinned_meshes(file: &str) -> Result<Vec<MorphMesh>, Box<dyn Error>> {
    let Some(path) = real_model(file) else {
        return Ok(Vec::new());
    };
    let meshes = read_meshes(&path)?.into_iter();
    Ok(meshes.filter(|mesh| mesh.skin.is_some()).collect())
}

#[test]
fn characters_are_answered_right_in_clips_and_extreme_poses() -> Result<(), Box<dyn Error>> {
    for (file, frames) in [
        ("mh_character_low.glb", 30),
        ("Fox.glb", 40),
        ("mh_character.glb", 6),
        ("RobotExpressive.glb", 30),
    ] {
        let meshes = skinned_meshes(file)?;
        for mesh in &meshes {
            assert_right([mesh; 2], frames, 5)?;
        }
        if let [a, b, ..] = meshes.as_slice() {
            assert_right([a, b], frames, 6)?;
        }
    }
    Ok(())
}
