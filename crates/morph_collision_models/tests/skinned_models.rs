//! Real skinned models, if they are available.

use std::error::Error;

use glam::Affine3A;
use morph_collision_models::clip::looped;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::{MeshSkin, MorphMesh};
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices};

fn skinned_meshes(file: &str) -> Result<Vec<(MorphMesh, MeshSkin)>, Box<dyn Error>> {
    let Some(path) = real_model(file) else {
        return Ok(Vec::new());
    };
    let meshes = read_meshes(&path)?.into_iter();
    Ok(meshes.filter_map(|mesh| Some((mesh.clone(), mesh.skin?))).collect())
}

#[test]
fn the_known_counts_are_found() -> Result<(), Box<dyn Error>> {
    for (file, meshes, joints, clips) in [
        (
            "mh_character.glb",
            1,
            53,
            &["walk", "wave_and_crouch", "talk", "walk_and_talk"][..],
        ),
        (
            "mh_character_low.glb",
            1,
            53,
            &["walk", "wave_and_crouch", "talk", "walk_and_talk"],
        ),
        ("Fox.glb", 1, 24, &["Survey", "Walk", "Run"]),
    ] {
        let found = skinned_meshes(file)?;
        if found.is_empty() {
            continue;
        }
        assert_eq!(found.len(), meshes, "{file}");
        let (mesh, skin) = &found[0];
        assert_eq!((skin.joint_count(), skin.sets.len()), (joints, 1), "{file}");
        let names: Vec<_> = skin.skeleton.clips.iter().map(|clip| &*clip.name).collect();
        // A clip of only the face moves no joint.
        let expected: Vec<_> = clips
            .iter()
            .copied()
            .filter(|name| names.contains(name) || *name != "talk")
            .collect();
        assert_eq!(names, expected, "{file}");
        assert_eq!(mesh.to_model()?.joint_count(), Some(joints));
    }
    Ok(())
}

#[test]
fn a_robot_s_hands_are_skinned_and_its_other_meshes_are_not() -> Result<(), Box<dyn Error>> {
    let Some(path) = real_model("RobotExpressive.glb") else {
        return Ok(());
    };
    let meshes = read_meshes(&path)?;
    let skinned: Vec<_> = meshes.iter().filter(|mesh| mesh.skin.is_some()).collect();
    assert_eq!((meshes.len() > 2, skinned.len()), (true, 2));
    for mesh in skinned {
        let skin = mesh.skin.as_ref().ok_or("no skin")?;
        assert_eq!(skin.skeleton.clips.len(), 14);
        assert_eq!(mesh.to_model()?.joint_count(), Some(skin.joint_count()));
    }
    Ok(())
}

/// How far the rest pose is from the bind pose's shape.
fn rest_error(mesh: &MorphMesh, skin: &MeshSkin) -> f64 {
    let rest = skinned_vertices(&mesh.positions, &skin.sets, &skin.skeleton.at_rest());
    let apart = mesh
        .positions
        .iter()
        .zip(rest)
        .map(|(bound, rest)| bound.as_dvec3().distance(rest));
    apart.fold(0.0, f64::max)
}

#[test]
fn a_character_at_rest_is_the_shape_it_was_bound_in() -> Result<(), Box<dyn Error>> {
    for file in ["mh_character.glb", "mh_character_low.glb"] {
        for (mesh, skin) in skinned_meshes(file)? {
            let error = rest_error(&mesh, &skin);
            println!("{file}: {error:e} dm");
            // The model's README says 4.3e-7 dm for f64 matrices; ours are f32, and the character is 17 dm tall.
            assert!(error < 1e-5, "{error}");
            // No joint is useless: moving it moves vertices.
            for joint in 0..skin.joint_count() {
                let used = skin.sets.iter().any(|set| {
                    let mut both = set.joints.iter().flatten().zip(set.weights.iter().flatten());
                    both.any(|(&of, &weight)| usize::from(of) == joint && weight > 0.0)
                });
                let mut moved = skin.skeleton.at_rest();
                moved[joint] = Affine3A::from_translation(glam::Vec3::X) * moved[joint];
                let world = skinned_vertices(&mesh.positions, &skin.sets, &moved);
                let far = mesh
                    .positions
                    .iter()
                    .zip(world)
                    .any(|(p, world)| p.as_dvec3().distance(world) > 1e-4);
                assert_eq!(far, used, "joint {joint}");
            }
        }
    }
    Ok(())
}

/// Computed from the file in `f64` by another program, with quaternions interpolated by `acos` and `sin`.
#[test]
#[rustfmt::skip]
fn joints_of_the_fox_are_where_another_program_finds_them() -> Result<(), Box<dyn Error>> {
    let expected: [(&str, f32, usize, [f32; 12]); 4] = [
        ("Survey", 1.3, 6, [0.623909, -0.040108, -0.780467, 0.144173, 0.987448, 0.064508, 0.768083, -0.152769, 0.62186, -34.585907, 5.296309, 11.529073]),
        ("Survey", 1.3, 23, [1.0, -0.000136, 4.2e-05, 0.000136, 1.0, 0.0, -4.2e-05, -0.0, 1.0, -0.003739, -0.00101, 1.141955]),
        ("Run", 0.4, 6, [1.0, -0.0, 0.0, 0.0, 0.999523, 0.030896, -0.0, -0.030896, 0.999523, -2e-05, -7.982776, 4.112377]),
        ("Run", 0.4, 17, [0.990108, 0.13792, -0.02576, -0.016837, 0.299069, 0.954083, 0.139291, -0.944212, 0.298433, 6.526326, -6.165836, -55.187028]),
    ];
    for (_, skin) in skinned_meshes("Fox.glb")? {
        for (clip, seconds, joint, entries) in expected {
            let clip = skin.skeleton.clip(clip).ok_or("no such clip")?;
            let found = skin.skeleton.world_from_mesh(Some(clip), seconds)[joint];
            assert!(found.abs_diff_eq(Affine3A::from_cols_array(&entries), 2e-4), "{joint}: {found:?}");
            // A loop later it is the same.
            let later = looped(seconds + clip.duration(), clip.duration());
            let later = skin.skeleton.world_from_mesh(Some(clip), later)[joint];
            assert!(found.abs_diff_eq(later, 2e-3), "{later:?}");
        }
    }
    Ok(())
}

#[test]
fn clips_move_characters_and_keep_them_whole() -> Result<(), Box<dyn Error>> {
    for file in ["mh_character_low.glb", "Fox.glb"] {
        for (mesh, skin) in skinned_meshes(file)? {
            let posed = posed_vertices(&mesh.positions, &mesh.targets, &vec![0.0; mesh.targets.len()]);
            for clip in &skin.skeleton.clips {
                let at =
                    |seconds| skinned_vertices(&posed, &skin.sets, &skin.skeleton.world_from_mesh(Some(clip), seconds));
                let (start, middle) = (at(0.0), at(clip.duration() * 0.4));
                let size = |points: &[glam::DVec3]| points.iter().map(|p| p.distance(points[0])).fold(0.0, f64::max);
                let moved = start
                    .iter()
                    .zip(&middle)
                    .map(|(a, b)| a.distance(*b))
                    .fold(0.0, f64::max);
                assert!(moved > 0.01 * size(&start), "{file}, {}: {moved}", clip.name);
                let ratio = size(&middle) / size(&start);
                assert!((0.3..3.0).contains(&ratio), "{file}, {}: {ratio}", clip.name);
            }
        }
    }
    Ok(())
}
