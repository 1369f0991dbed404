//! Components on entities where they have no effect.

use std::path::Path;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use bevy_morph_collision::prelude::*;

use super::{PATIENCE, files, is_fine, load, only_warning, run, says, spawn_scene, warning_about, with_app};
use crate::support::{Edits, add_mesh, cube, spawn, stretching_cube};

/// The warning about a component on the root of the scene of a file, logged before the file is loaded.
fn on_root(more: impl Bundle) -> String {
    let (_folder, path) = files();
    let mut warning = None;
    with_app(&path, |app, errors| {
        let root = spawn_scene(app, "morphs.glb#Scene0", more);
        app.update();
        let at_once = errors.take_warnings();
        assert_eq!(at_once.len(), 1, "{at_once:?}");
        load(app, root);
        run(app, PATIENCE);
        assert_eq!((errors.take_warnings(), errors.take()), (vec![], vec![]), "once");
        warning = at_once.into_iter().next();
    });
    warning.unwrap()
}

#[test]
fn a_collider_on_a_scene_names_the_component_for_scenes() {
    let warning = on_root(MorphCollider::default());
    says(
        &warning,
        &[
            "`MorphCollider` has no effect",
            "`Boss`",
            "morphs.glb#Scene0",
            "Use `MorphColliderScene` instead",
        ],
    );
}

#[test]
fn what_the_component_for_scenes_decides_is_set_there() {
    let scene = MorphColliderScene::default;
    let warning = on_root((scene(), MorphCollider::default()));
    says(&warning, &["Remove it, and set `MorphColliderScene::collider`"]);
    says(
        &on_root((scene(), MorphCollisionLayers::new(1, 2))),
        &["set `MorphColliderScene::layers`"],
    );
    says(
        &on_root((scene(), MorphCollisionEventsEnabled)),
        &["set `MorphColliderScene::events`"],
    );
    let on_parts = ["put it on a part", "`MorphColliders`"];
    says(&on_root((scene(), MorphColliderDisabled)), &on_parts);
    says(&on_root((scene(), MorphSelfCollisions::default())), &on_parts);
    says(&on_root((scene(), MorphTreeOptions::default())), &on_parts);
}

#[test]
fn equal_scenes_with_the_same_mistake_are_one_message() {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        for _ in 0..100 {
            spawn_scene(app, "morphs.glb#Scene0", MorphCollider::default());
        }
        only_warning(app, errors);
        spawn_scene(app, "rigid.glb#Scene0", MorphCollider::default());
        says(&only_warning(app, errors), &["rigid.glb#Scene0"]);
    });
}

#[test]
fn messages_of_a_kind_come_to_an_end() {
    with_app(Path::new("."), |app, errors| {
        for i in 0..1000 {
            app.spawn((MorphCollider::default(), Name::new(format!("Bullet {i}"))));
        }
        run(app, 2 * PATIENCE);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 10);
        assert!(
            warnings[9].ends_with("Further ones like it are not logged"),
            "{}",
            warnings[9]
        );
    });
}

#[test]
fn a_collider_that_never_gets_a_mesh_is_told_after_some_time() {
    let named = |name: &'static str| (MorphCollider::default(), Name::new(name));
    let warning = warning_about(|app| {
        app.spawn(named("Sword"));
    });
    says(
        &warning,
        &[
            "`Sword`",
            "neither a `Mesh3d` nor a `MorphShape`",
            "Put `MorphCollider` on the entity that has the mesh",
        ],
    );
    let warning = warning_about(|app| {
        let mesh = add_mesh(app, &cube());
        app.spawn((named("Arm"), children![children![Mesh3d(mesh)]]));
    });
    says(
        &warning,
        &["`Arm`", "meshes on entities below it", "`MorphColliderScene`"],
    );
    // It gets one in time.
    is_fine(|app| {
        let late = app.spawn(named("Late"));
        run(app, 250);
        let mesh = add_mesh(app, &cube());
        app.insert(late, Mesh3d(mesh));
    });
    // It waits for a scene, which may bring it.
    is_fine(|app| {
        let reserved = app.world().resource::<Assets<WorldAsset>>().reserve_handle();
        app.spawn(WorldAssetRoot(reserved));
        app.spawn(named("Waiting"));
    });
}

#[test]
fn what_only_a_collider_uses_is_told_without_one() {
    let told = |more: fn(&mut EntityWorldMut)| {
        warning_about(|app| {
            let mesh = add_mesh(app, &cube());
            more(&mut app.world_mut().spawn((Mesh3d(mesh), Name::new("Crate"))));
        })
    };
    let without = ["`Crate`", "has no `MorphCollider`"];
    says(
        &told(|crate_| {
            crate_.insert(MorphCollisionLayers::default());
        }),
        &without,
    );
    says(
        &told(|crate_| {
            crate_.insert(MorphCollisionEventsEnabled);
        }),
        &without,
    );
    says(
        &told(|crate_| {
            crate_.insert(MorphColliderDisabled);
        }),
        &without,
    );
    says(
        &told(|crate_| {
            crate_.insert(MorphSelfCollisions::default());
        }),
        &without,
    );
    says(
        &told(|crate_| {
            crate_.insert(MorphTreeOptions::default());
        }),
        &without,
    );
    let warning = warning_about(|app| {
        let body = app.world_mut().spawn_empty().id();
        app.spawn((Name::new("Crate"), MorphColliderOf { body }));
    });
    says(&warning, &["`MorphColliderOf`", "`Crate`", "has no `MorphCollider`"]);
    let warning = told(|crate_| {
        crate_.insert(MorphCollidingEntities::default());
    });
    says(
        &warning,
        &["`MorphCollidingEntities`", "`Crate`", "neither a collider nor a body"],
    );
    let warning = told(|crate_| {
        crate_.insert(MorphBodyRoot);
    });
    says(
        &warning,
        &[
            "`MorphBodyRoot`",
            "`Crate`",
            "`MorphCollisionSettings::every_deforming_mesh` is not set",
        ],
    );
    let warning = told(|crate_| {
        crate_.insert(MorphTeleported);
    });
    says(
        &warning,
        &["`MorphTeleported`", "`Crate`", "no collider is at or below it"],
    );
}

#[test]
fn what_a_shape_does_not_use_is_told() {
    let told = |more: fn(&mut EntityWorldMut)| {
        warning_about(|app| {
            let mesh = add_mesh(app, &cube());
            let shape = (MorphShape::default(), Name::new("Ball"));
            more(&mut app.world_mut().spawn((Mesh3d(mesh), shape)));
        })
    };
    let shape = ["`Ball`", "its `MorphShape` collides instead of a mesh"];
    says(
        &told(|ball| {
            ball.insert(MorphSelfCollisions::default());
        }),
        &shape,
    );
    says(
        &told(|ball| {
            ball.insert(MorphTreeOptions::default());
        }),
        &shape,
    );
}

#[test]
fn components_where_they_belong_are_not_told() {
    is_fine(|app| {
        let setting = MorphCollisionSettings {
            every_deforming_mesh: Some(MorphCollider::default()),
            ..default()
        };
        app.insert_resource(setting);
        let [rigid, morphs] = [cube(), stretching_cube()].map(|mesh| add_mesh(app, &mesh));
        let collider = spawn(app, &rigid, 0.0);
        let body = app.spawn(MorphCollidingEntities::default());
        app.insert(
            collider,
            (
                MorphSelfCollisions::default(),
                MorphTreeOptions { leaf_size: 3 },
                MorphCollisionEventsEnabled,
                MorphCollidingEntities::default(),
                MorphColliderOf { body },
                MorphTeleported,
            ),
        );
        app.spawn((MorphShape::default(), MorphColliderDisabled));
        // These become colliders by the setting.
        let weights = || MeshMorphWeights::Value { weights: vec![0.0] };
        app.spawn((MorphBodyRoot, children![(Mesh3d(morphs.clone()), weights())]));
        app.spawn((
            Mesh3d(morphs),
            weights(),
            MorphBodyRoot,
            MorphCollisionLayers::default(),
        ));
        // A body is teleported, and an entity above one.
        app.update();
        app.insert(body, MorphTeleported);
        let above = app.world_mut().spawn(MorphTeleported).add_child(collider).id();
        app.update();
        assert!(!app.world().entity(above).contains::<MorphTeleported>());
    });
}
