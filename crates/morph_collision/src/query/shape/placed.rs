use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::ShapeError;
use super::cuboid::Cuboid;
use super::solid::Solid;

/// A primitive shape in its own space; all are closed: their surfaces belong to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A solid ball around the origin.
    Ball {
        /// Its radius; 0 makes a point.
        radius: f32,
    },
    /// All points within a radius of a segment along the y axis.
    Capsule {
        /// Half the length of the segment, the round ends not included.
        half_length: f32,
        /// The radius.
        radius: f32,
    },
    /// A solid box around the origin.
    Cuboid {
        /// Half its edges; 0 makes it flat.
        half_extents: Vec3,
    },
    /// A plane through the origin and all that is below it.
    HalfSpace {
        /// The direction that is up; any length but 0.
        normal: Vec3,
    },
    /// All points between two.
    Segment {
        /// One end.
        a: Vec3,
        /// The other.
        b: Vec3,
    },
}

/// Where a shape stands: a validated rotation and translation from its own space to world space.
///
/// No scale, so that radii are in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldFromShape {
    pub(super) rotation: DMat3,
    pub(super) translation: DVec3,
}

impl WorldFromShape {
    /// The shape's own space is world space.
    pub const IDENTITY: Self = Self {
        rotation: DMat3::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Validates a rotation, which is brought to length 1 in `f64`, and a translation.
    ///
    /// # Errors
    /// A number that is not finite or beyond 1e37; a rotation whose length is off 1 by more than 1e-3.
    pub fn new(rotation: Quat, translation: Vec3) -> Result<Self, ShapeError> {
        check("the rotation", &rotation.to_array())?;
        check("the translation", &translation.to_array())?;
        let length = rotation.length();
        if (length - 1.0).abs() > 1e-3 {
            return Err(ShapeError::NotUnit { length });
        }
        let [x, y, z, w] = rotation.to_array().map(f64::from);
        Ok(Self {
            rotation: DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()),
            translation: translation.as_dvec3(),
        })
    }

    fn point(&self, local: DVec3) -> DVec3 {
        self.rotation * local + self.translation
    }
}

/// A validated shape in world space, to ask about bodies with [`ShapeQuery`](crate::ShapeQuery).
///
/// ```
/// use glam::{DVec3, Quat, Vec3};
/// use morph_collision::{PlacedShape, Shape, WorldFromShape};
///
/// let place = WorldFromShape::new(Quat::IDENTITY, Vec3::new(0.0, 3.0, 0.0))?;
/// let capsule = PlacedShape::new(Shape::Capsule { half_length: 1.0, radius: 0.5 }, &place)?;
/// assert_eq!(capsule.signed_distance(DVec3::ZERO), 1.5);
/// # Ok::<(), morph_collision::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedShape {
    pub(super) solid: Solid,
}

impl PlacedShape {
    /// Places a shape.
    ///
    /// # Errors
    /// A number that is not finite or beyond 1e37, a negative size, a half-space without a direction.
    pub fn new(shape: Shape, world_from_shape: &WorldFromShape) -> Result<Self, ShapeError> {
        let at = world_from_shape;
        let solid = match shape {
            Shape::Ball { radius } => Solid::Round {
                axis: [at.translation; 2],
                radius: size("the radius", radius)?,
            },
            Shape::Capsule { half_length, radius } => {
                let half = DVec3::Y * size("the half length", half_length)?;
                Solid::Round {
                    axis: [at.point(-half), at.point(half)],
                    radius: size("the radius", radius)?,
                }
            }
            Shape::Cuboid { half_extents } => {
                for half in half_extents.to_array() {
                    size("the half extents", half)?;
                }
                Solid::Cuboid(Cuboid::new(half_extents.as_dvec3(), at.rotation, at.translation))
            }
            Shape::HalfSpace { normal } => {
                check("the normal", &normal.to_array())?;
                let normal = normal.as_dvec3().try_normalize();
                let normal = normal.ok_or(ShapeError::NoDirection { what: "the normal" })?;
                Solid::HalfSpace {
                    point: at.translation,
                    normal: (at.rotation * normal).normalize(),
                }
            }
            Shape::Segment { a, b } => {
                check("the segment", &[a.to_array(), b.to_array()].concat())?;
                Solid::Segment([a, b].map(|end| at.point(end.as_dvec3())))
            }
        };
        Ok(Self { solid })
    }
}

fn check(what: &'static str, numbers: &[f32]) -> Result<(), ShapeError> {
    match numbers.iter().find(|number| number.is_nan() || number.abs() > 1e37) {
        Some(&value) => Err(ShapeError::BadNumber { what, value }),
        None => Ok(()),
    }
}

fn size(what: &'static str, value: f32) -> Result<f64, ShapeError> {
    check(what, &[value])?;
    if value < 0.0 {
        return Err(ShapeError::Negative { what, value });
    }
    Ok(f64::from(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_numbers_are_turned_away_by_name() {
        let place = |shape| {
            PlacedShape::new(shape, &WorldFromShape::IDENTITY)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            place(Shape::Ball { radius: -1.0 }),
            "the radius is -1, a size cannot be negative"
        );
        let nan = Shape::Capsule {
            half_length: f32::NAN,
            radius: 1.0,
        };
        assert_eq!(
            place(nan),
            "the half length holds NaN, not a number between -1e37 and 1e37"
        );
        let half_extents = Vec3::new(1.0, f32::INFINITY, 1.0);
        assert!(place(Shape::Cuboid { half_extents }).contains("half extents holds inf"));
        assert!(place(Shape::HalfSpace { normal: Vec3::ZERO }).contains("no direction"));
        let ends = [Vec3::ZERO, Vec3::splat(2e37)];
        assert!(place(Shape::Segment { a: ends[0], b: ends[1] }).contains("the segment holds"));
    }

    #[test]
    fn rotations_must_be_of_length_one() {
        assert!(WorldFromShape::new(Quat::from_rotation_x(1.0), Vec3::ONE).is_ok());
        let twice = Quat::from_xyzw(0.0, 0.0, 0.0, 2.0);
        assert_eq!(
            WorldFromShape::new(twice, Vec3::ONE),
            Err(ShapeError::NotUnit { length: 2.0 })
        );
        assert!(WorldFromShape::new(Quat::IDENTITY, Vec3::NAN).is_err());
    }
}
