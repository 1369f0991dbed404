//! Files that cannot be loaded, and meshes that are not there.

use std::path::Path;

use bevy::mesh::{Indices, VertexAttributeValues};
use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use bevy_morph_collision::import::MorphTreeProgress;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_workspace::app::update_until;

use super::{PATIENCE, files, load, only_warning, run, says, spawn_scene, warning_about, with_app};
use crate::support::{Edits, add_mesh, assets, bevy_mesh, cube, settle, spawn, stretching_cube};

#[derive(Clone, Debug, PartialEq)]
enum Heard {
    Ready(Entity),
    Failed(Entity, String),
    Scene(MorphColliderSceneReady),
}

#[derive(Resource, Default)]
struct Log(Vec<Heard>);

fn listen(app: &mut App) {
    app.init_resource::<Log>()
        .add_observer(|ready: On<MorphColliderReady>, mut log: ResMut<Log>| log.0.push(Heard::Ready(ready.entity)))
        .add_observer(|failed: On<MorphColliderFailed>, mut log: ResMut<Log>| {
            log.0.push(Heard::Failed(failed.entity, failed.reason.to_string()));
        })
        .add_observer(|ready: On<MorphColliderSceneReady>, mut log: ResMut<Log>| log.0.push(Heard::Scene(*ready)));
}

fn heard(app: &mut App) -> Vec<Heard> {
    std::mem::take(&mut app.world_mut().resource_mut::<Log>().0)
}

fn empty(entity: Entity) -> Heard {
    Heard::Scene(MorphColliderSceneReady {
        entity,
        parts: 0,
        failed: 0,
    })
}

fn progress(app: &App) -> (usize, usize, usize) {
    let MorphTreeProgress {
        requested,
        built,
        failed,
    } = app.world().resource::<MorphTrees>().progress();
    (requested, built, failed)
}

/// A scene that cannot be loaded fails with a reason that says all of this.
fn scene_fails(file: &str, reasons: &[&str]) {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        listen(app);
        let root = spawn_scene(app, file, MorphColliderScene::default());
        load(app, root);
        let heard = heard(app);
        let [Heard::Failed(entity, reason), ready] = &heard[..] else {
            panic!("{heard:?}");
        };
        assert_eq!((*entity, ready), (root, &empty(root)));
        says(reason, &["it could not be loaded"]);
        says(reason, reasons);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        says(&logged[0], &["`Boss`", file, reason]);
        run(app, PATIENCE);
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]), "once");
        assert_eq!(app.world().resource::<Log>().0, []);
    });
}

#[test]
fn a_scene_that_cannot_be_loaded_fails_with_the_reason_and_ends_loading_screens() {
    scene_fails("missing.glb#Scene0", &["missing.glb"]);
    scene_fails("broken.glb#Scene0", &["broken.glb"]);
    scene_fails("morphs.glb#Scene7", &["Scene7", "Scene0"]);
    scene_fails("morphs.glb", &["name it: `morphs.glb#Scene0`"]);
}

#[test]
fn a_scene_above_a_file_that_cannot_be_loaded_fails_too() {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        listen(app);
        let above = |app: &mut App, scenes: &[&str]| {
            let top = app.spawn((Transform::default(), MorphColliderScene::default()));
            for file in scenes {
                let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load((*file).to_owned());
                // Only then below the scene.
                let root = app.spawn(WorldAssetRoot(scene));
                app.world_mut().entity_mut(top).add_child(root);
            }
            top
        };
        let told = |app: &mut App, top: Entity| {
            update_until(app, &path, |world| {
                Ok(matches!(world.resource::<Log>().0.last(), Some(Heard::Scene(_))))
            })
            .unwrap();
            let heard = heard(app);
            let failed = |heard: &&Heard| matches!(heard, Heard::Failed(entity, _) if *entity == top);
            let failed = heard.iter().filter(failed).count();
            let Some(Heard::Scene(ready)) = heard.last() else {
                panic!("{heard:?}");
            };
            (failed, ready.entity == top, ready.parts)
        };
        let top = above(app, &["missing.glb#Scene0"]);
        assert_eq!(told(app, top), (1, true, 0));
        // Also if the file comes late.
        let top = above(app, &[]);
        run(app, 3);
        let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load("missing.glb#Scene0");
        let root = app.spawn(WorldAssetRoot(scene));
        run(app, 3);
        assert_eq!(heard(app), []);
        app.world_mut().entity_mut(top).add_child(root);
        assert_eq!(told(app, top), (1, true, 0));
        let top = above(app, &["rigid.glb#Scene0"]);
        assert_eq!(told(app, top), (0, true, 0));
        let top = above(app, &["morphs.glb#Scene0"]);
        assert_eq!(told(app, top), (0, true, 1));
        assert_eq!(errors.take().len(), 1, "each file once");
        run(app, PATIENCE);
        assert_eq!(heard(app), []);
    });
}

#[test]
fn a_file_that_cannot_be_loaded_is_logged_once_for_all_scenes_that_show_it() {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        listen(app);
        let file = "missing.glb#Scene0";
        let roots = [(); 20].map(|()| spawn_scene(app, file, MorphColliderScene::default()));
        load(app, roots[0]);
        let failed = |heard: &&Heard| matches!(heard, Heard::Failed(entity, _) if roots.contains(entity));
        assert_eq!(heard(app).iter().filter(failed).count(), 20);
        assert_eq!((errors.take().len(), errors.take_warnings()), (1, vec![]));
    });
}

#[test]
fn a_scene_without_colliders_ends_loading_screens() {
    let (_folder, path) = files();
    with_app(&path, |app, _| {
        listen(app);
        let rigid = spawn_scene(app, "rigid.glb#Scene0", MorphColliderScene::default());
        load(app, rigid);
        assert_eq!(heard(app), [empty(rigid)]);
        // With parts, their events come as usual.
        app.world_mut()
            .get_mut::<MorphColliderScene>(rigid)
            .unwrap()
            .only_deforming = false;
        settle(app);
        let heard = heard(app);
        let ready = Heard::Scene(MorphColliderSceneReady {
            entity: rigid,
            parts: 2,
            failed: 0,
        });
        assert_eq!((heard.len(), heard.last()), (3, Some(&ready)), "{heard:?}");
    });
}

#[test]
fn a_scene_may_be_loaded_on_a_second_try() {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        listen(app);
        let root = spawn_scene(app, "late.glb#Scene0", MorphColliderScene::default());
        load(app, root);
        assert_eq!((heard(app).len(), errors.take().len()), (2, 1));
        std::fs::copy(path.join("morphs.glb"), path.join("late.glb")).unwrap();
        app.world().resource::<AssetServer>().reload("late.glb#Scene0");
        update_until(app, &path, |world| {
            Ok(matches!(world.resource::<Log>().0.last(), Some(Heard::Scene(ready)) if ready.parts == 1))
        })
        .unwrap();
        assert_eq!(errors.take(), [""; 0]);
    });
}

#[test]
fn a_mesh_that_cannot_be_loaded_fails_with_the_reason() {
    let (_folder, path) = files();
    with_app(&path, |app, errors| {
        listen(app);
        let file = "late.glb#Mesh0/Primitive0";
        let mesh: Handle<Mesh> = app.world().resource::<AssetServer>().load(file);
        let first = spawn(app, &mesh, 0.0);
        app.insert(first, Name::new("Sword"));
        update_until(app, &path, |world| Ok(!world.resource::<Log>().0.is_empty())).unwrap();
        let [Heard::Failed(entity, reason)] = &heard(app)[..] else {
            panic!()
        };
        assert_eq!(*entity, first);
        says(reason, &["it could not be loaded", "late.glb"]);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        says(&logged[0], &["`Sword`", file, reason]);
        assert_eq!(progress(app), (1, 0, 1));
        assert!(app.world().resource::<MorphTrees>().progress().is_done());
        // A second one hears it, too, and nothing is logged again.
        let second = spawn(app, &mesh, 0.0);
        run(app, 2);
        assert!(matches!(heard(app)[..], [Heard::Failed(entity, _)] if entity == second));
        run(app, PATIENCE);
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]));

        std::fs::copy(path.join("morphs.glb"), path.join("late.glb")).unwrap();
        app.world().resource::<AssetServer>().reload(file);
        update_until(app, &path, |world| Ok(!world.resource::<Log>().0.is_empty())).unwrap();
        let ready = [first.min(second), first.max(second)].map(Heard::Ready);
        assert_eq!(heard(app), ready);
        assert_eq!(progress(app), (1, 1, 0));
        assert_eq!(errors.take(), [""; 0]);
    });
}

#[test]
fn a_missing_texture_is_no_obstacle() {
    let (_folder, path) = files();
    let bytes = std::fs::read(path.join("morphs.glb")).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    json["images"] = serde_json::json!([{ "uri": "missing.png" }]);
    json["textures"] = serde_json::json!([{ "source": 0 }]);
    json["materials"] = serde_json::json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    json["meshes"][0]["primitives"][0]["material"] = 0.into();
    let mut json = serde_json::to_vec(&json).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut textured = bytes[..8].to_vec();
    textured.extend(((20 + json.len() + bytes.len() - 20 - length) as u32).to_le_bytes());
    textured.extend((json.len() as u32).to_le_bytes());
    textured.extend(&bytes[16..20]);
    textured.extend(json);
    textured.extend(&bytes[20 + length..]);
    std::fs::write(path.join("textured.glb"), textured).unwrap();
    with_app(&path, |app, errors| {
        listen(app);
        let root = spawn_scene(app, "textured.glb#Scene0", MorphColliderScene::default());
        load(app, root);
        settle(app);
        let ready = |heard: &Heard| matches!(heard, Heard::Scene(ready) if ready.parts == 1);
        let heard = heard(app);
        assert!(heard.last().is_some_and(ready), "{heard:?}");
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]));
    });
}

#[test]
fn a_mesh_that_is_removed_or_never_added_is_told() {
    let warning = warning_about(|app| {
        let reserved = app.world().resource::<Assets<Mesh>>().reserve_handle();
        let sword = spawn(app, &reserved, 0.0);
        app.insert(sword, Name::new("Sword"));
    });
    let missing = ["the mesh of entity `Sword`", "not in `Assets<Mesh>`", "left out"];
    says(&warning, &missing);
    says(
        &warning_about(|app| {
            app.spawn((Mesh3d::default(), MorphCollider::default(), Name::new("Sword")));
        }),
        &missing,
    );
    with_app(Path::new("."), |app, errors| {
        let mesh = add_mesh(app, &cube());
        let sword = spawn(app, &mesh, 0.0);
        app.insert(sword, Name::new("Sword"));
        run(app, PATIENCE);
        assert_eq!(errors.take_warnings(), [""; 0]);
        app.world_mut().resource_mut::<Assets<Mesh>>().remove(&mesh);
        says(&only_warning(app, errors), &missing);
    });
}

#[test]
fn a_mesh_of_a_file_is_called_by_its_file() {
    let (_folder, path) = files();
    let mut mesh = stretching_cube();
    mesh.target_names = vec!["stretch".into()];
    let bytes = to_glb(&mesh, &Appearance::default()).unwrap();
    std::fs::write(path.join("hero.glb"), bytes).unwrap();
    with_app(&path, |app, errors| {
        let root = spawn_scene(app, "hero.glb#Scene0", MorphColliderScene::default());
        load(app, root);
        settle(app);
        let mut parts = app
            .world_mut()
            .query_filtered::<(Entity, &Mesh3d), With<MorphCollider>>();
        let (part, mesh) = parts.single(app.world()).unwrap();
        let mesh = mesh.0.clone();
        app.remove::<Name>(part);
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        meshes.get_mut(&mesh).unwrap().insert_indices(Indices::U32(vec![0, 1]));
        settle(app);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        says(&logged[0], &["mesh `hero.glb#Mesh0/Primitive0` of entity"]);
    });
    // A mesh without a file is called by its entity.
    with_app(&path, |app, errors| {
        let bad = bevy_mesh(&cube()).with_removed_attribute(Mesh::ATTRIBUTE_POSITION);
        let bad = app.world_mut().resource_mut::<Assets<Mesh>>().add(bad);
        let sword = spawn(app, &bad, 0.0);
        app.insert(sword, Name::new("Sword"));
        settle(app);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        says(&logged[0], &["the mesh of entity `Sword` cannot collide"]);
        assert!(!logged[0].contains("AssetId"), "{logged:?}");
    });
}

#[test]
fn joint_weights_that_do_not_sum_to_one_are_told_once_for_each_mesh() {
    with_app(&assets(), |app, errors| {
        let name = "mh_character_low.glb#Scene0";
        let root = spawn_scene(app, name, MorphColliderScene::default());
        load(app, root);
        settle(app);
        assert_eq!(errors.take_warnings(), [""; 0], "these do");
        let mut parts = app.world_mut().query_filtered::<&Mesh3d, With<MorphCollider>>();
        let mesh = parts.iter(app.world()).next().unwrap().0.clone();
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        let mut mesh = meshes.get_mut(&mesh).unwrap();
        let Some(VertexAttributeValues::Float32x4(weights)) = mesh.attribute_mut(Mesh::ATTRIBUTE_JOINT_WEIGHT) else {
            panic!("a character has joint weights");
        };
        weights[0] = [1.0, 0.66, 0.0, 0.0];
        drop(mesh);
        settle(app);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        says(
            &warnings[0],
            &[
                "mh_character_low.glb#Mesh0/Primitive0",
                "do not sum to 1",
                "0.66",
                "Normalise the weights",
            ],
        );
        let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load(name);
        app.spawn((WorldAssetRoot(scene), MorphColliderScene::default()));
        settle(app);
        assert_eq!(errors.take_warnings(), [""; 0], "once");
    });
}

#[test]
fn a_robot_whose_joint_weights_do_not_sum_to_one_is_told() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    if !folder.join("RobotExpressive.glb").exists() {
        println!("skipped: there is no RobotExpressive.glb");
        return;
    }
    with_app(&folder, |app, errors| {
        let root = spawn_scene(app, "RobotExpressive.glb#Scene0", MorphColliderScene::default());
        load(app, root);
        settle(app);
        let warnings = errors.take_warnings();
        assert!(!warnings.is_empty());
        for warning in &warnings {
            says(warning, &["RobotExpressive.glb#Mesh", "do not sum to 1"]);
        }
    });
}
