//! One convex shape in world space.

use glam::{DMat3, DQuat, DVec3};

use super::closest::Closest;
use super::core::{BLIND, Core, Cuboid, Frame, Frustum, LARGEST, PlacedHull};
use super::kinds::Shape;
use crate::exact::Triangle;
use crate::input_error::{InputError, check_direction, check_number, check_vector};

/// A convex shape in world space.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Solid {
    /// All points within a radius of a core.
    Round {
        core: Core,
        radius: f64,
    },
    HalfSpace {
        point: DVec3,
        normal: DVec3,
    },
}

impl Solid {
    pub(super) fn new(shape: Shape, rotation: DQuat, translation: DVec3) -> Result<Self, InputError> {
        let frame = Frame::new(rotation, translation)?;
        let frustum = |half_height, radii| Core::Frustum(Frustum::new(half_height, radii, frame));
        let (core, radius) = match shape {
            Shape::Ball { radius } => (Core::Segment([frame.center; 2]), size("radius", radius)?),
            Shape::Capsule { half_length, radius } => {
                let half = frame.rotation * (DVec3::Y * size("half_length", half_length)?);
                let axis = [frame.center - half, frame.center + half];
                (Core::Segment(axis), size("radius", radius)?)
            }
            Shape::Cuboid { half_extents } => {
                let half = sizes("half_extents", half_extents.to_array())?;
                (Core::Cuboid(Cuboid::new(half.into(), frame)), 0.0)
            }
            Shape::RoundCuboid {
                half_extents,
                border_radius,
            } => {
                let half = sizes("half_extents", half_extents.to_array())?;
                let border = size("border_radius", border_radius)?;
                (Core::Cuboid(Cuboid::new(half.into(), frame)), border)
            }
            Shape::Cylinder { half_height, radius } => {
                let half_height = size("half_height", half_height)?;
                (frustum(half_height, [size("radius", radius)?; 2]), 0.0)
            }
            Shape::Cone { half_height, radius } => {
                let half_height = size("half_height", half_height)?;
                (frustum(half_height, [size("radius", radius)?, 0.0]), 0.0)
            }
            Shape::ConicalFrustum {
                half_height,
                bottom_radius,
                top_radius,
            } => {
                let half_height = size("half_height", half_height)?;
                let bottom = size("bottom_radius", bottom_radius)?;
                (frustum(half_height, [bottom, size("top_radius", top_radius)?]), 0.0)
            }
            Shape::ConvexHull(hull) => (Core::Hull(PlacedHull::new(hull, frame)), 0.0),
            Shape::HalfSpace { normal } => {
                let normal = normal.as_dvec3();
                check_vector("normal", normal, LARGEST)?;
                check_direction("normal", normal)?;
                return Ok(Self::HalfSpace {
                    point: frame.center,
                    normal: (frame.rotation * normal.normalize()).normalize(),
                });
            }
        };
        Ok(Self::Round { core, radius })
    }

    pub(super) fn ball(center: DVec3, radius: f64) -> Self {
        Self::Round {
            core: Core::Segment([center; 2]),
            radius,
        }
    }

    pub(super) fn signed_distance(&self, point: DVec3) -> f64 {
        match self {
            Self::Round { core, radius } => core.signed_distance(point) - radius,
            Self::HalfSpace { point: foot, normal } => (point - foot).dot(*normal),
        }
    }

    /// The gradient of the signed distance at a point, a unit vector. Arbitrary if the gradient does not exist.
    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Round { core, .. } => core.outward(point),
            Self::HalfSpace { normal, .. } => *normal,
        }
    }

    /// The largest `direction . x` for a unit vector; may be infinite.
    pub(super) fn support(&self, direction: DVec3) -> f64 {
        match self {
            Self::Round { core, radius } => core.support(direction) + radius,
            Self::HalfSpace { point, normal } if direction == *normal => direction.dot(*point),
            Self::HalfSpace { .. } => f64::INFINITY,
        }
    }

    /// An upper bound for the coordinates involved in a distance to the shape.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Round { core, radius } => core.reach() + radius,
            Self::HalfSpace { point, .. } => point.abs().max_element(),
        }
    }

    /// Distances from something with the given reach are too small by at most this, besides rounding.
    pub(super) fn blind_gap(&self, reach: f64) -> f64 {
        match self {
            Self::Round { core, .. } if core.is_known_by_support() => BLIND * (self.reach() + reach),
            _ => 0.0,
        }
    }

    /// A point inside.
    pub(super) fn center(&self) -> DVec3 {
        match self {
            Self::Round { core, .. } => core.center(),
            Self::HalfSpace { point, .. } => *point,
        }
    }

    pub(super) fn moved_by(&self, offset: DVec3) -> Self {
        match self {
            Self::Round { core, radius } => Self::Round {
                core: core.moved_by(offset),
                radius: *radius,
            },
            Self::HalfSpace { point, normal } => Self::HalfSpace {
                point: *point + offset,
                normal: *normal,
            },
        }
    }

    pub(super) fn is_half_space(&self) -> bool {
        matches!(self, Self::HalfSpace { .. })
    }

    /// Turned around a point.
    pub(super) fn turned(&self, turn: &DMat3, pivot: DVec3) -> Self {
        match self {
            Self::Round { core, radius } => Self::Round {
                core: core.turned(turn, pivot),
                radius: *radius,
            },
            Self::HalfSpace { point, normal } => Self::HalfSpace {
                point: pivot + *turn * (*point - pivot),
                normal: *turn * *normal,
            },
        }
    }

    /// The shortest rotation from a solid of the same kind, as the axis times the angle. `None` for another kind, or a half-space.
    pub(super) fn rotation_from(&self, before: &Self) -> Option<DVec3> {
        match (before, self) {
            (Self::Round { core: before, .. }, Self::Round { core, .. }) => core.rotation_from(before),
            _ => None,
        }
    }

    /// A bound on the distances of its points from a point.
    pub(super) fn farthest_from(&self, point: DVec3) -> f64 {
        match self {
            Self::Round { core, radius } => {
                let (center, around) = core.around();
                center.distance(point) + around + radius
            }
            Self::HalfSpace { .. } => f64::INFINITY,
        }
    }

    /// A bound on how far any point has moved, up to rounding of the lengths. Infinite for another kind or size of core.
    pub(super) fn displacement_from(&self, before: &Self) -> f64 {
        match (before, self) {
            (
                Self::Round { core, radius },
                Self::Round {
                    core: core_now,
                    radius: radius_now,
                },
            ) => core_now.displacement_from(core) + (radius_now - radius).abs(),
            (
                Self::HalfSpace { point, normal },
                Self::HalfSpace {
                    point: point_now,
                    normal: normal_now,
                },
            ) if normal == normal_now => {
                let moved = *point_now - *point;
                moved.dot(*normal).abs() + 8.0 * f64::EPSILON * moved.length()
            }
            _ => f64::INFINITY,
        }
    }

    pub(super) fn intersects(&self, triangle: &Triangle) -> bool {
        match self {
            Self::Round {
                core: Core::Cuboid(cuboid),
                radius: 0.0,
            } => cuboid.intersects(triangle),
            _ => self.closest(triangle).distance <= 0.0,
        }
    }

    /// The point of a triangle with the smallest signed distance. That is at most 0 if and only if they intersect.
    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        match self {
            Self::Round { core, radius } => core.closest(triangle).seen_from_rounded_shape(*radius),
            Self::HalfSpace { point, normal } => {
                let height = |corner: &DVec3| (corner - point).dot(*normal);
                let lowest = triangle
                    .iter()
                    .min_by(|p, q| height(p).total_cmp(&height(q)))
                    .unwrap_or(&triangle[0]);
                Closest {
                    point: *lowest,
                    normal: *normal,
                    distance: height(lowest),
                }
            }
        }
    }

    /// The point of another solid with the smallest signed distance.
    pub(super) fn closest_of_solid(&self, other: &Self) -> Closest {
        match (self, other) {
            (
                Self::Round { core, radius },
                Self::Round {
                    core: of,
                    radius: of_radius,
                },
            ) => {
                let closest = core.closest_of_core(of);
                closest.seen_from_rounded_shape(*radius).of_rounded_set(*of_radius)
            }
            (Self::HalfSpace { point: foot, normal }, Self::Round { core, radius }) => {
                let point = core.support_point(-*normal);
                let closest = Closest {
                    point,
                    normal: *normal,
                    distance: (point - foot).dot(*normal),
                };
                closest.of_rounded_set(*radius)
            }
            (Self::HalfSpace { normal, .. }, Self::HalfSpace { point, normal: other }) => Closest {
                point: *point,
                normal: *normal,
                distance: if *normal == -*other {
                    self.signed_distance(*point)
                } else {
                    // Unless they face each other, they always overlap, without limit.
                    f64::NEG_INFINITY
                },
            },
            (Self::Round { .. }, Self::HalfSpace { .. }) => other.closest_of_solid(self).seen_from_the_other(),
        }
    }
}

fn size(what: &'static str, value: f32) -> Result<f64, InputError> {
    let value = f64::from(value);
    check_number(what, value, (0.0..=LARGEST).contains(&value), "from 0 to 1e37")?;
    Ok(value)
}

fn sizes<const N: usize>(what: &'static str, values: [f32; N]) -> Result<[f64; N], InputError> {
    let mut checked = [0.0; N];
    for (checked, value) in checked.iter_mut().zip(values) {
        *checked = size(what, value)?;
    }
    Ok(checked)
}
