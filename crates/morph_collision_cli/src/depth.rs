//! How deep two triangles are in each other.

use morph_collision::{Triangle, triangle_contact};

/// How far the first triangle can move along the contact's normal before it leaves the second. 0 if they do not touch.
pub(crate) fn parting_distance(a: &Triangle, b: &Triangle) -> f64 {
    let Some(contact) = triangle_contact(a, b) else {
        return 0.0;
    };
    let along = |triangle: &Triangle| triangle.map(|corner| corner.dot(contact.normal));
    let end = along(b).into_iter().fold(f64::NEG_INFINITY, f64::max);
    let start = along(a).into_iter().fold(f64::INFINITY, f64::min);
    (end - start).max(0.0)
}
