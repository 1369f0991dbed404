//! Skins survive being written and read again.

use std::error::Error;

use glam::{Affine3A, Mat4, Quat, Vec3, Vec4};
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::generated::{rigid, rigs};
use morph_collision_models::gltf::read::{parse_meshes, read_meshes};
use morph_collision_models::gltf::write::{Appearance, WriteError, to_glb};
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::{Interpolation, Joint, JointChannel, JointClip, Property, Skeleton};
use morph_collision_testkit::moments::real_model;

fn round_trip(mesh: &MorphMesh) -> Result<MorphMesh, Box<dyn Error>> {
    let bytes = to_glb(mesh, &Appearance::default())?;
    let mut read = parse_meshes(&bytes, "model.glb".as_ref())?;
    assert_eq!(read.len(), 1);
    Ok(read.remove(0))
}

fn skeleton(mesh: &MorphMesh) -> &Skeleton {
    &mesh.skin.as_ref().expect("the mesh is skinned").skeleton
}

/// Vertices, influences and clips are the same, and so are the matrices of joints at rest and at several times of each clip.
#[track_caller]
fn assert_same(written: &MorphMesh, read: &MorphMesh) {
    assert_eq!(
        (&read.positions, &read.targets, &read.triangles),
        (&written.positions, &written.targets, &written.triangles)
    );
    assert_eq!(read.animations, written.animations);
    let sets = |mesh: &MorphMesh| mesh.skin.as_ref().map(|skin| skin.sets.clone());
    assert_eq!(sets(read), sets(written));
    let [before, after] = [skeleton(written), skeleton(read)];
    assert_eq!(after.at_rest(), before.at_rest());
    assert_eq!(after.clips.len(), before.clips.len());
    for (old, new) in before.clips.iter().zip(&after.clips) {
        assert_eq!(new.name, old.name);
        for step in 0..=16 {
            let time = old.duration() * 0.07 * step as f32;
            let [old, new] = [
                before.world_from_mesh(Some(old), time),
                after.world_from_mesh(Some(new), time),
            ];
            assert_eq!(new, old, "at {time}");
        }
    }
}

#[test]
fn real_characters_survive_the_round_trip() -> Result<(), Box<dyn Error>> {
    for file in [
        "mh_character.glb",
        "mh_character_low.glb",
        "RobotExpressive.glb",
        "Fox.glb",
    ] {
        let Some(path) = real_model(file) else { continue };
        let mut clips = 0;
        for mesh in read_meshes(&path)?.iter().filter(|mesh| mesh.skin.is_some()) {
            let read = round_trip(mesh)?;
            assert_same(mesh, &read);
            // Nodes are compared as well, because they have one root.
            assert_eq!(&read, mesh, "{file}");
            clips += skeleton(mesh).clips.len();
        }
        assert!(clips >= 3, "{file} has {clips} clips");
    }
    Ok(())
}

#[test]
fn generated_rigs_survive_the_round_trip() -> Result<(), Box<dyn Error>> {
    for mesh in [
        rigs::tube(1, 6, 4, 3),
        rigs::branching(2, 20, 8, 2),
        rigs::rigid_pieces(3, 7, 0),
        rigs::unnormalised(&rigs::tube(4, 3, 2, 1), 5),
        // Joints without a common parent.
        rigs::random_soup(6, 40, 30, 2, 2),
        // Numbers of joints that just fit 8 bits, and that need 16.
        rigs::random_soup(7, 300, 256, 0, 1),
        rigs::random_soup(8, 300, 257, 0, 2),
    ] {
        let read = round_trip(&mesh)?;
        assert_same(&mesh, &read);
        assert_eq!(read.to_model()?.joint_count(), mesh.to_model()?.joint_count());
    }
    Ok(())
}

/// Two joints, one the child of the other, and a box that follows them.
fn two_joints() -> MorphMesh {
    let mut mesh = rigid::box_mesh(Vec3::ONE);
    let vertices = mesh.positions.len();
    let mut skeleton = Skeleton::separate(2);
    skeleton.nodes[0].rest.scale = Vec3::new(2.0, 1.0, -1.0);
    skeleton.nodes[0].rest.rotation = Quat::from_rotation_x(0.3);
    skeleton.nodes[1].rest.translation = Vec3::new(0.1, 0.2, 0.3);
    skeleton.nodes[1].parent = Some(0);
    skeleton.joints = vec![
        Joint {
            node: 1,
            inverse_bind: Mat4::from_translation(Vec3::Y),
        },
        Joint {
            node: 0,
            inverse_bind: Mat4::from(Affine3A::from_rotation_z(0.7)),
        },
    ];
    mesh.skin = Some(MeshSkin {
        sets: vec![InfluenceSet {
            joints: vec![[0, 1, 0, 1]; vertices],
            weights: vec![[0.5, 0.25, 0.0, 0.0]; vertices],
        }],
        skeleton,
    });
    mesh
}

fn clip(name: &str, property: Property, interpolation: Interpolation, values: &[Vec4]) -> JointClip {
    let keys = if interpolation == Interpolation::CubicSpline {
        values.len() / 3
    } else {
        values.len()
    };
    JointClip {
        name: name.to_owned(),
        channels: vec![JointChannel {
            node: 1,
            property,
            interpolation,
            times: (0..keys).map(|key| 0.5 * key as f32).collect(),
            values: values.to_vec(),
        }],
        end: 0.0,
    }
}

#[test]
fn every_property_and_interpolation_survives() -> Result<(), Box<dyn Error>> {
    let mut mesh = two_joints();
    let turned = |angle: f32| Vec4::from(Quat::from_rotation_y(angle));
    let moved = |x: f32| Vec4::new(x, 2.0 * x, 3.0 * x, 0.0);
    mesh.skin.as_mut().expect("skinned").skeleton.clips = vec![
        clip(
            "a",
            Property::Rotation,
            Interpolation::Linear,
            &[turned(0.0), turned(1.0), turned(-2.0)],
        ),
        clip("b", Property::Scale, Interpolation::Step, &[moved(1.0), moved(0.5)]),
        clip(
            "c",
            Property::Translation,
            Interpolation::CubicSpline,
            &[0.1, 0.2, 0.3, 0.4, -0.5, 0.6].map(moved),
        ),
        clip(
            "d",
            Property::Rotation,
            Interpolation::CubicSpline,
            &[0.1, 0.2, 0.3, 0.4, -0.5, 0.6].map(turned),
        ),
    ];
    let read = round_trip(&mesh)?;
    assert_same(&mesh, &read);
    let moves = |clip: &JointClip| skeleton(&read).world_from_mesh(Some(clip), 0.2) != skeleton(&read).at_rest();
    assert!(skeleton(&read).clips.iter().all(moves));
    Ok(())
}

#[test]
fn clips_of_weights_and_joints_with_one_name_are_one_animation() -> Result<(), Box<dyn Error>> {
    let mut mesh = two_joints();
    mesh.targets = vec![vec![Vec3::X; mesh.positions.len()]];
    mesh.target_names = vec!["wider".into()];
    let weights = |name: &str| WeightAnimation {
        name: name.into(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0], vec![1.0]],
        ..WeightAnimation::default()
    };
    mesh.animations = ["talk", "both", "blink"].map(weights).to_vec();
    // Clips of one animation last equally long.
    let joints = |name| {
        clip(
            name,
            Property::Scale,
            Interpolation::Linear,
            &[Vec4::ONE, Vec4::X, Vec4::ONE],
        )
    };
    // The last two have the opposite order among the weight clips, so one has to become a separate animation.
    mesh.skin.as_mut().expect("skinned").skeleton.clips = ["walk", "both", "blink", "talk"].map(joints).to_vec();
    let bytes = to_glb(&mesh, &Appearance::default())?;
    let text = String::from_utf8_lossy(&bytes);
    let animations = text.split_once("\"animations\":").expect("animations").1;
    let animations = animations.split_once("\"asset\"").expect("the next key").0;
    for (name, count) in [("walk", 1), ("both", 1), ("blink", 1), ("talk", 2)] {
        assert_eq!(animations.matches(&format!("\"{name}\"")).count(), count, "{name}");
    }
    let mut read = round_trip(&mesh)?;
    // Animations of a file get different names.
    let separate = &mut read.skin.as_mut().expect("skinned").skeleton.clips[3].name;
    assert_eq!(std::mem::replace(separate, "talk".into()), "talk (animation 4)");
    assert_same(&mesh, &read);
    Ok(())
}

#[test]
fn skins_that_gltf_cannot_hold_are_refused() {
    let refused = |bend: &dyn Fn(&mut MeshSkin)| {
        let mut mesh = two_joints();
        bend(mesh.skin.as_mut().expect("skinned"));
        to_glb(&mesh, &Appearance::default())
            .map(|bytes| bytes.len())
            .unwrap_err()
    };
    assert!(matches!(
        refused(&|skin| skin.skeleton.joints.clear()),
        WriteError::NoJoints(_)
    ));
    assert!(matches!(
        refused(&|skin| skin.sets[0].weights.truncate(3)),
        WriteError::Length { index: 0, found: 3, .. }
    ));
    let out_of_range = |bend: &dyn Fn(&mut MeshSkin)| match refused(bend) {
        WriteError::OutOfRange { what, index, .. } => (what, index),
        other => panic!("{other}"),
    };
    assert_eq!(
        out_of_range(&|skin| skin.sets[0].joints[5][3] = 2),
        ("the influences of vertex", 5)
    );
    assert_eq!(
        out_of_range(&|skin| skin.skeleton.nodes[0].parent = Some(0)),
        ("the parent of node", 0)
    );
    assert_eq!(out_of_range(&|skin| skin.skeleton.joints[1].node = 2), ("joint", 1));
    let lost = |skin: &mut MeshSkin| {
        let mut clip = clip("lost", Property::Scale, Interpolation::Step, &[Vec4::ONE]);
        clip.channels[0].node = 9;
        skin.skeleton.clips = vec![clip];
    };
    assert_eq!(out_of_range(&lost), ("a channel of the joints' clip", 0));
    assert!(matches!(
        refused(&|skin| skin.skeleton.nodes[1].rest.scale.y = f32::NAN),
        WriteError::NotFinite { index: 1, .. }
    ));
    let short = |skin: &mut MeshSkin| {
        let mut clip = clip("short", Property::Scale, Interpolation::Step, &[Vec4::ONE; 2]);
        clip.channels[0].values.pop();
        skin.skeleton.clips = vec![clip];
    };
    assert!(matches!(
        refused(&short),
        WriteError::Length {
            found: 1,
            expected: 2,
            ..
        }
    ));
}
