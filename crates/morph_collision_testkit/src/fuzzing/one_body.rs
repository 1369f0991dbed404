//! Checks rays, points and distances against every triangle.

use glam::DVec3;
use morph_collision::{Body, DistanceQuery, Ray, RayHit, RayQuery, ShapeQuery};

use super::draw::Draw;
use crate::oracle;

type Corners = [DVec3; 3];

/// The range of sizes for which the fourth power of a length neither overflows nor underflows.
const SIZES: std::ops::Range<f64> = 1e-60..1e40;
/// How much too long a distance may be, in units of the largest coordinate.
const DISTANCE_ERROR: f64 = 1e-9;

/// The largest coordinate.
fn reach<'a>(triangles: impl IntoIterator<Item = &'a Corners>) -> f64 {
    let corners = triangles.into_iter().flatten();
    corners.map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// A corner of a triangle, or a point about as far from it as triangles are from the origin.
fn place(draw: &mut Draw<'_>, triangles: &[Corners], reach: f64) -> DVec3 {
    let triangle = triangles[draw.among(0, triangles.len() - 1)];
    let off = f64::from(draw.signed()) / 16384.0;
    match draw.byte() % 4 {
        0 => triangle[draw.among(0, 2)],
        1 => triangle[0].lerp(triangle[1], off.abs().min(1.0)),
        2 => (triangle[0] + triangle[1] + triangle[2]) / 3.0,
        _ => triangle[0] + DVec3::from_array([(); 3].map(|()| f64::from(draw.signed()) / 16384.0)) * reach,
    }
}

/// Casts a few rays and checks that they hit exactly the triangles that the oracle says. To the oracle, a ray is a triangle with
/// two equal corners.
pub(super) fn assert_rays(draw: &mut Draw<'_>, mut body: Body<'_>, triangles: &[Corners]) {
    let reach = reach(triangles);
    if !SIZES.contains(&reach) {
        return;
    }
    // A grid that holds both ends of a ray and its direction without rounding.
    let grid = 2_f64.powi(reach.log2().ceil() as i32 - 44);
    let snapped = |p: DVec3| (p / grid).round() * grid;
    for _ in 0..3 {
        let [origin, through] = [(); 2].map(|()| snapped(place(draw, triangles, reach)));
        let direction = through - origin;
        let Ok(ray) = Ray::new(origin, direction, 2.0) else {
            continue;
        };
        let end = origin + direction * 2.0;
        let meets = |t: &u32| oracle::triangles_intersect(&[origin, end, end], &triangles[*t as usize]);
        let truth: Vec<u32> = (0..triangles.len() as u32).filter(meets).collect();
        let mut query = RayQuery::new();
        let mut hits = Vec::new();
        query.all(body.reborrow(), &ray, &mut hits);
        let mut found: Vec<u32> = hits.iter().map(|hit| hit.triangle).collect();
        found.sort_unstable();
        assert_eq!(found, truth, "the ray from {origin} to {end}");
        // Zeros of either sign are the same place.
        let order = |a: &&RayHit, b: &&RayHit| (a.t, a.triangle).partial_cmp(&(b.t, b.triangle));
        let nearest = hits.iter().min_by(|a, b| order(a, b).expect("numbers")).copied();
        assert_eq!(query.closest(body.reborrow(), &ray), nearest, "from {origin} to {end}");
        assert_eq!(
            query.any(body.reborrow(), &ray),
            !truth.is_empty(),
            "from {origin} to {end}"
        );
    }
}

/// Queries the closest points of two bodies. They must lie on the bodies, and brute force must find none that are closer.
pub(super) fn assert_closest_pair([a, b]: [Body<'_>; 2], triangles: [&[Corners]; 2], touching: bool) {
    let reach = reach(triangles.into_iter().flatten());
    if !SIZES.contains(&reach) {
        return;
    }
    let pair = DistanceQuery::new()
        .closest(a, b, f64::INFINITY)
        .expect("any distance will do");
    let pair = pair.expect("every distance is finite");
    assert_eq!(pair.distance == 0.0, touching, "{pair:?}");
    let slack = reach * DISTANCE_ERROR;
    let [on_a, on_b] = [
        &triangles[0][pair.triangles.triangle_a as usize],
        &triangles[1][pair.triangles.triangle_b as usize],
    ];
    assert!(oracle::point_distance(pair.point_a, on_a) <= slack, "{pair:?}");
    assert!(oracle::point_distance(pair.point_b, on_b) <= slack, "{pair:?}");
    let between = pair.point_a.distance(pair.point_b);
    assert!((between - pair.distance).abs() <= slack, "{pair:?}");
    for s in triangles[0] {
        for t in triangles[1] {
            let distance = oracle::triangle_distance(s, t);
            assert!(
                pair.distance <= distance + slack,
                "{pair:?}, not {distance} between {s:?} and {t:?}"
            );
        }
    }
}

/// Queries the closest points to a few points, with the same checks as [`assert_closest_pair`].
pub(super) fn assert_closest_point(draw: &mut Draw<'_>, mut body: Body<'_>, triangles: &[Corners]) {
    let reach = reach(triangles);
    if !SIZES.contains(&reach) {
        return;
    }
    let slack = reach * DISTANCE_ERROR;
    for _ in 0..2 {
        let point = place(draw, triangles, reach);
        let found = ShapeQuery::new().closest_point(body.reborrow(), point, f64::INFINITY);
        let found = found.expect("the point is finite").expect("every distance is finite");
        assert!(
            (found.point.distance(point) - found.distance).abs() <= slack,
            "{found:?}"
        );
        assert!(
            oracle::point_distance(found.point, &triangles[found.triangle as usize]) <= slack,
            "{found:?}"
        );
        let least = triangles.iter().map(|triangle| oracle::point_distance(point, triangle));
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(found.distance <= least + slack, "{found:?} from {point}, not {least}");
    }
}
