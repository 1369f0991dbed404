//! Shapes in world space.

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::closest::Closest;
use super::cuboid::Cuboid;
use crate::exact::{
    Segment, Triangle, closest_of_segment_and_triangle, closest_on_segment, closest_on_triangle_exactly,
    common_segment, unit_normal,
};
use crate::input_error::{InputError, check_direction, check_number, check_point, check_vector};

/// The largest value allowed in a [`Shape`] or its placement.
const LARGEST: f64 = 1e37;

/// A primitive shape in its own space. All shapes are closed: they include their surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A solid ball around the origin.
    Ball {
        /// The radius; 0 gives a point.
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Half the length of the segment, without the round ends.
        half_length: f32,
        /// The radius; 0 gives a segment.
        radius: f32,
    },
    /// A solid box around the origin.
    Cuboid {
        /// Half the edge lengths; a 0 gives a flat box.
        half_extents: Vec3,
    },
    /// A plane through the origin and everything below it.
    HalfSpace {
        /// The direction out of the half-space. It may have any nonzero length.
        normal: Vec3,
    },
}

/// A validated shape in world space, for [`ShapeQuery`](crate::ShapeQuery).
///
/// ```
/// use glam::{DVec3, Quat, Vec3};
/// use morph_collision::{PlacedShape, Shape};
///
/// let shape = Shape::Capsule { half_length: 1.0, radius: 0.5 };
/// let capsule = PlacedShape::new(shape, Quat::IDENTITY, Vec3::new(0.0, 3.0, 0.0))?;
/// assert_eq!(capsule.signed_distance(DVec3::ZERO), 1.5);
/// # Ok::<(), morph_collision::InputError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedShape {
    pub(super) solid: Solid,
}

/// A shape in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    /// A ball or a capsule: all points within a radius of a segment. A ball's segment is a point.
    Round {
        axis: Segment,
        radius: f64,
    },
    Cuboid(Cuboid),
    HalfSpace {
        point: DVec3,
        normal: DVec3,
    },
}

impl PlacedShape {
    /// Rotates a shape and then moves it into world space. There is no scale, so sizes are in world units.
    ///
    /// # Errors
    /// [`InputError`] if
    ///
    /// - a number is not finite or beyond 1e37;
    /// - a size is negative;
    /// - a half-space's normal is zero;
    /// - the rotation's length differs from 1 by more than 1e-3. (It is then normalised in `f64`.)
    pub fn new(shape: Shape, rotation: Quat, translation: Vec3) -> Result<Self, InputError> {
        let [x, y, z, w] = rotation.to_array().map(f64::from);
        let rotation = DQuat::from_xyzw(x, y, z, w);
        let is_unit = (rotation.length() - 1.0).abs() <= 1e-3;
        check_number("length of the rotation", rotation.length(), is_unit, "1")?;
        let rotation = DMat3::from_quat(rotation.normalize());
        let translation = vector("translation", translation)?;
        let solid = match shape {
            Shape::Ball { radius } => Solid::Round {
                axis: [translation; 2],
                radius: size("radius", radius)?,
            },
            Shape::Capsule { half_length, radius } => {
                let half = rotation * (DVec3::Y * size("half_length", half_length)?);
                Solid::Round {
                    axis: [translation - half, translation + half],
                    radius: size("radius", radius)?,
                }
            }
            Shape::Cuboid { half_extents } => {
                for half in half_extents.to_array() {
                    size("half_extents", half)?;
                }
                Solid::Cuboid(Cuboid::new(half_extents.as_dvec3(), rotation, translation))
            }
            Shape::HalfSpace { normal } => {
                let normal = vector("normal", normal)?;
                check_direction("normal", normal)?;
                Solid::HalfSpace {
                    point: translation,
                    normal: (rotation * normal.normalize()).normalize(),
                }
            }
        };
        Ok(Self { solid })
    }

    /// Creates a ball around a point of world space, in `f64`.
    ///
    /// # Errors
    /// [`InputError`] if the centre is not finite or beyond 1e50, or if the radius is not between 0 and 1e50.
    pub fn ball(center: DVec3, radius: f64) -> Result<Self, InputError> {
        check_point("center", center)?;
        check_number("radius", radius, (0.0..=1e50).contains(&radius), "from 0 to 1e50")?;
        let axis = [center; 2];
        Ok(Self {
            solid: Solid::Round { axis, radius },
        })
    }

    /// Returns the signed distance of a point, in world units; negative inside.
    ///
    /// Inside a cuboid, its absolute value is the distance to the nearest face.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        match &self.solid {
            Solid::Round { axis, radius } => point.distance(closest_on_segment(point, *axis)) - radius,
            Solid::Cuboid(cuboid) => cuboid.signed_distance(point),
            Solid::HalfSpace { point: foot, normal } => (point - foot).dot(*normal),
        }
    }

    /// Returns a bound on how far any point of the shape has moved since `before`, in world units, rounding included. Infinite for another
    /// kind of shape, and for half-spaces that have rotated.
    #[must_use]
    pub fn displacement_from(&self, before: &Self) -> f64 {
        let moved = match (&before.solid, &self.solid) {
            (
                Solid::Round { axis: [p, q], radius },
                Solid::Round {
                    axis: [p_now, q_now],
                    radius: radius_now,
                },
            ) => p.distance(*p_now).max(q.distance(*q_now)) + (radius_now - radius).abs(),
            (Solid::Cuboid(before), Solid::Cuboid(now)) => now.displacement_from(before),
            (
                Solid::HalfSpace { point, normal },
                Solid::HalfSpace {
                    point: point_now,
                    normal: normal_now,
                },
            ) if normal == normal_now => {
                let moved = *point_now - *point;
                moved.dot(*normal).abs() + 8.0 * f64::EPSILON * moved.length()
            }
            _ => f64::INFINITY,
        };
        moved * (1.0 + 1e-9)
    }

    /// Returns whether a closed triangle in world space shares a point with the shape.
    ///
    /// - Cuboids: exact for the solid spanned by the eight `f64` corners and the `f64` centre, with each face split into two triangles.
    /// - Balls and capsules with radius 0: exact for the point, or for the segment between the `f64` ends.
    /// - Other shapes: whether the triangle's signed distance, computed in `f64`, is at most 0.
    #[must_use]
    pub fn intersects(&self, triangle: &Triangle) -> bool {
        match &self.solid {
            Solid::Cuboid(cuboid) => cuboid.intersects(triangle),
            _ => self.closest(triangle).distance <= 0.0,
        }
    }

    /// The point of a triangle with the smallest signed distance. That is at most 0 if and only if they intersect.
    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        match &self.solid {
            Solid::Round { axis, radius } => {
                let closest = closest_to_axis(*axis, triangle);
                Closest {
                    distance: closest.distance - radius,
                    ..closest
                }
            }
            Solid::Cuboid(cuboid) => cuboid.closest(triangle),
            Solid::HalfSpace { point, normal } => {
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
}

fn vector(what: &'static str, vector: Vec3) -> Result<DVec3, InputError> {
    let vector = vector.as_dvec3();
    check_vector(what, vector, LARGEST)?;
    Ok(vector)
}

fn size(what: &'static str, value: f32) -> Result<f64, InputError> {
    let value = f64::from(value);
    check_number(what, value, (0.0..=LARGEST).contains(&value), "from 0 to 1e37")?;
    Ok(value)
}

/// The closest point to a ball's centre or a capsule's segment. The distance is 0 if and only if they share a point.
fn closest_to_axis([p, q]: Segment, triangle: &Triangle) -> Closest {
    let apart = |on_axis: DVec3, point: DVec3, distance: f64| Closest {
        point,
        normal: (point - on_axis).try_normalize().unwrap_or(unit_normal(triangle)),
        distance,
    };
    if p == q {
        let foot = closest_on_triangle_exactly(p, triangle);
        return apart(p, foot.point, foot.squared.sqrt());
    }
    if let Some([s, t]) = common_segment(triangle, &[p, q, q]) {
        let point = s + (t - s) * 0.5;
        // The normal points away from the end of the segment that reaches farther through the triangle.
        let normal = unit_normal(triangle);
        let faces_middle = normal.dot(p - point + (q - point)) > 0.0;
        return Closest {
            point,
            normal: if faces_middle { -normal } else { normal },
            distance: 0.0,
        };
    }
    let closest = closest_of_segment_and_triangle([p, q], triangle);
    let distance = closest.on_a.distance(closest.on_b);
    apart(closest.on_a, closest.on_b, distance.max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_numbers_are_refused_by_name() {
        let message = |shape| {
            let placed = PlacedShape::new(shape, Quat::IDENTITY, Vec3::ZERO);
            placed.map_err(|error| error.to_string()).unwrap_err()
        };
        let negative = message(Shape::Ball { radius: -1.0 });
        assert_eq!(negative, "radius is -1, it must be from 0 to 1e37");
        let nan = message(Shape::Capsule {
            half_length: f32::NAN,
            radius: 1.0,
        });
        assert_eq!(nan, "half_length is NaN, it must be from 0 to 1e37");
        let half_extents = Vec3::new(1.0, f32::INFINITY, 1.0);
        assert!(message(Shape::Cuboid { half_extents }).contains("half_extents is inf"));
        assert!(message(Shape::HalfSpace { normal: Vec3::ZERO }).contains("normal is [0, 0, 0]"));
    }

    #[test]
    fn bad_placements_are_refused_by_name() {
        let message = |rotation, translation| {
            let placed = PlacedShape::new(Shape::Ball { radius: 1.0 }, rotation, translation);
            placed.err().map(|error| error.to_string())
        };
        assert_eq!(message(Quat::from_rotation_x(1.0), Vec3::ONE), None);
        let twice = message(Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), Vec3::ONE);
        assert_eq!(twice.as_deref(), Some("length of the rotation is 2, it must be 1"));
        let nan = message(Quat::IDENTITY, Vec3::NAN);
        assert!(nan.is_some_and(|message| message.contains("translation: coordinate 0 is NaN")));
        assert!(PlacedShape::ball(DVec3::ZERO, f64::NAN).is_err());
        assert!(PlacedShape::ball(DVec3::splat(1e60), 1.0).is_err());
        assert!(PlacedShape::ball(DVec3::ZERO, -0.5).is_err());
    }
}
