//! With `skip_bad`, a mesh with bad parts is read without them, and they are counted.

use glam::Vec3;
use morph_collision_models::gltf::read::{FoundMesh, GltfFile, ReadError, ReadOptions, Remedy, Skipped};
use serde_json::json;

use crate::support::{Document, U16, field, primitive};

const SKIP: ReadOptions = ReadOptions {
    memory_limit: 1 << 20,
    any_path: false,
    skip_bad: true,
};

/// Checks that a document is refused by default with a hint at the option, and reads it without its bad parts.
fn read(document: Document) -> Result<FoundMesh, ReadError> {
    let (_directory, path) = document.save();
    let refused = GltfFile::open(&path, &ReadOptions::default())?.mesh(0);
    let error = refused.expect_err("it has bad parts");
    assert_eq!(error.remedy(), Some(Remedy::SkipBad), "{error}");
    GltfFile::open(&path, &SKIP)?.mesh(0)
}

#[test]
fn a_target_that_a_primitive_lacks_does_not_move_it() -> Result<(), ReadError> {
    let path = field("c15_primitive_fewer_targets");
    let refused = GltfFile::open(&path, &ReadOptions::default())?.mesh(0);
    let error = refused.expect_err("the numbers of targets differ");
    assert!(
        error
            .to_string()
            .contains("primitive 1 has 2 morph targets, but primitive 0 has 1")
    );
    assert_eq!(error.remedy(), Some(Remedy::SkipBad));

    let file = GltfFile::open(&path, &SKIP)?;
    let FoundMesh { mesh, skipped, .. } = file.mesh(0)?;
    assert_eq!(
        (mesh.positions.len(), mesh.triangles.len(), mesh.targets.len()),
        (16, 24, 2)
    );
    assert_eq!(
        (mesh.targets[0][4], mesh.targets[0][12]),
        (Vec3::X * 2.0, Vec3::X * 2.0)
    );
    assert_eq!(mesh.targets[1][..8], [Vec3::ZERO; 8]);
    assert!(mesh.targets[1][8..].iter().any(|moved| *moved != Vec3::ZERO));
    assert_eq!(file.default_weights(0, None, 2)?, [1.0, 0.5]);
    assert_eq!(
        skipped,
        Skipped {
            triangles: 0,
            targets: 1
        }
    );
    assert_eq!(skipped.to_string(), "1 target of a primitive");
    Ok(())
}

#[test]
fn the_first_primitive_may_have_more_targets_than_the_others() -> Result<(), ReadError> {
    let mut document = Document::square(2);
    let positions = document.floats("VEC3", &[5.0; 9]);
    let list = document.json["meshes"][0]["primitives"].as_array_mut();
    list.expect("a list").push(primitive(positions, None, &[]));
    let FoundMesh { mesh, skipped, .. } = read(document)?;
    assert_eq!(mesh.targets[1], [[Vec3::Z; 4].as_slice(), &[Vec3::ZERO; 3]].concat());
    assert_eq!(
        skipped,
        Skipped {
            triangles: 0,
            targets: 2
        }
    );
    Ok(())
}

#[test]
fn a_target_of_another_length_does_not_move() -> Result<(), ReadError> {
    let mut document = Document::square(2);
    let short = document.floats("VEC3", &[9.0; 9]);
    document.json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = json!(short);
    let FoundMesh { mesh, skipped, .. } = read(document)?;
    assert_eq!(mesh.targets, [vec![Vec3::Z; 4], vec![]]);
    assert_eq!(
        skipped,
        Skipped {
            triangles: 0,
            targets: 1
        }
    );
    Ok(())
}

#[test]
fn triangles_beyond_the_vertices_and_incomplete_ones_are_dropped() -> Result<(), ReadError> {
    let of_corners = |mode: u32, corners: &[u16]| {
        let mut document = Document::square(1);
        let bytes: Vec<u8> = corners.iter().flat_map(|corner| corner.to_le_bytes()).collect();
        let indices = document.accessor(U16, "SCALAR", corners.len(), &bytes);
        let primitive = &mut document.json["meshes"][0]["primitives"][0];
        primitive["indices"] = json!(indices);
        primitive["mode"] = json!(mode);
        let found = read(document)?;
        assert_eq!(found.mesh.primitives[0], 0..found.mesh.triangles.len() as u32);
        Ok::<_, ReadError>((found.mesh.triangles, found.skipped.triangles))
    };
    let separate = of_corners(4, &[0, 1, 2, 0, 2, 4, 0, 2, 3, 65535, 0, 1, 2, 3])?;
    assert_eq!(separate, (vec![[0, 1, 2], [0, 2, 3]], 3));
    // The triangles around a bad corner of a strip are dropped, and the others keep their winding.
    let strip = of_corners(5, &[0, 1, 2, 9, 0, 1, 2])?;
    assert_eq!(strip, (vec![[0, 1, 2], [0, 1, 2]], 3));
    Ok(())
}

#[test]
fn a_sound_mesh_is_read_as_ever() -> Result<(), ReadError> {
    let (_directory, path) = Document::square(2).save();
    let found = |options: &ReadOptions| GltfFile::open(&path, options)?.mesh(0);
    let skipping = found(&SKIP)?;
    assert!(skipping.skipped.is_nothing());
    assert_eq!(skipping.skipped.to_string(), "nothing");
    assert_eq!(skipping, found(&ReadOptions::default())?);
    Ok(())
}
