//! Manifolds of two bodies.

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{BuildOptions, ContactQuery, Manifold, PairQuery, TrianglePair, triangle_contact};
use morph_collision_models::generated::{dolphin, random, rigid};
use morph_collision_testkit::oracle;

use crate::bodies::{Placed, assorted, at};
use crate::triangles::distance;

fn manifold(a: &mut Placed, b: &mut Placed) -> Option<Manifold> {
    ContactQuery::new().manifold(a.body(), b.body())
}

/// A bar whose end reaches 0.25 into a big box, from the left.
fn bar_in_wall(mirrored: bool) -> (Placed, Placed) {
    let bar = rigid::box_mesh(Vec3::new(1.0, 0.5, 0.5));
    let wall = rigid::box_mesh(Vec3::splat(4.0));
    let flip = if mirrored { Vec3::new(-1.0, 1.0, 1.0) } else { Vec3::ONE };
    let place = at(-4.75, 0.0, 0.0) * Affine3A::from_scale(flip);
    (
        Placed::rigid(&bar, place),
        Placed::rigid(&wall, Affine3A::from_scale(flip)),
    )
}

#[test]
fn a_bar_leaves_a_wall_the_way_it_came_by_its_depth() {
    for mirrored in [false, true] {
        let (mut bar, mut wall) = bar_in_wall(mirrored);
        let manifold = manifold(&mut bar, &mut wall).unwrap();
        assert!(manifold.normal.distance(DVec3::NEG_X) < 1e-12, "{}", manifold.normal);
        assert!((manifold.depth - 0.25).abs() < 1e-12, "{}", manifold.depth);
        // The corners of the bar's cross-section.
        assert_eq!(manifold.points().len(), 4);
        for contact in manifold.points() {
            let p = contact.point;
            assert!((p.x + 4.0).abs() < 1e-12 && p.y.abs() == 0.5 && p.z.abs() == 0.5, "{p}");
        }
    }
}

#[test]
fn two_crossed_edges_are_parted_by_what_they_overlap() {
    // Two square bars, rotated onto an edge: one along x with an edge down, one along z with an edge up.
    let above = Affine3A::from_translation(Vec3::Y * 1.3) * Affine3A::from_rotation_x(std::f32::consts::FRAC_PI_4);
    let mut a = Placed::rigid(&rigid::box_mesh(Vec3::new(2.0, 0.5, 0.5)), above);
    let below = Affine3A::from_rotation_z(std::f32::consts::FRAC_PI_4);
    let mut b = Placed::rigid(&rigid::box_mesh(Vec3::new(0.5, 0.5, 2.0)), below);
    let heights = |placed: &Placed| placed.triangles.iter().flatten().map(|p| p.y).collect::<Vec<_>>();
    let low = heights(&a).into_iter().fold(f64::INFINITY, f64::min);
    let high = heights(&b).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let found = manifold(&mut a, &mut b).unwrap();
    assert!(found.normal.distance(DVec3::Y) < 1e-6, "{}", found.normal);
    assert!(
        (found.depth - (high - low)).abs() < 1e-6,
        "{} instead of {}",
        found.depth,
        high - low
    );
}

#[test]
fn separate_bodies_have_no_manifold() {
    let mesh = rigid::box_mesh(Vec3::ONE);
    let (mut a, mut b) = (
        Placed::rigid(&mesh, at(0.0, 0.0, 0.0)),
        Placed::rigid(&mesh, at(3.0, 0.0, 0.0)),
    );
    assert!(manifold(&mut a, &mut b).is_none());
}

/// Pairs of finely tessellated bodies that overlap deeply.
fn deep_pairs() -> Vec<(Placed, Placed)> {
    let options = BuildOptions::default();
    let blob = random::random_blob(5, 3, 2, 0.3);
    let turn = Quat::from_rotation_y(0.8) * Quat::from_rotation_x(0.3);
    let mut pairs = Vec::new();
    for (step, weights) in [([1.2, 0.3, 0.1], [0.2, 0.1]), ([0.5, -0.4, 0.6], [-0.3, 1.4])] {
        let place = Affine3A::from_rotation_translation(turn, Vec3::from_array(step));
        pairs.push((
            Placed::new("blob a", &blob, &weights, Affine3A::IDENTITY, &options),
            Placed::new("blob b", &blob, &[0.1, 0.4], place, &options),
        ));
    }
    let place = Affine3A::from_rotation_translation(Quat::from_rotation_x(0.6), Vec3::new(0.2, 0.12, 0.05));
    pairs.push((
        Placed::new("dolphin a", &dolphin(0), &[0.2, 0.6], Affine3A::IDENTITY, &options),
        Placed::new("dolphin b", &dolphin(0), &[0.0, 0.1], place, &options),
    ));
    pairs
}

#[test]
fn moving_by_the_depth_separates_the_pairs_and_less_does_not() {
    for (mut a, mut b) in deep_pairs() {
        let manifold = manifold(&mut a, &mut b).unwrap();
        let mut pairs = Vec::new();
        PairQuery::new().all(a.body(), b.body(), &mut pairs);
        let intersecting_after = |way: f64| {
            let moved = |triangle: u32| a.triangles[triangle as usize].map(|corner| corner + manifold.normal * way);
            let of_b = |triangle: u32| &b.triangles[triangle as usize];
            let still =
                |pair: &&TrianglePair| oracle::triangles_intersect(&moved(pair.triangle_a), of_b(pair.triangle_b));
            pairs.iter().filter(still).count()
        };
        assert_eq!(intersecting_after(0.0), pairs.len());
        assert!(
            intersecting_after(manifold.depth - 1e-9) > 0,
            "{}: {manifold:?}",
            a.name
        );
        assert_eq!(intersecting_after(manifold.depth + 1e-9), 0, "{}: {manifold:?}", a.name);
    }
}

#[test]
fn exchanging_the_bodies_turns_the_normal_and_nothing_else() {
    let mut bodies = assorted();
    let mut count = 0;
    for i in 0..bodies.len() {
        for j in 0..i {
            let (left, right) = bodies.split_at_mut(i);
            let (a, b) = (&mut left[j], &mut right[0]);
            let name = format!("{} and {}", a.name, b.name);
            let [there, back] = [manifold(a, b), manifold(b, a)];
            assert_eq!(there.is_some(), back.is_some(), "{name}");
            let (Some(there), Some(back)) = (there, back) else {
                continue;
            };
            count += 1;
            assert_eq!(there.normal, -back.normal, "{name}");
            assert_eq!(there.depth, back.depth, "{name}");
            assert_eq!(there.points().len(), back.points().len(), "{name}");
            for (p, q) in there.points().iter().zip(back.points()) {
                assert_eq!((p.point, p.depth), (q.point, q.depth), "{name}");
            }
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn points_lie_on_both_triangles_and_the_deepest_is_first() {
    for (mut a, mut b) in deep_pairs() {
        let manifold = manifold(&mut a, &mut b).unwrap();
        assert!((manifold.normal.length() - 1.0).abs() < 1e-12);
        assert_eq!(manifold.points()[0].depth, manifold.depth);
        for contact in manifold.points() {
            let of_a = &a.triangles[contact.triangles.triangle_a as usize];
            let of_b = &b.triangles[contact.triangles.triangle_b as usize];
            assert!(oracle::triangles_intersect(of_a, of_b));
            assert!(distance(contact.point, of_a).max(distance(contact.point, of_b)) < 1e-12);
            assert!(contact.depth <= manifold.depth);
        }
        let points = manifold.points();
        for (i, p) in points.iter().enumerate() {
            assert!(points[..i].iter().all(|q| q.point != p.point));
        }
    }
}

#[test]
fn every_intersecting_pair_has_its_contact() {
    for (mut a, mut b) in deep_pairs() {
        let mut pairs = Vec::new();
        PairQuery::new().all(a.body(), b.body(), &mut pairs);
        for pair in &pairs {
            let (of_a, of_b) = (pair.triangle_a as usize, pair.triangle_b as usize);
            assert!(triangle_contact(&a.triangles[of_a], &b.triangles[of_b]).is_some());
        }
        let manifold = manifold(&mut a, &mut b).unwrap();
        assert_eq!(manifold.pair_count, pairs.len());
        assert!(manifold.points().iter().all(|point| pairs.contains(&point.triangles)));
    }
}

#[test]
fn pairs_found_earlier_give_the_same_manifold_in_any_order() {
    let mut query = ContactQuery::new();
    for (mut a, mut b) in deep_pairs() {
        let mut pairs = Vec::new();
        PairQuery::new().all(a.body(), b.body(), &mut pairs);
        let expected = manifold(&mut a, &mut b);
        assert!(pairs.len() > 20 && expected.is_some());
        for _ in 0..3 {
            assert_eq!(query.manifold_of(a.body(), b.body(), &pairs), expected, "{}", a.name);
            assert_eq!(query.stats().node_tests, 0);
            pairs.reverse();
            pairs.rotate_left(7);
        }
        // These do not exist, or do not intersect.
        let apart = (0..a.triangles.len() as u32)
            .map(|triangle_a| TrianglePair { triangle_a, ..pairs[0] })
            .find(|pair| !pairs.contains(pair));
        let missing = TrianglePair {
            triangle_a: u32::MAX,
            triangle_b: 0,
        };
        pairs.extend(apart.into_iter().chain([missing]));
        assert_eq!(query.manifold_of(a.body(), b.body(), &pairs), expected, "{}", a.name);
        assert_eq!(query.manifold_of(a.body(), b.body(), &[]), None);
    }
}

#[test]
fn a_tip_is_pushed_back_out_of_the_face_it_pierces() {
    // A ball that dips into a plate. The bounds below hold however the plate's faces are split into triangles.
    let ball = random::random_blob(9, 3, 0, 0.0);
    let plate = rigid::box_mesh(Vec3::new(3.0, 0.5, 3.0));
    let mut plate = Placed::rigid(&plate, at(0.0, -0.5, 0.0));
    let mut ball = Placed::rigid(&ball, at(0.2, 0.5, -0.1));
    let lowest = ball
        .triangles
        .iter()
        .flatten()
        .map(|p| p.y)
        .fold(f64::INFINITY, f64::min);
    assert!(lowest < 0.0);
    let found = manifold(&mut ball, &mut plate).unwrap();
    assert!(found.normal.y > 0.9, "{}", found.normal);
    // The deepest pair of triangles cannot be deeper than the ball; it is 0.1405 deep.
    assert!(
        found.depth * found.normal.y > 0.14 && found.depth * found.normal.y <= -lowest + 1e-9,
        "{found:?}"
    );
}
