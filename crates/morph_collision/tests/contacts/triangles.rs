//! Contacts of two triangles.

use glam::DVec3;
use morph_collision::{Triangle, triangle_contact, triangles_intersect};
use morph_collision_testkit::oracle::Dyadic;
use proptest::prelude::*;

/// The distance of a point from a triangle: from its plane if the point is above the triangle, otherwise from the nearest edge. The
/// decision and the distance from the plane use exact arithmetic, so they are also right for slivers.
pub(crate) fn distance(point: DVec3, triangle: &Triangle) -> f64 {
    let [a, b, c] = *triangle;
    let to_edge = |p: DVec3, q: DVec3| {
        let length = p.distance(q);
        let t = if length > 0.0 {
            (point - p).dot((q - p) / length) / length
        } else {
            0.0
        };
        point.distance(p + (q - p) * t.clamp(0.0, 1.0))
    };
    let nearest = to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a));
    let normal = cross(&between(a, b), &between(a, c));
    let turns = |p: DVec3, q: DVec3| dot(&normal, &cross(&between(p, q), &between(p, point)));
    let squared = dot(&normal, &normal);
    let flat = squared.to_f64() == 0.0;
    if flat
        || [(a, b), (b, c), (c, a)]
            .into_iter()
            .any(|(p, q)| turns(p, q).is_negative())
    {
        return nearest;
    }
    let height = dot(&normal, &between(a, point));
    (height.clone() * height).ratio(&squared).sqrt().min(nearest)
}

type Exact = [Dyadic; 3];

fn between(p: DVec3, q: DVec3) -> Exact {
    std::array::from_fn(|axis| Dyadic::from(q[axis]) - Dyadic::from(p[axis]))
}

fn dot(u: &Exact, v: &Exact) -> Dyadic {
    let product = |axis: usize| u[axis].clone() * v[axis].clone();
    product(0) + product(1) + product(2)
}

fn cross(u: &Exact, v: &Exact) -> Exact {
    std::array::from_fn(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        u[i].clone() * v[j].clone() - u[j].clone() * v[i].clone()
    })
}

fn size(a: &Triangle, b: &Triangle) -> f64 {
    let all = || a.iter().chain(b);
    all().flat_map(|p| all().map(|q| p.distance(*q))).fold(0.0, f64::max)
}

/// The length of the intersection of two triangles with area: one triangle is clipped by the other's plane and sides.
fn clipped_length(a: &Triangle, b: &Triangle) -> Option<f64> {
    let normal = (b[1] - b[0]).cross(b[2] - b[0]).normalize();
    let mut polygon = a.to_vec();
    let mut planes = vec![(b[0], normal), (b[0], -normal)];
    for (p, q) in [(b[0], b[1]), (b[1], b[2]), (b[2], b[0])] {
        planes.push((p, (q - p).cross(normal).normalize()));
    }
    for (origin, outward) in planes {
        let height = |p: DVec3| {
            let height = (p - origin).dot(outward);
            if height.abs() < 1e-12 { 0.0 } else { height }
        };
        let mut kept = Vec::new();
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            let (at_p, at_q) = (height(p), height(q));
            if at_p <= 0.0 {
                kept.push(p);
            }
            if at_p * at_q < 0.0 {
                kept.push(p + (q - p) * (at_p / (at_p - at_q)));
            }
        }
        polygon = kept;
    }
    let lengths = polygon.iter().flat_map(|p| polygon.iter().map(|q| p.distance(*q)));
    lengths.reduce(f64::max)
}

/// Corners on a coarse grid, so that coplanar, touching and degenerate pairs are common.
fn grid_triangle() -> impl Strategy<Value = Triangle> {
    prop::array::uniform3(prop::array::uniform3(-2_i8..3).prop_map(|c| DVec3::from_array(c.map(f64::from))))
}

/// Two nearly coplanar triangles; some are tilted by as little as `f64` can represent.
fn nearly_coplanar() -> impl Strategy<Value = (Triangle, Triangle)> {
    let triangle = || prop::array::uniform3(prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array));
    (triangle(), triangle(), prop::array::uniform3(-1.0..1.0_f64), 1..60_i32).prop_map(|(a, b, heights, bits)| {
        let normal = (a[1] - a[0]).cross(a[2] - a[0]).normalize_or(DVec3::Z);
        let tilt = 0.5_f64.powi(bits);
        let flat = |p: DVec3| p - normal * normal.dot(p - a[0]);
        let mut b = b.map(flat);
        for (corner, height) in b.iter_mut().zip(heights) {
            *corner += normal * (height * tilt);
        }
        (a, b)
    })
}

fn lies_on_both(a: &Triangle, b: &Triangle) -> Result<(), TestCaseError> {
    let contact = triangle_contact(a, b);
    prop_assert_eq!(contact.is_some(), triangles_intersect(a, b));
    let Some(contact) = contact else { return Ok(()) };
    for end in contact.segment {
        for triangle in [a, b] {
            let off = distance(end, triangle);
            prop_assert!(off <= 1e-12 * size(a, b), "{} is {} off {:?}", end, off, triangle);
        }
    }
    let length = contact.normal.length();
    prop_assert!(length == 0.0 || (length - 1.0).abs() < 1e-14);
    let exchanged = triangle_contact(b, a).unwrap();
    prop_assert_eq!(exchanged.segment, contact.segment);
    prop_assert_eq!(exchanged.normal, -contact.normal);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn segments_lie_on_both_triangles_on_a_grid(a in grid_triangle(), b in grid_triangle()) {
        lies_on_both(&a, &b)?;
    }

    #[test]
    fn segments_lie_on_both_triangles_that_are_nearly_coplanar((a, b) in nearly_coplanar()) {
        lies_on_both(&a, &b)?;
        let far = DVec3::new(1e6, -3e5, 2e6);
        let (a, b) = (a.map(|p| p + far), b.map(|p| p + far));
        let contact = triangle_contact(&a, &b);
        prop_assert_eq!(contact.is_some(), triangles_intersect(&a, &b));
        for end in contact.iter().flat_map(|contact| contact.segment) {
            // A few units in the last place of the coordinates.
            prop_assert!(distance(end, &a).max(distance(end, &b)) <= 4e-9);
        }
    }

    #[test]
    fn segments_are_as_long_as_what_both_have_in_common(a in grid_triangle(), b in grid_triangle()) {
        let has_area = |t: &Triangle| (t[1] - t[0]).cross(t[2] - t[0]) != DVec3::ZERO;
        if let Some(contact) = triangle_contact(&a, &b).filter(|_| has_area(&a) && has_area(&b)) {
            let expected = clipped_length(&a, &b).unwrap_or(0.0);
            prop_assert!((contact.length() - expected).abs() < 1e-10, "{} instead of {}", contact.length(), expected);
        }
    }
}

#[test]
fn the_segment_of_a_sliver_lies_on_it() {
    // A needle 1e-11 wide, nearly in the plane of the other.
    let a = [
        DVec3::new(0.6447184474778741, -0.8604314716034048, 0.7616577696765111),
        DVec3::new(0.0728806576514003, -0.03622116999678277, 0.694048568644351),
        DVec3::new(0.3893378019740189, -0.35005961410275044, -0.9849006241900528),
    ];
    let b = [
        DVec3::new(-0.20665682246054579, 0.4498800204356024, -0.3425358368899393),
        DVec3::new(-0.3133168628993695, 0.6161618886447859, -0.5065631442517832),
        DVec3::new(0.355503398496639, -0.4265363646562734, 0.5219148814896737),
    ];
    assert!(triangles_intersect(&a, &b));
    lies_on_both(&a, &b).unwrap();
}

#[test]
fn a_touching_tip_is_a_point_and_coplanar_triangles_give_their_longest_diagonal() {
    let floor = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
    let tip = [
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(2.0, 1.0, 3.0),
    ];
    let contact = triangle_contact(&tip, &floor).unwrap();
    assert_eq!(contact.segment, [tip[0]; 2]);
    assert_eq!(contact.point(), tip[0]);

    let within = [
        DVec3::new(0.5, 0.5, 0.0),
        DVec3::new(1.5, 0.5, 0.0),
        DVec3::new(0.5, 2.0, 0.0),
    ];
    let contact = triangle_contact(&within, &floor).unwrap();
    assert_eq!(contact.segment, [within[2], within[1]]);
    assert_eq!(contact.normal, DVec3::ZERO, "both face the same way");
    let turned = [within[1], within[0], within[2]];
    assert_eq!(triangle_contact(&turned, &floor).unwrap().normal, DVec3::Z);
}
