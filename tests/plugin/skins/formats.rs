//! The supported formats of meshes and skeletons.

use bevy::mesh::skinning::SkinnedMesh;
use bevy::mesh::{AttributeQuantization, VertexAttributeValues};
use bevy::prelude::*;
use bevy_morph_collision::import::{ImportError, MorphTrees};
use bevy_morph_collision::morph_collision::ModelError;
use bevy_morph_collision::prelude::*;

use super::{add, along_x, boned, extent, limb, skeleton, spawn_joints, spawn_limb, spawn_skinned};
use crate::log::Errors;
use crate::support::{Edits, add_mesh, app, bevy_mesh, cube, settle, spawn, stretching_cube};

/// The extent of a limb in some format if its joints are at -2 and 4; `None` if it is refused.
fn stretched(mesh: Mesh) -> Option<(f32, f32)> {
    let mut app = app();
    let mesh = add(&mut app, mesh);
    let joints = spawn_joints(&mut app, [Vec3::X * -2.0, Vec3::X * 4.0]);
    let skin = skeleton(&mut app, &joints);
    let limb = spawn_skinned(&mut app, &mesh, skin);
    settle(&mut app);
    along_x(&mut app, limb)
}

#[test]
fn compressed_joints_and_weights_are_read() {
    let VertexAttributeValues::Uint16x4(wide) = limb().attribute(Mesh::ATTRIBUTE_JOINT_INDEX).unwrap().clone() else {
        panic!("joints are made like this")
    };
    // All formats that Bevy's shader reads as numbers, however the attribute is declared.
    let narrow = |joints: [u16; 4]| joints.map(|joint| joint as u8);
    let narrow = VertexAttributeValues::Uint8x4(wide.iter().copied().map(narrow).collect());
    let mut with_narrow = limb();
    with_narrow.insert_attribute(uint8_joints(), narrow);
    assert_eq!(stretched(with_narrow), Some((-2.5, 4.5)));
    use AttributeQuantization::{Float16, Snorm8, Snorm16, Unorm8, Unorm16};
    for quantization in [Unorm16, Unorm8, Snorm16, Snorm8, Float16] {
        let mut mesh = limb();
        mesh.quantize_joint_weights(quantization).expect("weights are floats");
        assert_eq!(stretched(mesh), Some((-2.5, 4.5)), "{quantization:?}");
    }
}

/// The joint attribute, declared with bytes.
fn uint8_joints() -> bevy::mesh::MeshVertexAttribute {
    let mut attribute = Mesh::ATTRIBUTE_JOINT_INDEX;
    attribute.format = bevy::mesh::VertexFormat::Uint8x4;
    attribute
}

#[test]
fn a_mesh_with_half_of_the_attributes_is_rigid_as_bevy_draws_it() {
    for missing in [Mesh::ATTRIBUTE_JOINT_INDEX, Mesh::ATTRIBUTE_JOINT_WEIGHT] {
        let mut mesh = limb();
        mesh.remove_attribute(missing.id);
        assert_eq!(stretched(mesh), Some((99.5, 100.5)));
    }
    assert_eq!(stretched(bevy_mesh(&cube())), Some((99.5, 100.5)));
}

#[test]
fn one_mesh_is_shown_with_and_without_a_skeleton() {
    let mut app = app();
    let (limb, _) = spawn_limb(&mut app, 2.0);
    let mesh = app.world().get::<Mesh3d>(limb).unwrap().clone();
    let plain = spawn(&mut app, &mesh.0, 50.0);
    settle(&mut app);
    assert_eq!(along_x(&mut app, limb), Some((-0.5, 2.5)));
    assert_eq!(along_x(&mut app, plain), Some((49.5, 50.5)));
    let trees = app.world().resource::<MorphTrees>();
    assert_eq!(trees.iter().count(), 2);
    let skin = app.world().get::<SkinnedMesh>(limb);
    let skinned = trees.shown_with(&mesh, None, skin).unwrap();
    assert_eq!(skinned.model().joint_count(), Some(2));
    assert_eq!(trees.get(mesh.id()).unwrap().model().joint_count(), None);
    // Each tree is dropped when nothing shows it any more.
    app.world_mut().despawn(limb);
    settle(&mut app);
    let trees = app.world().resource::<MorphTrees>();
    assert_eq!(trees.iter().count(), 1);
    assert!(trees.get(mesh.id()).is_some());
}

#[test]
fn the_tree_for_a_skeleton_goes_with_the_last_skeleton() {
    let mut app = app();
    let (limb, _) = spawn_limb(&mut app, 2.0);
    let mesh = app.world().get::<Mesh3d>(limb).unwrap().clone();
    spawn(&mut app, &mesh.0, 50.0);
    settle(&mut app);
    let joint_counts = |app: &App| -> Vec<Option<usize>> {
        let trees = app.world().resource::<MorphTrees>().iter();
        let mut counts: Vec<_> = trees.map(|(_, tree)| tree.model().joint_count()).collect();
        counts.sort_unstable();
        counts
    };
    assert_eq!(joint_counts(&app), [None, Some(2)]);
    // Needs nothing new, because the other tree exists.
    app.remove::<SkinnedMesh>(limb);
    app.update();
    app.update();
    assert_eq!(joint_counts(&app), [None]);
    assert_eq!(along_x(&mut app, limb), Some((99.5, 100.5)));
}

#[test]
fn more_than_256_joints_are_followed() {
    let mut app = app();
    let mesh = add(&mut app, boned(&cube(), |p| if p.x > 0.0 { 299 } else { 256 }));
    let joints: Vec<Entity> = (0..300)
        .map(|joint| app.spawn(Transform::from_xyz(joint as f32, 0.0, 0.0)))
        .collect();
    let skin = skeleton(&mut app, &joints);
    let cube = spawn_skinned(&mut app, &mesh, skin);
    settle(&mut app);
    assert_eq!(along_x(&mut app, cube), Some((255.5, 299.5)));
}

#[test]
fn weights_that_miss_1_pull_towards_the_origin() {
    let mut mesh = boned(&cube(), |_| 0);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[0.5_f32, 0.0, 0.0, 0.0]; 8]);
    assert_eq!(stretched(mesh), Some((-1.25, -0.75)));
}

/// Checks that an error is the expected one.
type Expected = fn(&ImportError) -> bool;

/// The log and the plugin's error about a mesh shown with two joints.
fn refusal(mesh: Mesh) -> (Vec<String>, Option<ImportError>) {
    let mut said = (Vec::new(), None);
    Errors::collect(|log| {
        let mut app = app();
        let mesh = add(&mut app, mesh);
        let joints = spawn_joints(&mut app, [Vec3::ZERO; 2]);
        let skin = skeleton(&mut app, &joints);
        let limb = spawn_skinned(&mut app, &mesh, skin);
        app.insert(limb, Name::new("limb"));
        settle(&mut app);
        assert_eq!(extent(&mut app, limb), None);
        said = (
            log.take(),
            app.world().resource::<MorphTrees>().error(mesh.id()).cloned(),
        );
    });
    said
}

#[test]
fn influences_that_cannot_be_used_are_errors_that_name_the_entity() {
    let weights = |weights: [f32; 4]| limb().with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![weights; 8]);
    let floats = |attribute: bevy::mesh::MeshVertexAttribute| {
        let mut attribute = attribute;
        attribute.format = bevy::mesh::VertexFormat::Float32x2;
        limb().with_inserted_attribute(attribute, vec![[0.0_f32; 2]; 8])
    };
    let expected: [(Mesh, Expected); 6] = [
        (boned(&cube(), |_| 2), |error| {
            matches!(
                error,
                ImportError::Model(ModelError::JointOutOfRange {
                    joint: 2,
                    joint_count: 2,
                    ..
                })
            )
        }),
        (weights([-0.5, 1.5, 0.0, 0.0]), |error| {
            matches!(error, ImportError::Model(ModelError::BadInfluence { .. }))
        }),
        (weights([f32::NAN; 4]), |error| {
            matches!(error, ImportError::Model(ModelError::BadInfluence { .. }))
        }),
        (weights([1e6, 0.0, 0.0, 0.0]), |error| {
            matches!(error, ImportError::Model(ModelError::BadInfluence { .. }))
        }),
        (floats(Mesh::ATTRIBUTE_JOINT_INDEX), |error| {
            matches!(error, ImportError::JointFormat("Float32x2"))
        }),
        (floats(Mesh::ATTRIBUTE_JOINT_WEIGHT), |error| {
            matches!(error, ImportError::JointWeightFormat("Float32x2"))
        }),
    ];
    for (mesh, is_expected) in expected {
        let (logged, error) = refusal(mesh);
        assert!(error.as_ref().is_some_and(is_expected), "{error:?}");
        assert!(logged.len() == 1 && logged[0].contains("`limb`"), "{logged:?}");
    }
}

#[test]
fn scenes_and_the_setting_for_all_meshes_take_skinned_ones() {
    let mut app = app();
    let (limb, _) = spawn_limb(&mut app, 1.0);
    let rigid = add_mesh(&mut app, &stretching_cube());
    let root = app.spawn(MorphColliderScene::default());
    let rigid = app.spawn((Mesh3d(rigid), ChildOf(root)));
    app.world_mut()
        .entity_mut(limb)
        .remove::<MorphCollider>()
        .insert(ChildOf(root));
    settle(&mut app);
    let is_collider = |app: &App, entity: Entity| app.world().get::<MorphCollider>(entity).is_some();
    assert!(is_collider(&app, limb) && !is_collider(&app, rigid));
    let skin = app.world().get::<SkinnedMesh>(limb).unwrap().clone();
    app.remove::<SkinnedMesh>(limb);
    app.update();
    assert!(!is_collider(&app, limb), "it is rigid now");
    app.world_mut().despawn(root);

    let (limb, _) = spawn_limb(&mut app, 1.0);
    app.world_mut().entity_mut(limb).remove::<MorphCollider>().insert(skin);
    app.settings().every_deforming_mesh = Some(MorphCollider::default());
    app.update();
    assert!(is_collider(&app, limb));
}
