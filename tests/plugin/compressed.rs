//! Compressed meshes collide at the places of their decoded vertices.

use std::path::Path;

use bevy::ecs::system::RunSystemOnce;
use bevy::gltf::{Gltf, GltfLoaderSettings};
use bevy::math::DVec3;
use bevy::mesh::morph::MorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::mesh::{AttributeQuantization, MeshCompressionArgs, VertexAttributeValues};
use bevy::prelude::*;
use bevy_morph_collision::morph_collision::Pose;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::intersecting_pairs;
use morph_collision_workspace::app::headless;
use morph_collision_workspace::{crowd, drawn};

use crate::log::start;
use crate::support::{app, assets, bevy_mesh, cube, settle, spawn};

/// A model at two overlapping places, loaded with compressed meshes.
fn load_compressed(file: &Path, places: &[Transform]) -> App {
    let mut app = headless(&assets());
    start(&mut app);
    let compress = |settings: &mut GltfLoaderSettings| {
        settings.mesh_compression = Some(MeshCompressionArgs {
            // Joint weights are not quantized, so they are those of the file.
            quantize_attributes: (&[]).into(),
            ..MeshCompressionArgs::regular()
        });
    };
    let assets = app.world().resource::<AssetServer>();
    let name = file.file_name().unwrap().to_str().unwrap().to_owned();
    let _kept: Handle<Gltf> = assets.load_builder().with_settings(compress).load(name);
    crowd::spawn(&mut app, file, places, MorphColliderScene::default()).expect("the model can be loaded");
    settle(&mut app);
    app
}

/// Moves the vertices of a file that a primitive shows to their places in the compressed mesh.
///
/// Returns the largest distance of a vertex from its place in the file, relative to the rounding that compression may
/// cause.
fn decode(drawn: &Mesh, file: &mut MorphMesh, corners: &[u32]) -> f32 {
    let Some(VertexAttributeValues::Snorm16x4(values)) = drawn.attribute(Mesh::ATTRIBUTE_POSITION) else {
        panic!("positions are compressed")
    };
    // Without normals, each triangle has its own vertices.
    let vertices: Vec<usize> = match drawn.indices() {
        Some(indices) => indices.iter().collect(),
        None => (0..corners.len()).collect(),
    };
    let original: Vec<Vec3> = corners.iter().map(|&corner| file.positions[corner as usize]).collect();
    let mut farthest = 0.0_f32;
    for axis in 0..3 {
        let along = || original.iter().map(|p| p[axis]);
        let (min, max) = (along().fold(f32::MAX, f32::min), along().fold(f32::MIN, f32::max));
        let (middle, half) = ((min + max) * 0.5, (max - min) * 0.5);
        for ((&corner, &vertex), original) in corners.iter().zip(&vertices).zip(along()) {
            let moved = half * (f32::from(values[vertex][axis]) / 32767.0);
            let decoded = middle + moved;
            file.positions[corner as usize][axis] = decoded;
            farthest = farthest.max((decoded - original).abs() / (half / 32767.0 + f32::EPSILON * max.abs()));
        }
    }
    farthest
}

/// Compares all contacts between two copies of a model with brute force; returns the number of pairs of triangles.
fn collides_as_decoded(name: &str, apart: Vec3) -> usize {
    let file = assets().join(name);
    let places = [Transform::default(), Transform::from_translation(apart)];
    let mut app = load_compressed(&file, &places);
    let mut weights = app.world_mut().query::<&mut MorphWeights>();
    for (number, mut weights) in weights.iter_mut(app.world_mut()).enumerate() {
        for (target, weight) in weights.weights_mut().iter_mut().enumerate() {
            *weight = if (target + number) % 5 == 0 { 0.375 } else { 0.0 };
        }
    }
    app.update();

    let mut meshes = read_meshes(&file).unwrap();
    let parts = drawn::parts::<With<MorphCollider>>(app.world_mut(), &meshes);
    assert!(parts.len() >= 2, "{name}");
    let original = meshes.clone();
    for part in &parts {
        let shown = app.world().get::<Mesh3d>(part.entity).unwrap();
        let drawn = app.world().resource::<Assets<Mesh>>().get(shown).unwrap();
        let corners = part.triangles(&original).as_flattened();
        let mut decoded = original[part.mesh].clone();
        let farthest = decode(drawn, &mut decoded, corners);
        assert!((0.25..=1.0).contains(&farthest), "{name}: {farthest}");
        let skin = app.world().get::<SkinnedMesh>(part.entity);
        let tree = app.world().resource::<MorphTrees>().shown_with(shown, None, skin);
        let mut pose = Pose::new(tree.expect("the mesh has a tree").clone());
        // For the skinned model, contacts are checked below.
        let triangles = part.triangles(&original).iter().filter(|_| skin.is_none());
        for (number, corners) in (0..).zip(triangles) {
            let expected = corners.map(|corner| decoded.positions[corner as usize]);
            assert_eq!(pose.triangle(number), Some(expected), "{name}: triangle {number}");
        }
        for &corner in corners {
            meshes[part.mesh].positions[corner as usize] = decoded.positions[corner as usize];
        }
    }
    let vertices: Vec<Vec<DVec3>> = parts
        .iter()
        .map(|part| drawn::vertices(app.world(), &meshes[part.mesh], part.entity))
        .collect();
    let collisions = app.world().resource::<MorphCollisions>();
    let body = |part: &drawn::Part| app.world().get::<MorphColliderOf>(part.entity).copied();
    let mut total = 0;
    for (i, a) in parts.iter().enumerate() {
        for (j, b) in parts.iter().enumerate().filter(|(_, b)| a.entity < b.entity) {
            if body(a) == body(b) {
                continue;
            }
            let expected = intersecting_pairs(&vertices[i], a.triangles(&meshes), &vertices[j], b.triangles(&meshes));
            let found = collisions.get(a.entity, b.entity);
            let mut found: Vec<(u32, u32)> = found
                .into_iter()
                .flat_map(|contact| contact.triangles.iter().map(|pair| (pair.triangle_a, pair.triangle_b)))
                .collect();
            found.sort_unstable();
            assert_eq!(found, expected, "{name}");
            total += found.len();
        }
    }
    total
}

#[test]
fn compressed_files_collide_exactly_where_their_decoded_vertices_are() {
    let head = collides_as_decoded("mh_head_eyes_teeth_arkit52.glb", Vec3::new(0.06, 0.013, 0.021));
    let character = collides_as_decoded("mh_character_low.glb", Vec3::new(0.11, 0.02, 0.03));
    println!("{head} and {character} pairs of triangles");
    assert!(head > 100 && character > 100, "{head}, {character}");
}

/// The texture coordinates where a ray along -z hits a cube at (0.1, -0.2).
fn uv_of_hit(mesh: Mesh) -> Option<Vec2> {
    let mut app = app();
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    spawn(&mut app, &mesh, 0.0);
    settle(&mut app);
    let cast = |spatial: MorphSpatialQuery| {
        let any = MorphQueryFilter::default();
        let hit = spatial.cast_ray(Vec3::new(0.1, -0.2, 2.0), Dir3::NEG_Z, 9.0, &any);
        hit.expect("the ray meets the cube").uv
    };
    app.world_mut().run_system_once(cast).unwrap()
}

#[test]
fn texture_coordinates_are_decoded_too() {
    // Outside of 0 to 1, as for tiled textures.
    let tiled = |p: &Vec3| [p.x * 8.0 - 3.0, 2.0 + p.y * 3.0];
    let once = |p: &Vec3| [p.x + 0.5, p.y + 0.5];
    let with = |uv: &dyn Fn(&Vec3) -> [f32; 2]| {
        let uvs: Vec<[f32; 2]> = cube().positions.iter().map(uv).collect();
        bevy_mesh(&cube()).with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    };
    let mut compressed = with(&tiled);
    compressed.compress_positions().unwrap().compress_uv0().unwrap();
    let is = |mesh: Mesh, expected: Vec2, error: f32| {
        let uv = uv_of_hit(mesh).expect("the mesh has texture coordinates");
        assert!(uv.distance(expected) <= error, "{uv} instead of {expected}");
    };
    is(with(&tiled), Vec2::new(-2.2, 1.4), 1e-5);
    is(compressed, Vec2::new(-2.2, 1.4), 8.0 / 65535.0);
    use AttributeQuantization::{Float16, Snorm8, Snorm16, Unorm8, Unorm16};
    for (quantization, error) in [
        (Unorm16, 2e-5),
        (Unorm8, 4e-3),
        (Snorm16, 4e-5),
        (Snorm8, 8e-3),
        (Float16, 1e-3),
    ] {
        let mut mesh = with(&once);
        mesh.quantize_float32_attribute(Mesh::ATTRIBUTE_UV_0, quantization)
            .unwrap();
        is(mesh, Vec2::new(0.6, 0.3), error);
    }
}
