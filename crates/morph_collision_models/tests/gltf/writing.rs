//! Written files can be read back, and the same mesh always gives the same bytes.

use std::error::Error;

use glam::Vec3;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::generated;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::gltf::write::{Appearance, WriteError, to_glb};
use morph_collision_models::mesh::MorphMesh;

fn round_trip(mesh: &MorphMesh) -> Result<Vec<MorphMesh>, Box<dyn Error>> {
    let bytes = to_glb(mesh, &Appearance::default())?;
    assert_eq!(
        bytes,
        to_glb(mesh, &Appearance::default())?,
        "the bytes depend on nothing but the mesh"
    );
    let (_directory, path) = crate::support::write(&bytes, "model.glb");
    Ok(read_meshes(&path)?)
}

#[test]
fn meshes_survive_the_round_trip() -> Result<(), Box<dyn Error>> {
    for mesh in [
        generated::dolphin(0),
        generated::dolphin(1),
        generated::random::random_blob(7, 2, 5, 0.8),
        generated::random::triangle_soup(3, 40, 2),
        generated::degenerate::zero_area(1, 30),
        generated::rigid::box_mesh(Vec3::ONE),
    ] {
        assert_eq!(round_trip(&mesh)?, [mesh]);
    }
    Ok(())
}

#[test]
fn primitives_share_their_vertices() -> Result<(), Box<dyn Error>> {
    let mut mesh = generated::dolphin(0);
    mesh.primitives = vec![0..432, 432..564];
    assert_eq!(round_trip(&mesh)?, [mesh]);
    Ok(())
}

#[test]
fn indices_grow_to_32_bits_where_16_do_not_reach() -> Result<(), Box<dyn Error>> {
    let sheet = generated::rigid::grid(1.0, 256);
    assert_eq!(sheet.positions.len(), 257 * 257);
    assert_eq!(round_trip(&sheet)?, [sheet]);
    Ok(())
}

#[test]
fn a_jump_becomes_a_ramp_of_no_length() -> Result<(), Box<dyn Error>> {
    let mut mesh = generated::dolphin(0);
    let jump = WeightAnimation {
        name: "jump".into(),
        times: vec![0.0, 1.0, 1.0, 2.0],
        weights: vec![vec![0.0, 0.0], vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 0.0]],
        ..WeightAnimation::default()
    };
    mesh.animations = vec![jump.clone()];
    let read = round_trip(&mesh)?.remove(0).animations.remove(0);
    assert_eq!(read.times[2], 1.0_f32.next_up());
    assert_eq!(
        (read.sample(1.0), read.sample(1.5)),
        (jump.sample(0.5), jump.sample(1.5))
    );
    Ok(())
}

#[test]
fn a_cubic_clip_and_a_target_that_moves_nothing_survive() -> Result<(), Box<dyn Error>> {
    let mut mesh = generated::dolphin(0);
    mesh.animations = vec![WeightAnimation {
        name: "cubic".into(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0, 0.5], vec![1.0, 0.25]],
        tangents: vec![[vec![1.0, 2.0], vec![3.0, 4.0]], [vec![5.0, 6.0], vec![7.0, 8.0]]],
        ..WeightAnimation::default()
    }];
    assert_eq!(round_trip(&mesh)?, [mesh.clone()]);
    mesh.targets[1].clear();
    let read = round_trip(&mesh)?.remove(0);
    assert_eq!(read.targets[1], vec![Vec3::ZERO; mesh.positions.len()]);
    Ok(())
}

#[test]
fn what_gltf_cannot_hold_is_refused() {
    let refused = |bend: &dyn Fn(&mut MorphMesh)| {
        let mut mesh = generated::dolphin(0);
        bend(&mut mesh);
        to_glb(&mesh, &Appearance::default()).err()
    };
    assert!(matches!(
        refused(&|m| *m = MorphMesh::default()),
        Some(WriteError::Empty(_))
    ));
    assert!(matches!(
        refused(&|m| m.targets[1].truncate(5)),
        Some(WriteError::Length { index: 1, found: 5, .. })
    ));
    assert!(matches!(
        refused(&|m| m.triangles[9][1] = 1000),
        Some(WriteError::OutOfRange { index: 9, .. })
    ));
    assert!(matches!(
        refused(&|m| m.animations[0].weights[3].clear()),
        Some(WriteError::Length { found: 0, .. })
    ));
}
