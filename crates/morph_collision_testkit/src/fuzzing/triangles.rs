use glam::DVec3;

use super::draw::Draw;
use crate::oracle;

/// Two triangles of whole or nearly whole coordinates, all scaled by a power of two. Corners lie on corners, edges and
/// planes, or a few units in the last place beside them. Some coordinates are arbitrary.
///
/// # Panics
/// If the core and the oracle differ, or the order of triangles or corners matters.
pub fn triangles(data: &[u8]) {
    let mut draw = Draw::new(data);
    let scale = 2_f64.powi(match draw.byte() % 8 {
        0 => -240,
        1 => 280,
        2 => i32::from(draw.signed()) % 1023,
        _ => 0,
    });
    let mut corners: Vec<DVec3> = Vec::with_capacity(6);
    for _ in 0..6 {
        let corner = corner(&mut draw, &corners);
        corners.push(corner);
    }
    let corners: Vec<DVec3> = corners.into_iter().map(|corner| corner * scale).collect();
    let a = [corners[0], corners[1], corners[2]];
    let b = [corners[3], corners[4], corners[5]];
    let truth = oracle::triangles_intersect(&a, &b);
    for (a, b) in [
        (a, b),
        (b, a),
        (turned(a), b),
        (a, turned(b)),
        (reversed(a), reversed(b)),
    ] {
        assert_eq!(morph_collision::triangles_intersect(&a, &b), truth, "{a:?} {b:?}");
        let contact = morph_collision::triangle_contact(&a, &b);
        assert_eq!(contact.is_some(), truth, "contact of {a:?} {b:?}");
    }
}

fn turned([p, q, r]: [DVec3; 3]) -> [DVec3; 3] {
    [q, r, p]
}

fn reversed([p, q, r]: [DVec3; 3]) -> [DVec3; 3] {
    [r, q, p]
}

/// A point on a grid, or a rounded combination of earlier corners.
fn corner(draw: &mut Draw<'_>, before: &[DVec3]) -> DVec3 {
    let pick = |draw: &mut Draw<'_>| before.get(draw.among(0, before.len().max(1) - 1)).copied();
    let kind = draw.byte() % 8;
    let corner = match (kind, pick(draw), pick(draw), pick(draw)) {
        (0, Some(p), ..) => p,
        (1, Some(p), Some(q), _) => p.lerp(q, f64::from(draw.signed()) / 16384.0),
        (2, Some(p), Some(q), Some(r)) => {
            let [s, t] = [draw.signed(), draw.signed()].map(|x| f64::from(x) / 16384.0);
            p + (q - p) * s + (r - p) * t
        }
        _ => DVec3::from_array(std::array::from_fn(|_| coordinate(draw))),
    };
    if kind & 1 == 1 {
        return DVec3::from_array(corner.to_array().map(|x| nudged(x, i64::from(draw.whole()))));
    }
    corner
}

fn coordinate(draw: &mut Draw<'_>) -> f64 {
    match draw.byte() % 8 {
        0..4 => f64::from(draw.whole()),
        4 | 5 => f64::from(draw.whole()) / 3.0,
        6 if draw.byte().is_multiple_of(8) => f64::from_bits(draw.bits64()),
        _ => f64::from(draw.signed()) * 2_f64.powi(draw.whole() * 4),
    }
}

/// A number moved some units in the last place away from zero or towards it.
fn nudged(value: f64, by: i64) -> f64 {
    f64::from_bits(value.to_bits().wrapping_add_signed(by))
}
