//! A real head as several meshes: skin, eyes, teeth. It is one body; checked by brute force over all of its triangles.

use std::collections::HashMap;

use bevy::gltf::Gltf;
use bevy::math::DVec3;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{point_distance, posed_vertices};
use morph_collision_workspace::app::{headless, load_gltf};

use crate::log::start;
use crate::support::{Edits, Messages, assets, settle};

/// The head in the repository, with one primitive for each of its four largest connected parts and one for the rest.
fn head_of_five_parts() -> MorphMesh {
    let file = assets().join("mh_head_eyes_teeth_arkit52.glb");
    let mut head = read_meshes(&file)
        .expect("the head comes with the repository")
        .remove(0);
    // For each vertex, the smallest vertex that it is connected with by triangles or by position.
    let mut first_at = HashMap::new();
    let mut part: Vec<u32> = (0..)
        .zip(&head.positions)
        .map(|(vertex, place)| *first_at.entry(place.to_array().map(f32::to_bits)).or_insert(vertex))
        .collect();
    loop {
        let before = part.clone();
        for triangle in &head.triangles {
            let least = triangle.map(|v| part[v as usize]).into_iter().min().unwrap_or_default();
            for &v in triangle {
                let root = part[v as usize] as usize;
                part[root] = part[root].min(least);
                part[v as usize] = least;
            }
        }
        for v in 0..part.len() {
            part[v] = part[part[v] as usize];
        }
        if part == before {
            break;
        }
    }
    let mut sizes: HashMap<u32, usize> = HashMap::new();
    for triangle in &head.triangles {
        *sizes.entry(part[triangle[0] as usize]).or_default() += 1;
    }
    let mut largest: Vec<u32> = sizes.keys().copied().collect();
    largest.sort_by_key(|root| (std::cmp::Reverse(sizes[root]), *root));
    let number = |triangle: &[u32; 3]| {
        largest
            .iter()
            .position(|&root| root == part[triangle[0] as usize])
            .unwrap_or(4)
            .min(4)
    };
    head.triangles.sort_by_key(number);
    head.primitives = (0..5)
        .map(|i| {
            let [begin, end] =
                [i, i + 1].map(|i| head.triangles.partition_point(|triangle| number(triangle) < i) as u32);
            begin..end
        })
        .collect();
    head
}

/// The distance from a point to the nearest triangle.
fn distance(p: DVec3, vertices: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let corners = |triangle: &[u32; 3]| triangle.map(|v| vertices[v as usize].as_dvec3());
    let distances = triangles.iter().map(|triangle| point_distance(p, &corners(triangle)));
    distances.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_real_head_of_five_parts_is_one_body() {
    let head = head_of_five_parts();
    let folder = tempfile::tempdir().expect("there is room for a file");
    let file = folder.path().join("head.glb");
    write_glb(&file, &head, &Appearance::default()).expect("the head can be written");
    let mut app = headless(folder.path());
    start(&mut app);
    let gltf = load_gltf(&mut app, &file).expect("the head can be loaded");
    let files = app.world().resource::<Assets<Gltf>>();
    let scene = files
        .get(&gltf)
        .and_then(|gltf| gltf.default_scene.clone())
        .expect("it has a scene");

    #[derive(Resource, Default)]
    struct Heard(Vec<&'static str>);
    app.init_resource::<Heard>();
    let root = app
        .world_mut()
        .spawn((WorldAssetRoot(scene), MorphColliderScene::default()))
        .observe(|_: On<MorphBodyCollisionStart>, mut heard: ResMut<Heard>| heard.0.push("start"))
        .observe(|_: On<MorphBodyCollisionEnd>, mut heard: ResMut<Heard>| heard.0.push("end"))
        .id();
    settle(&mut app);
    let parts = app.world().get::<MorphColliders>(root);
    assert!(parts.is_some_and(|parts| parts.len() == 5), "{parts:?}");

    // A ball approaches the open mouth from the front until it touches teeth, and goes away again.
    let open = head
        .target_names
        .iter()
        .position(|name| name == "jawOpen")
        .expect("a jaw opens");
    let mut nodes = app.world_mut().query::<&mut MorphWeights>();
    for mut weights in nodes.iter_mut(app.world_mut()) {
        weights.weights_mut()[open] = 1.0;
    }
    let mut weights = vec![0.0; head.targets.len()];
    weights[open] = 1.0;
    let vertices = posed_vertices(&head.positions, &head.targets, &weights);
    let teeth = head.primitives[3].clone();
    let teeth = head.triangles[teeth.start as usize..teeth.end as usize].as_flattened();
    let center = teeth.iter().map(|&v| vertices[v as usize]).sum::<Vec3>() / teeth.len() as f32;
    let (low, high) = vertices
        .iter()
        .fold((Vec3::MAX, Vec3::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    let size = (high - low).x;
    let radius = 0.3 * size;
    let ball = app.spawn(MorphShape::from(Sphere::new(radius)));
    let mut messages = Messages::default();
    let (mut part_starts, mut truth) = (0, Vec::new());
    for step in (0..=24).chain((0..24).rev()) {
        let z = high.z + 0.5 * size - 0.03 * size * step as f32;
        let place = Vec3::new(center.x, center.y, z);
        app.insert(ball, Transform::from_translation(place));
        app.update();
        part_starts += messages.read(&app).0.len();
        let gap = distance(place.as_dvec3(), &vertices, &head.triangles) - f64::from(radius);
        assert!(gap.abs() > 1e-5 * f64::from(size), "too close to tell");
        let collisions = app.world().resource::<MorphCollisions>();
        assert_eq!(collisions.contains_bodies(root, ball), gap < 0.0, "step {step}: {gap}");
        if truth.last() != Some(&(gap < 0.0)) {
            truth.push(gap < 0.0);
        }
    }
    assert_eq!(truth, [false, true, false], "by brute force");
    assert!(part_starts >= 3, "{part_starts} parts were touched");
    assert_eq!(app.world().resource::<Heard>().0, ["start", "end"]);
}
