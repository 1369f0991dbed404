//! Unusable meshes are logged once by name and left out, and do no harm to other meshes.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology, VertexAttributeValues, VertexFormat, morph::MorphAttributes};
use bevy::prelude::*;
use bevy_morph_collision::import::{ImportError, MorphTrees};
use bevy_morph_collision::morph_collision::ModelError;

use crate::log::Errors;
use crate::support::{
    Edits, add_mesh, app, bevy_mesh, cube, diagnostics, move_to, settle, spawn, stretching_cube, touches, two_cubes,
};

fn empty(topology: PrimitiveTopology) -> Mesh {
    Mesh::new(topology, RenderAssetUsages::default())
}

fn with_positions(positions: Vec<Vec3>) -> Mesh {
    empty(PrimitiveTopology::TriangleList).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
}

/// A mesh that moves its data to the renderer, after that has happened.
fn extracted() -> Mesh {
    let mut mesh = bevy_mesh(&cube());
    mesh.take_gpu_data().expect("the data has not been taken before");
    mesh
}

/// A mesh with compressed positions but without the bounds to decode them.
fn compressed_without_bounds() -> Mesh {
    let mut mesh = bevy_mesh(&cube());
    mesh.compress_positions().expect("a cube can be compressed");
    mesh.final_aabb = None;
    mesh
}

fn with_whole_numbers() -> Mesh {
    let mut attribute = Mesh::ATTRIBUTE_POSITION;
    attribute.format = VertexFormat::Sint32x3;
    empty(PrimitiveTopology::TriangleList)
        .with_inserted_attribute(attribute, VertexAttributeValues::Sint32x3(vec![[0, 1, 2]; 3]))
}

/// Like the glTF loader's result for meshes without normals: split vertices, but unsplit displacements.
fn split_with_names() -> Mesh {
    let mut mesh = bevy_mesh(&stretching_cube());
    mesh.set_morph_target_names(vec!["stretch".into()]);
    mesh.duplicate_vertices();
    mesh
}

/// Adds the mesh between two cubes that touch, and returns the reason why it is refused.
fn refusal(mesh: Mesh) -> ImportError {
    let mut found = None;
    Errors::collect(|errors| {
        let mut app = app();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        let good = add_mesh(&mut app, &cube());
        let [a, broken, b] = [(&good, 0.0), (&mesh, 0.4), (&good, 0.8)].map(|(mesh, x)| spawn(&mut app, mesh, x));
        app.insert(broken, Name::new("broken thing"));
        settle(&mut app);
        app.update();

        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        found = app.world().resource::<MorphTrees>().error(mesh.id()).cloned();
        let reason = found.as_ref().map(ToString::to_string).unwrap_or_default();
        for part in ["the mesh of entity `broken thing`", &reason] {
            assert!(logged[0].contains(part), "{logged:?} does not name {part}");
        }
        assert_eq!(diagnostics(&app).colliders, 2);
        assert!(touches(&app, a, b), "the others work on");
    });
    found.expect("the mesh is refused")
}

#[test]
fn data_that_is_not_there_or_cannot_be_read_is_refused() {
    assert_eq!(refusal(extracted()), ImportError::Extracted);
    assert_eq!(
        refusal(
            empty(PrimitiveTopology::LineList).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vec![Vec3::ZERO; 6])
        ),
        ImportError::Topology(PrimitiveTopology::LineList)
    );
    assert_eq!(
        refusal(empty(PrimitiveTopology::TriangleList)),
        ImportError::NoPositions
    );
    assert_eq!(refusal(compressed_without_bounds()), ImportError::NoPositionBounds);
    let refused = refusal(with_whole_numbers());
    assert!(
        matches!(refused, ImportError::PositionFormat(format) if format.contains("Sint32")),
        "{refused}"
    );
}

#[test]
fn shapes_that_make_no_sense_are_refused() {
    assert_eq!(
        refusal(with_positions(vec![])),
        ImportError::Model(ModelError::NoVertices)
    );
    let mesh = with_positions(vec![Vec3::ZERO; 3]).with_inserted_indices(Indices::U16(vec![]));
    assert_eq!(refusal(mesh), ImportError::Model(ModelError::NoTriangles));
    assert_eq!(
        refusal(with_positions(vec![Vec3::ZERO; 5])),
        ImportError::IncompleteTriangle(5)
    );
    let mesh = with_positions(vec![Vec3::ZERO; 3]).with_inserted_indices(Indices::U32(vec![0, 1, 3]));
    assert!(matches!(
        refusal(mesh),
        ImportError::Model(ModelError::IndexOutOfRange {
            triangle: 0,
            corner: 2,
            index: 3,
            ..
        })
    ));
    let refused = refusal(with_positions(vec![Vec3::ZERO, Vec3::X, Vec3::NAN]));
    assert!(
        matches!(refused, ImportError::Model(ModelError::BadCoordinate { vertex: 2, .. })),
        "{refused}"
    );
}

#[test]
fn displacements_that_do_not_fit_the_vertices_are_refused() {
    let mut mesh = bevy_mesh(&cube());
    mesh.set_morph_targets(vec![MorphAttributes::default(); 9]);
    assert!(matches!(
        refusal(mesh),
        ImportError::TargetLength {
            displacements: 9,
            vertices: 8,
            ..
        }
    ));
}

#[test]
fn a_mesh_split_for_flat_shading_is_refused_with_what_to_do() {
    let refused = refusal(split_with_names());
    let expected = ImportError::SplitVertices {
        displacements: 8,
        vertices: 36,
    };
    assert_eq!(refused, expected);
    let text = refused.to_string();
    for part in [
        "no normals",
        "Export it with normals",
        "`MorphCollisionPlugin`",
        "feature `gltf`",
    ] {
        assert!(text.contains(part), "{text} does not say {part}");
    }
    // A mesh with indices has not been split, whatever its target names say.
    let mut mesh = bevy_mesh(&stretching_cube());
    mesh.set_morph_target_names(vec!["one".into(), "two".into()]);
    mesh.set_morph_targets(vec![MorphAttributes::default(); 12]);
    assert!(matches!(refusal(mesh), ImportError::TargetLength { .. }));
}

/// The events for a collider whose mesh is only for the renderer, which takes the data away at the end of the
/// first frame.
fn heard_of_renderer_only(mesh_first: bool) -> (Option<ImportError>, Vec<String>, u64) {
    let mut heard = None;
    Errors::collect(|errors| {
        let mut app = app();
        let mut mesh = bevy_mesh(&cube());
        mesh.asset_usage = RenderAssetUsages::RENDER_WORLD;
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        if !mesh_first {
            spawn(&mut app, &mesh, 0.0);
        }
        app.update();
        let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
        let taken = meshes.get_mut_untracked(&mesh).unwrap().take_gpu_data();
        taken.expect("the data is still there");
        if mesh_first {
            spawn(&mut app, &mesh, 0.0);
        }
        settle(&mut app);
        settle(&mut app);
        let error = app.world().resource::<MorphTrees>().error(mesh.id()).cloned();
        heard = Some((error, errors.take(), diagnostics(&app).colliders));
    });
    heard.unwrap()
}

#[test]
fn a_mesh_for_the_renderer_only_is_refused_whether_it_or_its_collider_comes_first() {
    let [mesh_first, collider_first] = [true, false].map(heard_of_renderer_only);
    assert_eq!(mesh_first, collider_first);
    let (error, logged, colliders) = mesh_first;
    assert_eq!((error, colliders), (Some(ImportError::Extracted), 0));
    assert_eq!(logged.len(), 1, "{logged:?}");
    for part in [
        "RENDER_WORLD",
        "RenderAssetUsages::default()",
        "GltfLoaderSettings::load_meshes",
    ] {
        assert!(logged[0].contains(part), "{logged:?} does not say {part}");
    }
}

#[test]
fn indices_of_any_kind_give_the_same_contact() {
    let list = bevy_mesh(&cube());
    let wide = list.indices().map(|indices| indices.iter().map(|i| i as u16).collect());
    let narrow = list
        .clone()
        .with_inserted_indices(Indices::U16(wide.unwrap_or_default()));
    let bare = list.clone().with_duplicated_vertices();
    // One strip around the cube and over its ends. Its triangles have other numbers, but touch the same.
    let strip = empty(PrimitiveTopology::TriangleStrip)
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, cube().positions)
        .with_inserted_indices(Indices::U16(vec![2, 3, 6, 7, 5, 3, 1, 2, 0, 6, 4, 5, 0, 1]));
    for mesh in [list, narrow, bare, strip] {
        let mut app = app();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        let [a, b] = [0.0, 1.0].map(|x| spawn(&mut app, &mesh, x));
        settle(&mut app);
        assert!(touches(&app, a, b), "faces touch at x = 0.5");
        let tree = app.world().resource::<MorphTrees>().get(mesh.id());
        assert_eq!(tree.map(|tree| tree.model().triangle_count()), Some(12));
        move_to(&mut app, b, 1.01);
        app.update();
        assert!(!touches(&app, a, b));
    }
}

#[test]
fn a_transform_that_is_not_finite_is_logged_once_and_leaves_its_collider_out() {
    Errors::collect(|errors| {
        let (mut app, [a, b]) = two_cubes(0.8);
        move_to(&mut app, b, f32::NAN);
        app.update();
        app.update();
        assert_eq!(errors.take().len(), 1);
        assert!(!touches(&app, a, b));
        assert_eq!(diagnostics(&app).colliders, 1);
        move_to(&mut app, b, 0.8);
        app.update();
        assert!(touches(&app, a, b));
        assert_eq!(errors.take(), [""; 0]);
    });
}

/// A cube with a vertex at no place.
fn cube_with_a_bad_corner() -> (Mesh, usize) {
    let mut cube = cube();
    let bad = cube.triangles.iter().filter(|corners| corners.contains(&7)).count();
    cube.positions[7].y = f32::NAN;
    (bevy_mesh(&cube), bad)
}

/// The whole mesh was refused, and once more for every change.
#[test]
fn bad_triangles_are_left_out_if_the_setting_says_so() {
    Errors::collect(|errors| {
        let mut app = app();
        let (mesh, bad) = cube_with_a_bad_corner();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        let good = add_mesh(&mut app, &cube());
        let [a, b] = [(&mesh, 0.0), (&good, -0.8)].map(|(mesh, x)| spawn(&mut app, mesh, x));
        spawn(&mut app, &mesh, 50.0);
        settle(&mut app);
        let logged = errors.take();
        assert_eq!(logged.len(), 1, "{logged:?}");
        let remedy = "`MorphCollisionSettings::skip_bad_triangles`";
        assert!(
            logged[0].contains(remedy) && logged[0].contains("base, vertex 7"),
            "{logged:?}"
        );
        for _ in 0..3 {
            let mut meshes = app.world_mut().resource_mut::<Assets<Mesh>>();
            meshes.get_mut(&mesh).unwrap().asset_usage = RenderAssetUsages::default();
            settle(&mut app);
        }
        assert_eq!(errors.take(), [""; 0], "the same again");
        assert!(!touches(&app, a, b));

        let of = |app: &App| app.world().resource::<MorphTrees>().left_out(mesh.id()).cloned();
        assert_eq!(of(&app), None);
        app.settings().skip_bad_triangles = true;
        settle(&mut app);
        settle(&mut app);
        let left_out = of(&app).expect("triangles are left out");
        assert_eq!((left_out.triangles, left_out.of_triangles), (bad, 12));
        let trees = app.world().resource::<MorphTrees>();
        assert_eq!(trees.error(mesh.id()), None);
        assert_eq!(trees.get(mesh.id()).unwrap().model().triangle_count(), 12 - bad);
        assert!(touches(&app, a, b), "the other side of the cube");
        let warned = errors.take_warnings();
        let told = format!("{bad} of its 12 triangles are left out: base, vertex 7");
        assert!(warned.len() == 1 && warned[0].contains(&told), "{warned:?}");
        assert_eq!(errors.take(), [""; 0]);
    });
}
