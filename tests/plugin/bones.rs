//! Bones are not followed, and whoever has some is told.

use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::log::Errors;
use crate::support::{app, bevy_mesh, cube, settle, spawn};

/// A cube whose vertices all follow one bone.
fn boned_cube() -> Mesh {
    bevy_mesh(&cube())
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_JOINT_INDEX,
            VertexAttributeValues::Uint16x4(vec![[0; 4]; 8]),
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0_f32, 0.0, 0.0, 0.0]; 8])
}

fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

fn spawn_skinned(app: &mut App, mesh: &Handle<Mesh>, name: &'static str) -> Entity {
    let entity = spawn(app, mesh, 0.0);
    app.world_mut()
        .entity_mut(entity)
        .insert((SkinnedMesh::default(), Name::new(name)));
    entity
}

#[test]
fn each_mesh_with_bones_is_warned_of_once() {
    Errors::collect(|log| {
        let mut app = app();
        let [shared, other] = [boned_cube(), boned_cube()].map(|mesh| add(&mut app, mesh));
        for name in ["first", "second", "third"] {
            spawn_skinned(&mut app, &shared, name);
        }
        settle(&mut app);
        let logged = log.take_warnings();
        assert_eq!(logged.len(), 1, "{logged:?}");
        for part in [shared.id().to_string().as_str(), "first", "bones", "bind pose"] {
            assert!(logged[0].contains(part), "{logged:?} does not say {part}");
        }

        spawn_skinned(&mut app, &other, "another mesh");
        spawn_skinned(&mut app, &shared, "the same mesh");
        settle(&mut app);
        let logged = log.take_warnings();
        assert_eq!(logged.len(), 1, "{logged:?}");
        assert!(logged[0].contains("another mesh"), "{logged:?}");
        assert_eq!(log.take(), [""; 0]);
    });
}

#[test]
fn a_mesh_that_is_loaded_late_is_warned_of_then() {
    Errors::collect(|log| {
        let mut app = app();
        let handle = app.world().resource::<Assets<Mesh>>().reserve_handle();
        spawn_skinned(&mut app, &handle, "late");
        settle(&mut app);
        assert_eq!(log.take_warnings(), [""; 0]);
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes.insert(&handle, boned_cube()).expect("the handle is reserved");
        settle(&mut app);
        assert_eq!(log.take_warnings().len(), 1);
    });
}

#[test]
fn what_no_bone_moves_is_not_warned_of() {
    Errors::collect(|log| {
        let mut app = app();
        let [boned, rigid] = [boned_cube(), bevy_mesh(&cube())].map(|mesh| add(&mut app, mesh));
        // Bevy draws all of these where their transforms are: a mesh without a skeleton, and a skeleton without a mesh to move.
        spawn(&mut app, &boned, 0.0);
        spawn_skinned(&mut app, &rigid, "no joints");
        // And this one is no collider.
        app.world_mut().spawn((Mesh3d(boned.clone()), SkinnedMesh::default()));
        // Here the shape collides, and not the mesh.
        let ball = spawn_skinned(&mut app, &boned, "ball");
        app.world_mut()
            .entity_mut(ball)
            .insert(MorphShape::Ball { radius: 1.0 });
        settle(&mut app);
        assert_eq!(log.take_warnings(), [""; 0]);
    });
}
