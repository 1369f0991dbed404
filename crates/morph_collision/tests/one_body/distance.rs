//! Distances of two bodies, checked against every pair of triangles.

use glam::{Affine3A, Quat, Vec3};
use morph_collision::{Body, ClosestPair, DistanceQuery};
use morph_collision_models::generated::{degenerate, random};

use crate::bodies::{self, Case};
use crate::reference::{Corners, point_triangle, touch, triangles as triangle_distance};

/// The smallest distance by brute force, and whether any triangles share a point.
fn truth(a: &[Corners], b: &[Corners]) -> (f64, bool) {
    let mut least = f64::INFINITY;
    for s in a {
        for t in b {
            if touch(s, t) {
                return (0.0, true);
            }
            least = least.min(triangle_distance(s, t));
        }
    }
    (least, false)
}

fn agrees(a: &Case, b: &Case) -> bool {
    let name = format!("{} and {}", a.name, b.name);
    let (triangles_a, triangles_b) = (a.world_triangles(), b.world_triangles());
    let (place_a, place_b) = (a.world_from_model(), b.world_from_model());
    let (least, touching) = truth(&triangles_a, &triangles_b);
    let slack = 1e-10 * (1.0 + least);
    let mut query = DistanceQuery::new();
    let mut first: Option<ClosestPair> = None;
    // Trees with equal and with different options.
    let poses_b = b.poses().into_iter().rev().chain(b.poses());
    for (mut pose_a, mut pose_b) in a.poses().into_iter().cycle().zip(poses_b) {
        let mut closest = |limit| {
            let bodies = (Body::new(&mut pose_a, &place_a), Body::new(&mut pose_b, &place_b));
            query.closest(bodies.0, bodies.1, limit).unwrap()
        };
        let pair = closest(f64::INFINITY).unwrap();
        assert!((pair.distance - least).abs() <= slack, "{name}: {pair:?}, not {least}");
        assert_eq!(pair.distance == 0.0, touching, "{name}");
        let (on_a, on_b) = (
            &triangles_a[pair.triangles.triangle_a as usize],
            &triangles_b[pair.triangles.triangle_b as usize],
        );
        assert!(point_triangle(pair.point_a, on_a) <= slack, "{name}: {pair:?}");
        assert!(point_triangle(pair.point_b, on_b) <= slack, "{name}: {pair:?}");
        assert!(
            (pair.point_a.distance(pair.point_b) - pair.distance).abs() <= slack,
            "{name}: {pair:?}"
        );
        if touching {
            assert!(touch(on_a, on_b), "{name}: {pair:?}");
        } else {
            assert_eq!(*first.get_or_insert(pair), pair, "{name}: another tree");
            assert_eq!(closest(pair.distance), Some(pair), "{name}");
            assert_eq!(closest(pair.distance * (1.0 - 1e-9)), None, "{name}");
        }
        let bodies = (Body::new(&mut pose_a, &place_a), Body::new(&mut pose_b, &place_b));
        let error = query.closest(bodies.0, bodies.1, f64::NAN).unwrap_err().to_string();
        assert_eq!(error, "max_distance is NaN, it must be 0 or more");
    }
    touching
}

#[test]
fn distances_agree_with_brute_force() {
    let blob = |world_from_model| {
        Case::new(
            "blob",
            random::random_blob(5, 1, 3, 0.3),
            vec![0.4, -0.7, 1.2],
            world_from_model,
        )
    };
    let near = blob(Affine3A::IDENTITY);
    let (mut apart, mut touching) = (0, 0);
    for (name, world_from_model) in bodies::odd_places() {
        for shift in [0.0, 2.2, 40.0] {
            let moved = Affine3A::from_translation(Vec3::new(shift, 0.3 * shift, 0.0)) * world_from_model;
            let mut other = blob(moved);
            other.name = format!("blob {name} {shift} away");
            if agrees(&near, &other) {
                touching += 1;
            } else {
                apart += 1;
            }
            if shift > 0.0 {
                agrees(&other, &other.clone());
                let mut both = blob(world_from_model);
                both.name = format!("blob {name}");
                agrees(&both, &other);
            }
        }
    }
    assert!(apart > 10 && touching > 3, "{apart} apart, {touching} touching");
}

#[test]
fn degenerate_bodies_have_distances_too() {
    let far = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.5), Vec3::new(3.5, 0.5, 0.0));
    let meshes = [
        degenerate::slivers(1, 30),
        degenerate::zero_area(2, 30),
        degenerate::coplanar_sheets(3, 2),
        degenerate::all_equal(4),
    ];
    for a in &meshes {
        for b in &meshes {
            for world_from_model in [Affine3A::IDENTITY, far] {
                let one = Case::new(&a.name, a.clone(), vec![0.5], Affine3A::IDENTITY);
                agrees(&one, &Case::new(&b.name, b.clone(), vec![-0.25], world_from_model));
            }
        }
    }
}

#[test]
fn parallel_sheets_are_as_far_apart_as_they_are() {
    let sheet = degenerate::coplanar_sheets(3, 2);
    let at = |height| Affine3A::from_translation(Vec3::new(0.1, 0.0, height));
    let below = Case::new("below", sheet.clone(), vec![0.0], at(0.0));
    for height in [1e-3, 0.75] {
        assert!(!agrees(
            &below,
            &Case::new("above", sheet.clone(), vec![0.0], at(height))
        ));
    }
}
