use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Aabb, BuildOptions, MorphBvh, Pose, SelfQuery};
use morph_collision_models::generated::{degenerate, dolphin, random};
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle;

use morph_collision_testkit::moments::real_model;

/// Brute force: the oracle's pairs of the mesh with itself, without those that share a welded vertex.
fn truth(mesh: &MorphMesh, weights: &[f32]) -> Vec<(u32, u32)> {
    let posed = oracle::posed_vertices(&mesh.positions, &mesh.targets, weights);
    let world = oracle::world_vertices(&posed, &Affine3A::IDENTITY);
    // Vertices are welded if they agree in position and in every displacement.
    let same = |v: u32, w: u32| {
        let (v, w) = (v as usize, w as usize);
        mesh.positions[v] == mesh.positions[w] && mesh.targets.iter().all(|target| target[v] == target[w])
    };
    let mut pairs = oracle::intersecting_pairs(&world, &mesh.triangles, &world, &mesh.triangles);
    pairs.retain(|&(a, b)| {
        let (ta, tb) = (mesh.triangles[a as usize], mesh.triangles[b as usize]);
        a < b && !ta.iter().any(|&v| tb.iter().any(|&w| same(v, w)))
    });
    pairs
}

fn agrees(mesh: &MorphMesh, weights: &[f32]) -> usize {
    let truth = truth(mesh, weights);
    let model = Arc::new(mesh.to_model().unwrap());
    {
        for leaf_size in [1, 4, 8, 20] {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let mut pose = Pose::new(Arc::new(MorphBvh::build(model.clone(), &options)));
            pose.set_weights(weights).unwrap();
            let mut pairs = Vec::new();
            let mut query = SelfQuery::new();
            query.all(&mut pose, &mut pairs);
            let stats = query.stats();
            let mut pairs: Vec<_> = pairs.iter().map(|p| (p.triangle_a, p.triangle_b)).collect();
            pairs.sort_unstable();
            assert_eq!(pairs, truth, "{}, leaves of {leaf_size}", mesh.name);
            assert!(stats.triangle_tests >= truth.len() as u64);
            assert_eq!(SelfQuery::new().any(&mut pose), !truth.is_empty());
        }
    }
    truth.len()
}

#[test]
fn self_intersections_agree_with_the_oracle() {
    // The dolphin's fins reach into its body, so it intersects itself in every pose.
    assert!(agrees(&dolphin(0), &[0.3, 0.4]) > 0);
    let blob = random::random_blob(4, 2, 5, 0.6);
    assert_eq!(agrees(&blob, &[0.0; 5]), 0);
    assert!(agrees(&blob, &[-3.0, 4.0, 2.0, -5.0, 3.0]) > 0);
    assert!(agrees(&random::triangle_soup(5, 80, 2), &[0.5, -1.0]) > 0);
    for mesh in [
        degenerate::slivers(1, 40),
        degenerate::zero_area(2, 40),
        degenerate::coplanar_sheets(3, 4),
    ] {
        agrees(&mesh, &vec![0.5; mesh.targets.len()]);
    }
}

/// With one triangle per leaf and tight boxes, the exact test runs only for pairs whose own boxes overlap, and once for each.
#[test]
fn only_pairs_whose_boxes_overlap_are_tested_each_of_them_once() {
    for (mesh, weights) in [
        (dolphin(0), vec![0.3, 0.4]),
        (random::random_blob(4, 2, 5, 0.6), vec![-3.0, 4.0, 2.0, -5.0, 3.0]),
        (random::triangle_soup(5, 80, 2), vec![0.5, -1.0]),
    ] {
        let model = Arc::new(mesh.to_model().unwrap());
        {
            let options = BuildOptions::default().with_leaf_size(1).unwrap();
            let bvh = MorphBvh::build(model.clone(), &options);
            assert_eq!(bvh.leaf_count(), mesh.triangles.len());
            let mut pose = Pose::new(Arc::new(bvh));
            pose.set_weights(&weights).unwrap();
            pose.refit();
            let mut corners = |triangle: u32| {
                let points = pose.triangle(triangle).unwrap();
                (model.triangle(triangle).unwrap(), Aabb::from_points(points))
            };
            let triangles: Vec<_> = (0..mesh.triangles.len() as u32).map(&mut corners).collect();
            let mut expected = 0;
            for (i, (vertices, bounds)) in triangles.iter().enumerate() {
                for (others, other) in &triangles[..i] {
                    let neighbours = vertices.iter().any(|vertex| others.contains(vertex));
                    expected += u64::from(!neighbours && bounds.overlaps(other));
                }
            }
            let all = (triangles.len() * (triangles.len() - 1) / 2) as u64;
            assert!(expected > 0 && expected < all / 2, "{expected} of {all}");
            let mut query = SelfQuery::new();
            query.all(&mut pose, &mut Vec::new());
            let stats = query.stats();
            assert_eq!(stats.triangle_tests, expected, "{}", mesh.name);
        }
    }
}

#[test]
fn vertices_split_along_seams_do_not_make_neighbours_collide() {
    let mesh = degenerate::duplicated_vertices(&random::random_blob(4, 2, 5, 0.6));
    assert_eq!(agrees(&mesh, &[0.0; 5]), 0);
}

#[test]
fn a_face_that_moves_its_lips_and_tongue_agrees_with_the_oracle() {
    let path = real_model("mh_head_eyes_teeth_arkit52.glb").expect("the head is in assets/");
    let mesh = read_meshes(&path).unwrap().swap_remove(0);
    let weights: Vec<f32> = (0..mesh.targets.len())
        .map(|k| if k % 3 == 0 { 0.7 } else { 0.0 })
        .collect();
    let truth = truth(&mesh, &weights);
    let model = Arc::new(mesh.to_model().unwrap());
    let mut pose = Pose::new(Arc::new(MorphBvh::build(model, &BuildOptions::default())));
    pose.set_weights(&weights).unwrap();
    let mut pairs = Vec::new();
    SelfQuery::new().all(&mut pose, &mut pairs);
    let mut pairs: Vec<_> = pairs.iter().map(|p| (p.triangle_a, p.triangle_b)).collect();
    pairs.sort_unstable();
    assert!(!truth.is_empty());
    assert_eq!(pairs, truth);
}
