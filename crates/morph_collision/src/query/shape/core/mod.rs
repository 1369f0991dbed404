//! Convex cores: a shape is everything within a radius of its core.

mod convex;
mod cuboid;
mod deepest;
mod frame;
mod frustum;
mod placed_hull;
mod segment;
mod separation;
mod turn;

use glam::{DMat3, DQuat, DVec3};

use super::closest::Closest;
use crate::exact::{Segment, Triangle, closest_on_segment};
use convex::Convex;
pub(super) use cuboid::Cuboid;
pub(super) use frame::{Frame, LARGEST};
pub(super) use frustum::Frustum;
pub(super) use placed_hull::PlacedHull;
pub(super) use separation::BLIND;
pub(super) use turn::turn;

/// A closed convex set in world space.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Core {
    /// The core of a ball (a point, twice) or of a capsule.
    Segment(Segment),
    Cuboid(Cuboid),
    Frustum(Frustum),
    Hull(PlacedHull),
}

impl Core {
    /// The signed distance of a point.
    pub(super) fn signed_distance(&self, point: DVec3) -> f64 {
        match self {
            Self::Segment(axis) => point.distance(closest_on_segment(point, *axis)),
            Self::Cuboid(cuboid) => cuboid.signed_distance(point),
            Self::Frustum(frustum) => frustum.signed_distance(point),
            Self::Hull(hull) => hull.signed_distance(point),
        }
    }

    /// The gradient of the signed distance at a point, a unit vector. Arbitrary if the gradient does not exist.
    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Segment(axis) => (point - closest_on_segment(point, *axis)).normalize_or(DVec3::X),
            Self::Cuboid(cuboid) => cuboid.outward(point),
            Self::Frustum(frustum) => frustum.outward(point),
            Self::Hull(hull) => hull.outward(point),
        }
    }

    /// The point of a triangle with the smallest signed distance.
    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        match self {
            Self::Segment(axis) => segment::closest_to_segment(*axis, triangle),
            Self::Cuboid(cuboid) => cuboid.closest(triangle),
            Self::Frustum(frustum) => convex::closest_of_triangle(frustum, frustum.reach(), triangle),
            Self::Hull(hull) => convex::closest_of_triangle(hull, hull.reach(), triangle),
        }
    }

    /// The point of another core with the smallest signed distance from this one.
    pub(super) fn closest_of_core(&self, other: &Self) -> Closest {
        match (self, other) {
            (_, Self::Segment([p, q])) => self.closest(&[*p, *q, *q]),
            (Self::Segment(_), _) => other.closest_of_core(self).seen_from_the_other(),
            (Self::Cuboid(_), Self::Cuboid(cuboid)) => self.closest_of_cuboid(cuboid),
            _ => {
                let around = [self.around(), other.around()];
                convex::closest_of_convex(self, other, around, self.reach() + other.reach())
            }
        }
    }

    fn closest_of_cuboid(&self, cuboid: &Cuboid) -> Closest {
        let on_faces = cuboid.faces().map(|face| self.closest(&face));
        let nearest = on_faces.min_by(|x, y| x.distance.total_cmp(&y.distance));
        // This core may be wholly inside the other.
        let inside = self.center();
        let depth = cuboid.signed_distance(inside);
        let is_inside = nearest.as_ref().is_none_or(|nearest| nearest.distance > 0.0) && depth <= 0.0;
        match nearest {
            Some(nearest) if !is_inside => nearest,
            _ => Closest {
                point: inside,
                normal: -cuboid.outward(inside),
                distance: depth,
            },
        }
    }

    /// Whether there is no formula for distances, so that small gaps are not seen (see [`BLIND`]).
    pub(super) fn is_known_by_support(&self) -> bool {
        matches!(self, Self::Frustum(_) | Self::Hull(_))
    }

    /// A point inside.
    pub(super) fn center(&self) -> DVec3 {
        match self {
            Self::Segment([p, q]) => p.midpoint(*q),
            Self::Cuboid(cuboid) => cuboid.center(),
            Self::Frustum(frustum) => frustum.frame.center,
            Self::Hull(hull) => hull.middle(),
        }
    }

    /// An upper bound for the coordinates.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Segment([p, q]) => p.abs().max(q.abs()).max_element(),
            Self::Cuboid(cuboid) => cuboid.reach(),
            Self::Frustum(frustum) => frustum.reach(),
            Self::Hull(hull) => hull.reach(),
        }
    }

    pub(super) fn moved_by(&self, offset: DVec3) -> Self {
        let mut moved = self.clone();
        match &mut moved {
            Self::Segment(axis) => axis.iter_mut().for_each(|end| *end += offset),
            Self::Cuboid(cuboid) => *cuboid = cuboid.moved_by(offset),
            Self::Frustum(frustum) => frustum.frame.center += offset,
            Self::Hull(hull) => hull.frame.center += offset,
        }
        moved
    }

    /// A ball around it.
    pub(super) fn around(&self) -> (DVec3, f64) {
        match self {
            Self::Segment([p, q]) => (p.midpoint(*q), p.distance(*q) * 0.5),
            Self::Cuboid(cuboid) => cuboid.around(),
            Self::Frustum(frustum) => frustum.around(),
            Self::Hull(hull) => hull.around(),
        }
    }

    /// Turned around a point.
    pub(super) fn turned(&self, turn: &DMat3, pivot: DVec3) -> Self {
        let place = |point: DVec3| pivot + *turn * (point - pivot);
        let mut turned = self.clone();
        match &mut turned {
            Self::Segment(axis) => axis.iter_mut().for_each(|end| *end = place(*end)),
            Self::Cuboid(Cuboid { frame, .. })
            | Self::Frustum(Frustum { frame, .. })
            | Self::Hull(PlacedHull { frame, .. }) => {
                *frame = Frame {
                    rotation: *turn * frame.rotation,
                    center: place(frame.center),
                };
            }
        }
        turned
    }

    /// The shortest rotation from a core of the same kind, as the axis times the angle.
    pub(super) fn rotation_from(&self, before: &Self) -> Option<DVec3> {
        let shortest = match (before, self) {
            (Self::Segment([p, q]), Self::Segment([p_now, q_now])) => {
                let (was, is) = ((q - p).normalize_or_zero(), (q_now - p_now).normalize_or_zero());
                if was == is || was == DVec3::ZERO || is == DVec3::ZERO {
                    return Some(DVec3::ZERO);
                }
                turn::arc(was, is)
            }
            (Self::Cuboid(Cuboid { frame: was, .. }), Self::Cuboid(Cuboid { frame: is, .. }))
            | (Self::Frustum(Frustum { frame: was, .. }), Self::Frustum(Frustum { frame: is, .. }))
            | (Self::Hull(PlacedHull { frame: was, .. }), Self::Hull(PlacedHull { frame: is, .. })) => {
                if was.rotation == is.rotation {
                    return Some(DVec3::ZERO);
                }
                let rotation = DQuat::from_mat3(&(is.rotation * was.rotation.transpose()));
                turn::scaled_axis(rotation.normalize())
            }
            _ => return None,
        };
        Some(shortest)
    }

    /// A bound on how far any point has moved, up to rounding of the lengths. Infinite for another kind or size of core.
    pub(super) fn displacement_from(&self, before: &Self) -> f64 {
        match (before, self) {
            (Self::Segment([p, q]), Self::Segment([p_now, q_now])) => p.distance(*p_now).max(q.distance(*q_now)),
            (Self::Cuboid(before), Self::Cuboid(now)) => now.displacement_from(before),
            (Self::Frustum(before), Self::Frustum(now)) => now.displacement_from(before),
            (Self::Hull(before), Self::Hull(now)) => now.displacement_from(before),
            _ => f64::INFINITY,
        }
    }

    /// The point farthest along a direction.
    pub(super) fn support_point(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Segment([p, q]) => {
                if direction.dot(*p) >= direction.dot(*q) {
                    *p
                } else {
                    *q
                }
            }
            Self::Cuboid(cuboid) => cuboid.support_point(direction),
            Self::Frustum(frustum) => frustum.support_point(direction),
            Self::Hull(hull) => hull.support_point(direction),
        }
    }

    /// The largest `direction . x`.
    pub(super) fn support(&self, direction: DVec3) -> f64 {
        match self {
            Self::Segment([p, q]) => direction.dot(*p).max(direction.dot(*q)),
            Self::Cuboid(cuboid) => cuboid.support(direction),
            _ => direction.dot(self.support_point(direction)),
        }
    }
}

impl Convex for Core {
    fn support_point(&self, direction: DVec3) -> DVec3 {
        self.support_point(direction)
    }

    fn depth(&self, point: DVec3) -> (f64, DVec3) {
        match self {
            Self::Segment(_) | Self::Cuboid(_) => (self.signed_distance(point), self.outward(point)),
            Self::Frustum(frustum) => frustum.depth(point),
            Self::Hull(hull) => hull.depth(point),
        }
    }
}
