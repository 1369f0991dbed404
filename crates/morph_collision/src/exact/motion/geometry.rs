//! Where and how features touch, in `f64`.

use glam::DVec3;

use super::features::{FeaturePair, Kind};
use super::filter::vectors;
use super::moving::{MovingPoint, TimeOfImpact};
use crate::exact::closest::{closest_on_triangle, closest_parameters};

/// Where and how two features touch, in the world. The first one is the vertex, or the first edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ImpactGeometry {
    pub(crate) point: DVec3,
    /// The unit vector from the second feature to the first.
    pub(crate) normal: DVec3,
    /// The velocity of the first feature relative to the second, at the point, per motion.
    pub(crate) velocity: DVec3,
    /// The weights of the corners of both features at the point.
    pub(crate) barycentrics: [[f64; 3]; 2],
}

/// If the sine of the angle between two edges is below this, they span no plane: the direction of its normal would be rounding error.
const PARALLEL: f64 = 1e-12;
/// Smaller shares of a speed are rounding error.
const STILL: f64 = 1e-9;

/// The geometry of a contact, at the middle of its time.
///
/// `outward` is a direction out of the body of the second feature, or into that of the first. It decides if the motion does not say on
/// which side the first feature is: at the start, and if nothing moves along the normal.
pub(crate) fn impact_geometry(features: &FeaturePair, time: TimeOfImpact, outward: DVec3) -> ImpactGeometry {
    let middle = time.earliest.midpoint(time.latest);
    let corners = features.corners.map(|corner| corner.at(middle));
    // Differences are taken first, so that a motion that all corners share does not add to the error.
    let spans = vectors(features);
    let [u, v, w] = spans.map(|[start, end]| MovingPoint { start, end }.at(middle));
    let [u_velocity, v_velocity, w_velocity] = spans.map(|[start, end]| end - start);
    let (point, velocity, barycentrics) = match features.kind {
        Kind::VertexFace => {
            let [a, b, c] = closest_on_triangle(w, &[DVec3::ZERO, u, v]).barycentrics;
            let velocity = w_velocity - u_velocity * b - v_velocity * c;
            (corners[0], velocity, [[1.0, 0.0, 0.0], [a, b, c]])
        }
        Kind::EdgeEdge => {
            let [s, r] = closest_parameters([DVec3::ZERO, u], [w, w + v]);
            let (on_a, on_b) = (corners[0] + u * s, corners[2] + v * r);
            let velocity = u_velocity * s - v_velocity * r - w_velocity;
            (on_a.midpoint(on_b), velocity, [s, r].map(|s| [1.0 - s, s, 0.0]))
        }
    };
    let sides = if time.latest > 0.0 {
        [-velocity, outward]
    } else {
        [outward, -velocity]
    };
    ImpactGeometry {
        point,
        normal: match plane_normal(u, v) {
            Some(normal) => facing(normal, sides),
            None => across(longer(u, v), sides),
        },
        velocity,
        barycentrics,
    }
}

/// The unit normal of the plane that two vectors span.
fn plane_normal(u: DVec3, v: DVec3) -> Option<DVec3> {
    let (u, v) = (u.normalize_or_zero(), v.normalize_or_zero());
    let n = u.cross(v);
    (n.length() > PARALLEL).then(|| n.normalize())
}

fn longer(u: DVec3, v: DVec3) -> DVec3 {
    if u.length_squared() < v.length_squared() { v } else { u }
}

/// The normal, turned towards the first of these directions that is not across it.
fn facing(normal: DVec3, directions: [DVec3; 2]) -> DVec3 {
    let along = |direction: DVec3| normal.dot(direction.normalize_or_zero());
    let side = directions.into_iter().map(along).find(|along| along.abs() > STILL);
    if side.is_some_and(|along| along < 0.0) {
        -normal
    } else {
        normal
    }
}

/// The unit vector across an edge that is nearest to the first of these directions that is not along it. If both are, that direction.
fn across(edge: DVec3, directions: [DVec3; 2]) -> DVec3 {
    let (edge, directions) = (edge.normalize_or_zero(), directions.map(DVec3::normalize_or_zero));
    let rest = |direction: DVec3| direction - edge * direction.dot(edge);
    let rests = directions.map(rest).into_iter().filter(|rest| rest.length() > STILL);
    let mut found = rests.map(DVec3::normalize).chain(directions);
    found.find(|direction| *direction != DVec3::ZERO).unwrap_or_default()
}
