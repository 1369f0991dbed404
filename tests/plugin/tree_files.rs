//! Trees come from files that `morph-collide bake` writes, if these fit.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::sleep;

use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use bevy_morph_collision::import::MorphTreeFile;
use bevy_morph_collision::morph_collision::{BuildOptions, MorphBvh, Pose, TreeFile, TreeLayout};
use bevy_morph_collision::prelude::*;
use morph_collision_cli::bake::{BakeOptions, Trees};
use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_workspace::app::{STEP, headless, update_until};
use tempfile::TempDir;

use crate::log::{Errors, start};
use crate::models::shared;
use crate::support::{Edits, assets, settle, stretching_cube};

fn bake(model: &Path, options: &BakeOptions) -> TreeFile {
    let file = GltfFile::open(model, &ReadOptions::default()).unwrap();
    let Trees { file, not_baked, .. } = Trees::bake(&file, options);
    assert!(not_baked.is_empty(), "{not_baked:?}");
    file
}

/// The same tree with its first triangles in another order, as nothing builds it.
fn mark(layout: &mut TreeLayout) {
    let mut json = serde_json::to_value(&*layout).unwrap();
    json["triangles"].as_array_mut().unwrap().swap(0, 1);
    *layout = serde_json::from_value(json).unwrap();
}

fn beside(model: &Path) -> PathBuf {
    let mut name = model.as_os_str().to_owned();
    name.push(".morphtree");
    name.into()
}

/// Writes the trees of a model beside it, so that the plugin's are recognised. Returns them.
fn write_marked(model: &Path, options: &BakeOptions) -> TreeFile {
    let mut file = bake(model, options);
    file.trees.iter_mut().for_each(|saved| mark(&mut saved.layout));
    fs::write(beside(model), file.to_bytes()).unwrap();
    file
}

/// A folder with one model in it.
fn folder(model: &Path) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join(model.file_name().unwrap());
    fs::copy(model, &copy).unwrap();
    (folder, copy)
}

/// A folder with a cube that stretches by `by`.
fn cube_folder(by: f32) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("cube.glb");
    write_cube(&model, by);
    (folder, model)
}

fn write_cube(model: &Path, by: f32) {
    let mut cube = stretching_cube();
    cube.targets[0].iter_mut().for_each(|d| *d *= by);
    fs::write(model, to_glb(&cube, &Appearance::default()).unwrap()).unwrap();
}

fn app_with(model: &Path, plugin: MorphTreeFilesPlugin) -> App {
    let mut app = headless(model.parent().unwrap());
    app.add_plugins(plugin);
    start(&mut app);
    app
}

fn scene_of(app: &App, model: &Path) -> Handle<WorldAsset> {
    let name = model.file_name().unwrap().to_str().unwrap();
    app.world().resource::<AssetServer>().load(format!("{name}#Scene0"))
}

/// Loads a model and waits until its colliders are ready.
fn show(app: &mut App, model: &Path, with: impl Bundle) {
    #[derive(Resource, Default)]
    struct Ready(bool);
    app.init_resource::<Ready>();
    app.world_mut()
        .add_observer(|_: On<MorphColliderSceneReady>, mut ready: ResMut<Ready>| ready.0 = true);
    let scene = scene_of(app, model);
    app.spawn((WorldAssetRoot(scene), MorphColliderScene::default(), with));
    update_until(app, model, |world| Ok(world.resource::<Ready>().0)).unwrap();
}

/// The layouts of all trees, in the order of their labels.
fn layouts(app: &App) -> Vec<TreeLayout> {
    let world = app.world();
    let server = world.resource::<AssetServer>();
    let trees = world.resource::<MorphTrees>().iter();
    let label = |mesh| server.get_path(mesh).unwrap().label().unwrap().to_owned();
    let mut all: Vec<(String, TreeLayout)> = trees.map(|(mesh, tree)| (label(mesh), tree.layout())).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all.into_iter().map(|(_, layout)| layout).collect()
}

fn saved_layouts(file: &TreeFile) -> Vec<TreeLayout> {
    let mut trees = file.trees.clone();
    trees.sort_by(|a, b| a.label.cmp(&b.label));
    trees.into_iter().map(|saved| saved.layout).collect()
}

#[test]
fn every_model_uses_the_trees_that_were_baked_for_it() {
    let mut models: Vec<PathBuf> = fs::read_dir(assets())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "glb"))
        .collect();
    models.extend(["Fox.glb", "RobotExpressive.glb"].into_iter().filter_map(shared));
    assert!(models.len() >= 8);
    for model in models {
        let (_folder, model) = folder(&model);
        let file = write_marked(&model, &BakeOptions::default());
        Errors::collect(|errors| {
            let mut app = app_with(&model, MorphTreeFilesPlugin::default());
            show(&mut app, &model, ());
            let warnings = errors.take_warnings();
            assert!(warnings.iter().all(|text| !text.contains("not used")), "{warnings:?}");
            assert!(layouts(&app) == saved_layouts(&file), "{}", model.display());
        });
    }
}

#[test]
fn meshes_without_normals_are_baked_as_bevy_splits_them() {
    let (_folder, model) = cube_folder(1.0);
    let (json, rest) = glb_parts(&fs::read(&model).unwrap());
    fs::write(&model, glb(&json.replace("\"NORMAL\"", "\"_NORMAL\""), &rest)).unwrap();
    let file = write_marked(&model, &BakeOptions::default());
    let mut app = app_with(&model, MorphTreeFilesPlugin::default());
    show(&mut app, &model, ());
    assert!(layouts(&app) == saved_layouts(&file));
    let (_, tree) = app.world().resource::<MorphTrees>().iter().next().unwrap();
    assert_eq!(tree.model().source_vertex_count(), 36, "no vertex is shared");
}

/// The JSON of a binary glTF file, and the chunks behind it.
fn glb_parts(bytes: &[u8]) -> (String, Vec<u8>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json = String::from_utf8(bytes[20..20 + length].to_vec()).unwrap();
    (json, bytes[20 + length..].to_vec())
}

fn glb(json: &str, rest: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 20 + json.len() + rest.len();
    let header = [total as u32, json.len() as u32].map(u32::to_le_bytes);
    [b"glTF\x02\0\0\0", &header[0][..], &header[1], b"JSON", &json, rest].concat()
}

#[test]
fn a_large_character_is_ready_two_frames_after_its_meshes() {
    let model = shared("mh_character.glb").unwrap_or_else(|| assets().join("mh_character_low.glb"));
    let (_folder, model) = folder(&model);
    let file = write_marked(&model, &BakeOptions::default());
    let mut app = app_with(&model, MorphTreeFilesPlugin::default());
    let scene = scene_of(&app, &model);
    app.spawn((WorldAssetRoot(scene), MorphColliderScene::default()));
    let (mut waited, mut is_there) = (0, false);
    loop {
        // Long frames, because a busy machine takes long to read.
        sleep(STEP * 6);
        app.update();
        waited += usize::from(is_there);
        let trees = app.world().resource::<MorphTrees>().progress();
        if trees.requested > 0 && trees.is_done() {
            break;
        }
        let mut meshes = app.world_mut().query::<(&Mesh3d, &MorphCollider)>();
        is_there |= meshes.iter(app.world()).next().is_some();
    }
    println!("{waited} frames");
    assert!(waited <= 2, "{waited}");
    assert!(layouts(&app) == saved_layouts(&file));
}

/// The warnings about a cube with this file beside it. Its tree is built in any case.
fn warnings_with(file: &[u8], settings: MorphCollisionSettings) -> Vec<String> {
    let (_folder, model) = cube_folder(1.0);
    fs::write(beside(&model), file).unwrap();
    let mut warnings = Vec::new();
    Errors::collect(|errors| {
        let mut app = app_with(&model, MorphTreeFilesPlugin::default());
        app.insert_resource(settings);
        show(&mut app, &model, ());
        assert_eq!(errors.take(), [""; 0]);
        let (_, tree) = app.world().resource::<MorphTrees>().iter().next().unwrap();
        let built = MorphBvh::build(tree.model().clone(), tree.options());
        assert!(tree.layout() == built.layout());
        warnings = errors.take_warnings();
    });
    warnings
}

#[track_caller]
fn assert_refused(warnings: &[String], parts: &[&str]) {
    let [warning] = warnings else { panic!("{warnings:?}") };
    for part in ["`cube.glb.morphtree` is not used", "built instead"]
        .iter()
        .chain(parts)
    {
        assert!(warning.contains(part), "{warning:?} without {part:?}");
    }
}

#[test]
fn files_that_do_not_fit_are_refused_by_name() {
    let (_other, stale) = cube_folder(2.0);
    let stale = bake(&stale, &BakeOptions::default());
    let warnings = |file: &TreeFile| warnings_with(&file.to_bytes(), MorphCollisionSettings::default());
    let again = "`morph-collide bake";
    assert_refused(
        &warnings(&stale),
        &["`cube.glb#Mesh0/Primitive0`", "another mesh", "has changed", again],
    );
    let mut foreign = stale.clone();
    foreign.trees[0].label = "Mesh7/Primitive1".into();
    assert_refused(&warnings(&foreign), &["of another model", "`Mesh7/Primitive1`", again]);

    let (_same, model) = cube_folder(1.0);
    let fits = bake(&model, &BakeOptions::default());
    assert_eq!(warnings(&fits), [""; 0]);
    let mut skinned = fits.clone();
    skinned.trees[0].joints = Some(3);
    assert_refused(&warnings(&skinned), &["no skeleton", again]);
    let options = BakeOptions {
        tree: BuildOptions::default().with_leaf_size(3).unwrap(),
        ..BakeOptions::default()
    };
    assert_refused(&warnings(&bake(&model, &options)), &["`--leaf 3`", "is 8"]);
    let settings = MorphCollisionSettings {
        tree_options: MorphTreeOptions { leaf_size: 3 },
        ..default()
    };
    assert_eq!(warnings_with(&bake(&model, &options).to_bytes(), settings), [""; 0]);
}

#[test]
fn files_that_are_damaged_are_refused_by_name() {
    let (_folder, model) = cube_folder(1.0);
    let bytes = bake(&model, &BakeOptions::default()).to_bytes();
    let warnings = |bytes: &[u8]| warnings_with(bytes, MorphCollisionSettings::default());
    for length in [9, 30, bytes.len() - 1] {
        assert_refused(
            &warnings(&bytes[..length]),
            &["incomplete or damaged", "`morph-collide bake cube.glb`"],
        );
    }
    let mut newer = bytes.clone();
    newer[8] += 1;
    assert_refused(&warnings(&newer), &["it has version 2."]);
    assert_refused(&warnings(b"<!DOCTYPE html>"), &["not a file of trees"]);
    // The same tree twice, and one of another number of triangles.
    let mut repeated = bake(&model, &BakeOptions::default());
    repeated.trees.push(repeated.trees[0].clone());
    let again = "`morph-collide bake`";
    assert_refused(
        &warnings(&repeated.to_bytes()),
        &["two trees of the mesh `Mesh0/Primitive0`", again],
    );
    let mut smaller = bake(&model, &BakeOptions::default());
    let mut json = serde_json::to_value(&smaller.trees[0].layout).unwrap();
    json["triangles"].as_array_mut().unwrap().pop();
    smaller.trees[0].layout = serde_json::from_value(json).unwrap();
    assert_refused(&warnings(&smaller.to_bytes()), &["another mesh", again]);
    // A tree over more triangles than there are.
    let mut broken = bake(&model, &BakeOptions::default());
    let mut json = serde_json::to_value(&broken.trees[0].layout).unwrap();
    json["nodes"][1] = 255.into();
    broken.trees[0].layout = serde_json::from_value(json).unwrap();
    let warnings = warnings(&broken.to_bytes());
    assert_refused(&warnings, &["`cube.glb#Mesh0/Primitive0`", "the nodes are no tree"]);
}

#[test]
fn without_a_file_nothing_is_said_and_trees_are_built() {
    let (_folder, model) = cube_folder(1.0);
    for plugin in [true, false].map(|beside_models| MorphTreeFilesPlugin { beside_models }) {
        Errors::collect(|errors| {
            let mut app = app_with(&model, plugin);
            show(&mut app, &model, ());
            assert_eq!((errors.take(), errors.take_warnings()), (Vec::new(), Vec::new()));
            assert!(layouts(&app) == saved_layouts(&bake(&model, &BakeOptions::default())));
        });
    }
}

#[test]
fn a_mesh_that_changed_since_it_was_loaded_gets_its_own_tree() {
    let (_folder, model) = cube_folder(1.0);
    write_marked(&model, &BakeOptions::default());
    let mut app = app_with(&model, MorphTreeFilesPlugin::default());
    let mesh: Handle<Mesh> = app.world().resource::<AssetServer>().load("cube.glb#Mesh0/Primitive0");
    let id = mesh.id();
    update_until(&mut app, &model, |world| {
        Ok(world.resource::<Assets<Mesh>>().contains(id))
    })
    .unwrap();
    let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
    let mut changed = meshes.get_mut(id).unwrap();
    let moved = vec![Vec3::Y; changed.count_vertices()];
    changed.insert_attribute(Mesh::ATTRIBUTE_POSITION, moved);
    drop(changed);
    Errors::collect(|errors| {
        app.spawn((Mesh3d(mesh), MorphCollider::default()));
        settle(&mut app);
        assert_eq!(errors.take_warnings(), [""; 0]);
        let tree = app.world().resource::<MorphTrees>().get(id).unwrap();
        let mut pose = Pose::new(tree.clone());
        assert_eq!(pose.source_vertex(0), Some(Vec3::Y));
    });
}

#[test]
fn a_component_names_a_file_that_is_waited_for() {
    let (folder, model) = cube_folder(1.0);
    let file = write_marked(&model, &BakeOptions::default());
    fs::rename(beside(&model), folder.path().join("elsewhere.morphtree")).unwrap();
    let plugin = MorphTreeFilesPlugin { beside_models: false };
    let load = |app: &App, name: &'static str| MorphTreeFrom(app.world().resource::<AssetServer>().load(name));
    Errors::collect(|errors| {
        let mut app = app_with(&model, plugin);
        let from = load(&app, "elsewhere.morphtree");
        show(&mut app, &model, from.clone());
        assert_eq!(errors.take_warnings(), [""; 0]);
        assert!(layouts(&app) == saved_layouts(&file));
        let loaded = app.world().resource::<Assets<MorphTreeFile>>().get(&from.0).unwrap();
        assert_eq!(loaded.trees(), file.trees);
    });
    write_cube(&model, 2.0);
    for (name, reason) in [
        ("elsewhere.morphtree", "another mesh"),
        ("nowhere.morphtree", "it is not loaded"),
    ] {
        Errors::collect(|errors| {
            let mut app = app_with(&model, plugin);
            let from = load(&app, name);
            show(&mut app, &model, from);
            let warnings = errors.take_warnings();
            let [warning] = &warnings[..] else {
                panic!("{warnings:?}")
            };
            assert!(
                warning.contains(name) && warning.contains("`cube.glb#Mesh0/Primitive0`"),
                "{warning}"
            );
            assert!(warning.contains(reason), "{warning}");
            assert!(layouts(&app) == saved_layouts(&bake(&model, &BakeOptions::default())));
        });
    }
}

#[test]
fn certificates_come_with_the_tree() {
    let (_folder, model) = cube_folder(1.0);
    let options = BakeOptions {
        certificates: true,
        ..BakeOptions::default()
    };
    fs::write(beside(&model), bake(&model, &options).to_bytes()).unwrap();
    let mut app = app_with(&model, MorphTreeFilesPlugin::default());
    show(&mut app, &model, ());
    let trees = app.world().resource::<MorphTrees>();
    let all: Vec<&Arc<MorphBvh>> = trees.iter().map(|(_, tree)| tree).collect();
    assert!(!all.is_empty() && all.iter().all(|tree| tree.certificates().is_some()));
}
