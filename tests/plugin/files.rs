//! Files are loaded as the README shows, and are drawn and collide according to their content.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bevy::animation::AnimationPlugin;
use bevy::gltf::GltfPlugin;
use bevy::math::Affine3A;
use bevy::mesh::MeshPlugin;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::world_serialization::{WorldAsset, WorldInstanceReady, WorldSerializationPlugin};
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::Pose;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::skinned_vertices;
use morph_collision_workspace::app::{headless, is_loaded, update_until};

use crate::log::{Errors, start};
use crate::support::{Edits, assets, settle, stretching_cube};

/// An app with the first scene of a file in it.
fn load(file: &Path, scene: MorphColliderScene) -> App {
    let mut app = headless(file.parent().unwrap());
    start(&mut app);
    show(&mut app, file, scene);
    app
}

/// Loads the first scene of a file.
fn show(app: &mut App, file: &Path, colliders: MorphColliderScene) {
    #[derive(Resource, Default)]
    struct IsThere(bool);
    app.init_resource::<IsThere>();
    app.world_mut()
        .add_observer(|_: On<WorldInstanceReady>, mut is_there: ResMut<IsThere>| is_there.0 = true);
    let name = file.file_name().unwrap().to_str().unwrap();
    let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load(format!("{name}#Scene0"));
    let id = scene.id().untyped();
    app.spawn((WorldAssetRoot(scene), Transform::default(), colliders));
    update_until(app, file, |world| {
        is_loaded(world.resource::<AssetServer>(), id, file)?;
        Ok(world.resource::<IsThere>().0)
    })
    .expect("the scene is spawned");
    settle(app);
}

/// The indices of the mesh and the primitive that an asset was loaded from.
fn source(app: &App, mesh: AssetId<Mesh>) -> (usize, usize) {
    let path = app.world().resource::<AssetServer>().get_path(mesh).unwrap();
    let label = path.label().unwrap();
    let (mesh, primitive) = label.strip_prefix("Mesh").unwrap().split_once("/Primitive").unwrap();
    (mesh.parse().unwrap(), primitive.parse().unwrap())
}

/// Checks that a mesh asset has the triangles and displacements of a primitive in the file, and that its tree poses them
/// accordingly.
fn compare(app: &App, shown: Entity, file: &MorphMesh, primitive: usize, name: &str) {
    let mesh = app.world().get::<Mesh3d>(shown).unwrap();
    let id = mesh.id();
    let range = &file.primitives[primitive];
    let triangles = &file.triangles[range.start as usize..range.end as usize];
    let (targets, corners) = (file.targets.len(), triangles.as_flattened());

    let drawn = app.world().resource::<Assets<Mesh>>().get(id).unwrap();
    assert!(drawn.contains_attribute(Mesh::ATTRIBUTE_NORMAL), "{name} is shaded");
    let vertices = drawn.count_vertices();
    let positions = drawn.attribute(Mesh::ATTRIBUTE_POSITION).unwrap().as_float3().unwrap();
    let displacements = drawn.morph_targets().map_or(&[][..], Vec::as_slice);
    assert_eq!(displacements.len(), vertices * targets, "{name}");
    let indices: Vec<usize> = match drawn.indices() {
        Some(indices) => indices.iter().collect(),
        None => (0..vertices).collect(),
    };
    assert_eq!(indices.len(), corners.len(), "{name}");
    for (&vertex, &corner) in indices.iter().zip(corners) {
        assert_eq!(Vec3::from(positions[vertex]), file.positions[corner as usize], "{name}");
    }
    for (target, in_file) in file.targets.iter().enumerate() {
        let drawn = &displacements[target * vertices..][..vertices];
        for (&vertex, &corner) in indices.iter().zip(corners) {
            let expected = in_file[corner as usize];
            assert_eq!(
                drawn[vertex].position, expected,
                "{name}: target {target}, vertex {corner}"
            );
        }
    }

    let skin = app.world().get::<SkinnedMesh>(shown);
    assert_eq!(skin.is_some(), file.skin.is_some(), "{name}");
    let tree = app.world().resource::<MorphTrees>().shown_with(mesh, None, skin);
    let tree = tree.unwrap_or_else(|| panic!("{name} has no tree"));
    let model = tree.model();
    let sizes = (
        model.source_vertex_count(),
        model.target_count(),
        model.triangle_count(),
    );
    assert_eq!(sizes, (vertices, targets, triangles.len()), "{name}");
    let mut pose = Pose::new(tree.clone());
    for turn in 0..3 {
        let weight = |target: usize| ((target * 7 + turn * 3) as f32 * 0.37).sin();
        let weights: Vec<f32> = (0..targets).map(weight).collect();
        pose.set_weights(&weights).unwrap();
        let mut expected = file.posed(&weights);
        if let Some(skin) = &file.skin {
            let joints = vec![Affine3A::IDENTITY; skin.skeleton.joints.len()];
            let skinned = skinned_vertices(&expected, &skin.sets, &joints);
            expected = skinned.iter().map(|p| p.as_vec3()).collect();
        }
        for (number, triangle) in (0..).zip(triangles) {
            let expected = triangle.map(|corner| expected[corner as usize]);
            assert_eq!(pose.triangle(number), Some(expected), "{name}: triangle {number}");
        }
    }
}

/// Loads a file and compares its deforming meshes, or all of them if nothing deforms; returns the number of deforming
/// meshes.
fn loads_as_it_is(path: &Path) -> usize {
    let file = read_meshes(path).unwrap();
    let deforming = file
        .iter()
        .filter(|mesh| !mesh.targets.is_empty() || mesh.skin.is_some());
    let deforming: usize = deforming.map(|mesh| mesh.primitives.len()).sum();
    let app = load(path, MorphColliderScene::default());
    assert_eq!(
        compare_all(app, path, &file),
        deforming,
        "{}: all that deforms collides",
        path.display()
    );
    if deforming == 0 {
        let everything = MorphColliderScene {
            only_deforming: false,
            ..default()
        };
        let all: usize = file.iter().map(|mesh| mesh.primitives.len()).sum();
        assert_eq!(
            compare_all(load(path, everything), path, &file),
            all,
            "{}",
            path.display()
        );
    }
    deforming
}

/// Compares all mesh assets that collide; returns their number.
fn compare_all(mut app: App, path: &Path, file: &[MorphMesh]) -> usize {
    let mut colliders = app
        .world_mut()
        .query_filtered::<(Entity, &Mesh3d), With<MorphCollider>>();
    let colliding: BTreeMap<_, _> = colliders
        .iter(app.world())
        .map(|(entity, mesh)| (source(&app, mesh.id()), entity))
        .collect();
    for (&(mesh, primitive), &entity) in &colliding {
        compare(&app, entity, &file[mesh], primitive, &path.display().to_string());
    }
    colliding.len()
}

/// The models in a folder.
fn models(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = folder.read_dir() else {
        println!("skipped: {} is not there", folder.display());
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| {
        file.extension()
            .is_some_and(|extension| extension == "glb" || extension == "gltf")
    });
    files.sort();
    files
}

#[test]
fn every_model_of_the_repository_loads_as_it_is() {
    let files = models(&assets());
    assert!(files.len() >= 5, "{files:?}");
    for file in files {
        assert!(loads_as_it_is(&file) > 0, "{} morphs", file.display());
    }
}

#[test]
fn every_model_from_elsewhere_loads_as_it_is() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    if !folder.is_dir() {
        println!("skipped: {} is not there", folder.display());
        return;
    }
    assert!(!models(&folder).is_empty());
    for file in models(&folder).into_iter().chain(models(&folder.join("sequences"))) {
        let deforming = loads_as_it_is(&file);
        println!("{}: {deforming} deforming meshes", file.display());
    }
}

/// The same file without normals.
fn without_normals(glb: &[u8]) -> Vec<u8> {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let end = 20 + word(12);
    let mut json: serde_json::Value = serde_json::from_slice(&glb[20..end]).unwrap();
    let mut removed = 0;
    for primitive in json["meshes"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .flat_map(|mesh| mesh["primitives"].as_array_mut().unwrap())
    {
        removed += usize::from(
            primitive["attributes"]
                .as_object_mut()
                .unwrap()
                .remove("NORMAL")
                .is_some(),
        );
        for target in primitive["targets"].as_array_mut().unwrap() {
            target.as_object_mut().unwrap().remove("NORMAL");
        }
    }
    assert!(removed > 0);
    let mut json = serde_json::to_vec(&json).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bare = glb[..8].to_vec();
    bare.extend(((20 + json.len() + glb.len() - end) as u32).to_le_bytes());
    bare.extend((json.len() as u32).to_le_bytes());
    bare.extend(b"JSON");
    bare.extend(json);
    bare.extend(&glb[end..]);
    bare
}

/// A folder with the stretching cube in a file without normals: two primitives with shared vertices.
fn bare_cube() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bare.glb");
    let mut mesh = stretching_cube();
    mesh.targets
        .push((0..8).map(|i| Vec3::new(0.0, i as f32, -0.25)).collect());
    mesh.targets.push((0..8).map(|i| Vec3::splat(0.5 - i as f32)).collect());
    mesh.target_names.extend(["rise".into(), "shrink".into()]);
    mesh.primitives = vec![0..5, 5..12];
    let bytes = to_glb(&mesh, &Appearance::default()).unwrap();
    std::fs::write(&file, without_normals(&bytes)).unwrap();
    (folder, file)
}

#[test]
fn a_mesh_without_normals_is_drawn_and_collides_as_it_is() {
    let (_folder, file) = bare_cube();
    assert_eq!(loads_as_it_is(&file), 2);
    // The names give the number of targets. Without them the mesh cannot be distinguished from a split one.
    let mut bytes = std::fs::read(&file).unwrap();
    let at = bytes.windows(11).position(|text| text == b"targetNames").unwrap();
    bytes[at] = b'T';
    std::fs::write(&file, bytes).unwrap();
    assert_eq!(loads_as_it_is(&file), 2);
}

#[test]
fn meshes_without_normals_are_repaired_whichever_plugin_comes_first() {
    let (folder, file) = bare_cube();
    let read = read_meshes(&file).unwrap();
    let assets = AssetPlugin {
        file_path: folder.path().to_str().unwrap().into(),
        ..default()
    };
    let mut app = App::new();
    app.add_plugins((MorphCollisionPlugin, MinimalPlugins, TransformPlugin, assets))
        .add_plugins((
            WorldSerializationPlugin,
            ImagePlugin::default(),
            MeshPlugin,
            GltfPlugin::default(),
            AnimationPlugin,
        ));
    start(&mut app);
    show(&mut app, &file, MorphColliderScene::default());
    assert_eq!(compare_all(app, &file, &read), 2);
}

/// A file that shows one habit of exporters.
fn field(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("crates/morph_collision_models/tests/gltf/data/field")
        .join(name)
}

/// The mesh of the only collider.
fn only_mesh(app: &mut App) -> AssetId<Mesh> {
    let mut shown = app.world_mut().query_filtered::<&Mesh3d, With<MorphCollider>>();
    shown.single(app.world()).unwrap().id()
}

#[test]
fn a_weight_that_is_no_number_is_one_error_or_costs_only_its_triangles() {
    Errors::collect(|errors| {
        let mut app = load(
            &field("c34_nan_weight_of_one_vertex.glb"),
            MorphColliderScene::default(),
        );
        (0..3).for_each(|_| app.update());
        let logged = errors.take();
        let why = "vertex 5, influence 0: the weight of joint 0 is NaN";
        assert!(logged.len() == 1 && logged[0].contains(why), "{logged:?}");
        let mesh = only_mesh(&mut app);

        app.settings().skip_bad_triangles = true;
        settle(&mut app);
        settle(&mut app);
        let trees = app.world().resource::<MorphTrees>();
        let left_out = trees.left_out(mesh).expect("triangles are left out");
        assert_eq!((left_out.triangles, left_out.of_triangles), (6, 68));
        assert_eq!(trees.error(mesh), None);
        let warned = errors.take_warnings();
        let told = |warned: &&String| warned.contains("6 of its 68 triangles are left out");
        assert_eq!(warned.iter().filter(told).count(), 1, "{warned:?}");
        assert_eq!(errors.take(), [""; 0]);
    });
}

/// Nothing said that Bevy draws another shape than the file has.
#[test]
fn a_mesh_with_twelve_joints_per_vertex_warns_once_that_bevy_draws_four() {
    Errors::collect(|errors| {
        let file = field("c01_twelve_influences.glb");
        let mut app = load(&file, MorphColliderScene::default());
        show(&mut app, &file, MorphColliderScene::default());
        (0..3).for_each(|_| app.update());
        let warned = errors.take_warnings();
        let is_about = |warned: &&String| warned.contains("more than four joints per vertex");
        let about: Vec<&String> = warned.iter().filter(is_about).collect();
        assert_eq!(about.len(), 1, "{warned:?}");
        assert!(about[0].contains("`c01_twelve_influences.glb#Mesh0`"), "{warned:?}");
        let blamed = warned.iter().any(|warned| warned.contains("do not sum to 1"));
        assert!(!blamed, "those of the file do: {warned:?}");
        let mut shown = app
            .world_mut()
            .query_filtered::<(&Mesh3d, &SkinnedMesh), With<MorphCollider>>();
        let (mesh, skin) = shown.iter(app.world()).next().unwrap();
        let trees = app.world().resource::<MorphTrees>();
        assert!(trees.shown_with(mesh, None, Some(skin)).is_some());
    });
}
