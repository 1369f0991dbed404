//! The generated models have their documented properties.

use glam::Vec3;
use morph_collision_models::clip::looped;
use morph_collision_models::generated::{self, topology};
use morph_collision_models::mesh::MorphMesh;

/// Base and every target at full weight.
fn references(mesh: &MorphMesh) -> Vec<Vec<Vec3>> {
    let targets = (0..mesh.targets.len()).map(|target| mesh.reference(target));
    std::iter::once(mesh.positions.clone()).chain(targets).collect()
}

/// Checks for closed pieces, each facing outward in every reference.
#[track_caller]
fn assert_solid(mesh: &MorphMesh, pieces: usize) {
    assert_eq!(topology::open_edge(&mesh.triangles), None, "{} is closed", mesh.name);
    let components = topology::components(mesh.positions.len(), &mesh.triangles);
    assert_eq!(components.len(), pieces, "pieces of {}", mesh.name);
    for (reference, positions) in references(mesh).iter().enumerate() {
        for (piece, triangles) in components.iter().enumerate() {
            let volume = topology::signed_volume(positions, triangles.iter().map(|&t| mesh.triangles[t]));
            assert!(
                volume > 1e-4,
                "{}, reference {reference}, piece {piece}: volume {volume}",
                mesh.name
            );
        }
    }
}

fn volume(mesh: &MorphMesh, positions: &[Vec3]) -> f64 {
    topology::signed_volume(positions, mesh.triangles.iter().copied())
}

#[test]
fn dolphins_have_the_papers_triangle_counts_and_are_closed() {
    for (level, triangles) in [564, 2256, 9024, 36096].into_iter().enumerate() {
        let dolphin = generated::dolphin(level as u32);
        assert_eq!(dolphin.triangles.len(), triangles);
        assert_eq!(dolphin.name, format!("dolphin_{triangles}"));
        assert_solid(&dolphin, 5);
    }
}

#[test]
fn the_heaving_body_is_solid_at_every_moment_and_its_rim_rests() {
    let body = generated::heaving_body();
    assert_eq!(body.triangles.len(), 5120);
    assert_solid(&body, 1);
    let clip = &body.animations[0];
    assert_eq!(clip.weights.first(), clip.weights.last(), "it loops");
    let rims = |p: &Vec3| Vec3::new(p.x / 1.2, 0.0, p.z).length() > 0.99;
    let rest: Vec<Vec3> = body.positions.iter().copied().filter(rims).collect();
    assert!(rest.len() > 20, "{}", rest.len());
    let mut highest = Vec::new();
    for moment in 0..40 {
        let posed = body.posed(&clip.sample(looped(0.2 * moment as f32, clip.duration())));
        assert!(volume(&body, &posed) > 0.1);
        for (p, rest) in posed.iter().zip(&body.positions).filter(|(_, rest)| rims(rest)) {
            assert!(p.distance(*rest) < 1e-4, "{rest} goes to {p}");
        }
        highest.push(posed.iter().fold(f32::MIN, |highest, p| highest.max(p.y)));
        // The top faces up and is no steeper than a character can climb.
        for &[a, b, c] in &body.triangles {
            let [a, b, c] = [a, b, c].map(|v| posed[v as usize]);
            let middle = (a + b + c) / 3.0;
            let normal = (b - a).cross(c - a).normalize();
            let on_top = middle.y > -0.005;
            assert!(!on_top || normal.y > 0.71, "{normal} at {middle}");
        }
    }
    let (low, high) = highest
        .iter()
        .fold((f32::MAX, f32::MIN), |(low, high), &y| (low.min(y), high.max(y)));
    assert!(high - low > 0.05, "from {low} to {high}");
}

#[test]
fn finer_dolphins_have_the_same_shape_in_every_pose() {
    let (coarse, fine) = (generated::dolphin(0), generated::dolphin(2));
    assert_eq!(
        fine.positions[..coarse.positions.len()],
        coarse.positions,
        "old vertices stay"
    );
    for weights in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.25]] {
        let (coarse_posed, fine_posed) = (coarse.posed(&weights), fine.posed(&weights));
        // Triangle t of the coarse mesh covers triangles 16 t .. 16 t + 16 of the fine one. All coordinates are on a
        // binary grid, so the fine vertices lie exactly in the middle of, or between, the coarse corners.
        for (t, corners) in coarse.triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|v| coarse_posed[v as usize]);
            let middle = fine.triangles[16 * t + 15].map(|v| fine_posed[v as usize]);
            let expected = [
                (a * 2.0 + b + c) / 4.0,
                (a + b * 2.0 + c) / 4.0,
                (a + b + c * 2.0) / 4.0,
            ];
            for corner in expected {
                assert!(middle.contains(&corner), "triangle {t} at weights {weights:?}");
            }
        }
        let (coarse_volume, fine_volume) = (volume(&coarse, &coarse_posed), volume(&fine, &fine_posed));
        assert!(
            (coarse_volume - fine_volume).abs() < 1e-12,
            "{coarse_volume} {fine_volume}"
        );
    }
}

#[test]
fn a_dolphin_keeps_its_length_and_is_symmetric() {
    let dolphin = generated::dolphin(1);
    let neutral_volume = volume(&dolphin, &dolphin.positions);
    for positions in references(&dolphin) {
        let (low, high) = positions
            .iter()
            .fold((Vec3::MAX, Vec3::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
        assert!((1.8..=2.01).contains(&(high.x - low.x)), "length {}", high.x - low.x);
        assert!((low.z + high.z).abs() < 1e-6, "from {} to {}", low.z, high.z);
        let change = volume(&dolphin, &positions) / neutral_volume;
        assert!(
            (0.95..=1.05).contains(&change),
            "bending changes the volume by {change}"
        );
    }
    let tail = |positions: &[Vec3]| {
        positions
            .iter()
            .copied()
            .reduce(|a, b| if b.x < a.x { b } else { a })
            .map_or(0.0, |p| p.y)
    };
    assert!(tail(&dolphin.reference(0)) < -0.2, "down is down");
    assert!(tail(&dolphin.reference(1)) > 0.2, "up is up");
}

#[test]
fn the_swim_clip_loops_with_weights_a_convex_blend_can_have() {
    let dolphin = generated::dolphin(0);
    let swim = &dolphin.animations[0];
    assert_eq!((swim.name.as_str(), swim.duration()), ("swim", 1.6));
    assert_eq!(swim.weights.first(), swim.weights.last());
    assert!(
        swim.weights
            .iter()
            .all(|w| w.iter().all(|&w| w >= 0.0) && w.iter().sum::<f32>() <= 1.0)
    );
    assert_eq!((swim.sample(0.4), swim.sample(1.2)), (vec![1.0, 0.0], vec![0.0, 1.0]));
}

#[test]
fn the_pass_through_body_is_closed_and_differs_in_every_reference() {
    let body = generated::pass_through_body();
    assert_eq!(body.triangles.len(), 20480);
    assert_solid(&body, 1);
    let references = references(&body);
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        let moved = references[a]
            .iter()
            .zip(&references[b])
            .filter(|(a, b)| a.distance(**b) > 0.1)
            .count();
        assert!(
            moved * 2 > body.positions.len(),
            "references {a} and {b} differ in {moved} vertices"
        );
    }
}

#[test]
fn blobs_are_closed_and_repeatable_and_as_sparse_as_asked() {
    let blob = generated::random::random_blob(5, 3, 6, 0.75);
    assert_eq!(blob, generated::random::random_blob(5, 3, 6, 0.75));
    assert_ne!(blob.positions, generated::random::random_blob(6, 3, 6, 0.75).positions);
    assert_eq!(topology::open_edge(&blob.triangles), None);
    for (index, target) in blob.targets.iter().enumerate() {
        let still = target.iter().filter(|d| **d == Vec3::ZERO).count() as f32 / target.len() as f32;
        assert!((still - 0.75).abs() < 0.05, "target {index} leaves {still} alone");
    }
    let dense = generated::random::random_blob(5, 1, 1, 0.0);
    assert!(dense.targets[0].iter().all(|d| *d != Vec3::ZERO));
    let rigid = generated::random::random_blob(5, 1, 1, 1.0);
    assert!(rigid.targets[0].iter().all(|d| *d == Vec3::ZERO));
}

#[test]
fn degenerate_meshes_are_degenerate_in_every_pose() {
    let area = |mesh: &MorphMesh, positions: &[Vec3], t: usize| {
        let [a, b, c] = mesh.triangles[t].map(|v| positions[v as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    for mesh in [
        generated::degenerate::zero_area(2, 60),
        generated::degenerate::all_equal(4),
    ] {
        for weights in [[0.0], [1.0], [-0.5]] {
            let posed = mesh.posed(&weights);
            assert!(
                (0..mesh.triangles.len()).all(|t| area(&mesh, &posed, t) == 0.0),
                "{} at {weights:?}",
                mesh.name
            );
        }
    }
    let slivers = generated::degenerate::slivers(2, 60);
    assert!((0..60).all(|t| (0.0..1e-5).contains(&area(&slivers, &slivers.positions, t))));
    let sheets = generated::degenerate::coplanar_sheets(2, 5);
    assert_eq!(sheets.triangles.len(), 5 * 18);
    assert!(sheets.posed(&[0.7]).iter().all(|p| p.z == 0.0));
}

#[test]
fn duplicating_vertices_changes_no_triangle() {
    let mesh = generated::random::random_blob(1, 1, 2, 0.5);
    let duplicated = generated::degenerate::duplicated_vertices(&mesh);
    assert_eq!(duplicated.positions.len(), mesh.triangles.len() * 3);
    let drawn = |mesh: &MorphMesh| {
        let posed = mesh.posed(&[0.3, -0.4]);
        mesh.triangles
            .iter()
            .map(|t| t.map(|v| posed[v as usize]))
            .collect::<Vec<_>>()
    };
    assert_eq!(drawn(&mesh), drawn(&duplicated));
}

#[test]
fn rigid_shapes_are_what_they_are() {
    let half = Vec3::new(1.0, 2.0, 0.5);
    let cuboid = generated::rigid::box_mesh(half);
    assert_eq!(topology::open_edge(&cuboid.triangles), None);
    assert_eq!(volume(&cuboid, &cuboid.positions), 8.0);

    let sheet = generated::rigid::grid(2.0, 3);
    assert_eq!((sheet.positions.len(), sheet.triangles.len()), (16, 18));
    let upward = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| sheet.positions[v as usize]);
        (b - a).cross(c - a).y > 0.0
    };
    assert!(sheet.triangles.iter().all(upward));
}

#[test]
fn every_generated_mesh_becomes_a_model() {
    use generated::{degenerate, random, rigid};
    for mesh in [
        generated::dolphin(0),
        random::random_blob(1, 1, 3, 0.5),
        random::triangle_soup(1, 20, 2),
        degenerate::slivers(1, 10),
        degenerate::zero_area(1, 10),
        degenerate::coplanar_sheets(1, 2),
        degenerate::duplicated_vertices(&rigid::box_mesh(Vec3::ONE)),
        degenerate::all_equal(2),
        rigid::grid(1.0, 2),
    ] {
        match mesh.to_model() {
            Ok(model) => assert_eq!(model.triangle_count(), mesh.triangles.len(), "{}", mesh.name),
            Err(error) => panic!("{}: {error}", mesh.name),
        }
    }
}
