//! Shapes in world space.

use std::sync::Arc;

use glam::{DQuat, DVec3, Quat, Vec3};

use super::closest::Closest;
use super::kinds::Shape;
use super::solid::Solid;
use crate::exact::{Triangle, largest};
use crate::input_error::{InputError, check_number, check_point};

/// A validated shape in world space, for [`ShapeQuery`](crate::ShapeQuery): a [`Shape`], or several that move together.
///
/// Cloning it is cheap.
///
/// # Errors of distances
///
/// - Balls, capsules, cuboids and half-spaces: a few `f64` roundings of the coordinates involved.
/// - Cylinders, cones and convex hulls, apart from a triangle or another shape: the same if the gap is not small. For a gap `d` and
///   coordinates up to `s`, the distance is too small by at most `2e-16 * s * s / d`. Gaps below `1.5e-8 * s` may count as touching.
/// - The same, intersecting: the depth is too small by at most 1e-11 of the triangle's size, or 1e-10 of the other shape's, plus a few
///   roundings of the coordinates.
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
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedShape {
    parts: Parts,
}

/// At least one.
#[derive(Clone, Debug, PartialEq)]
enum Parts {
    One([Solid; 1]),
    Many(Arc<[Solid]>),
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
        let solid = Solid::new(shape, DQuat::from_xyzw(x, y, z, w), translation.as_dvec3())?;
        Ok(solid.into())
    }

    /// Joins shapes to one, a compound. It contains a point if one of them does.
    ///
    /// The signed distance is the smallest of theirs. So a depth is that in one part: where parts overlap, it is a lower bound of the depth in
    /// the whole.
    ///
    /// # Errors
    /// [`InputError`] if there is none.
    ///
    /// ```
    /// use glam::{DVec3, Quat, Vec3};
    /// use morph_collision::{PlacedShape, Shape};
    ///
    /// let handle = Shape::Cylinder { half_height: 1.0, radius: 0.1 };
    /// let head = Shape::Cuboid { half_extents: Vec3::new(0.5, 0.2, 0.2) };
    /// let hammer = PlacedShape::compound(&[
    ///     PlacedShape::new(handle, Quat::IDENTITY, Vec3::ZERO)?,
    ///     PlacedShape::new(head, Quat::IDENTITY, Vec3::Y)?,
    /// ])?;
    /// assert_eq!(hammer.signed_distance(DVec3::new(2.5, 1.0, 0.0)), 2.0);
    /// # Ok::<(), morph_collision::InputError>(())
    /// ```
    pub fn compound(parts: &[Self]) -> Result<Self, InputError> {
        check_number(
            "parts of a compound",
            parts.len() as f64,
            !parts.is_empty(),
            "at least 1",
        )?;
        Ok(match parts {
            [one] => one.clone(),
            _ => Self {
                parts: Parts::Many(parts.iter().flat_map(Self::solids).cloned().collect()),
            },
        })
    }

    /// Creates a ball around a point of world space, in `f64`.
    ///
    /// # Errors
    /// [`InputError`] if the centre is not finite or beyond 1e50, or if the radius is not between 0 and 1e50.
    pub fn ball(center: DVec3, radius: f64) -> Result<Self, InputError> {
        check_point("center", center)?;
        check_number("radius", radius, (0.0..=1e50).contains(&radius), "from 0 to 1e50")?;
        Ok(Solid::ball(center, radius).into())
    }

    /// The convex shapes of which it is made, at least one.
    pub(super) fn solids(&self) -> &[Solid] {
        match &self.parts {
            Parts::One(solid) => solid,
            Parts::Many(solids) => solids,
        }
    }

    /// The solid that is nearest to a point, or in which it is deepest.
    fn nearest_solid(&self, point: DVec3) -> &Solid {
        let solids = self.solids();
        let distance = |solid: &&Solid| solid.signed_distance(point);
        match solids {
            [one] => one,
            _ => solids
                .iter()
                .min_by(|p, q| distance(p).total_cmp(&distance(q)))
                .unwrap_or(&solids[0]),
        }
    }

    /// Returns the signed distance of a point, in world units; negative inside.
    ///
    /// Inside a shape with faces, its absolute value is the distance to the nearest face.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        self.nearest_solid(point).signed_distance(point)
    }

    /// The gradient of the signed distance at a point, a unit vector. Arbitrary if the gradient does not exist.
    pub(super) fn outward(&self, point: DVec3) -> DVec3 {
        self.nearest_solid(point).outward(point)
    }

    /// Returns a bound on how far any point of the shape has moved since `before`, in world units, rounding included. Infinite for another
    /// kind of shape, another number of parts, another size of a frustum or another hull, and for half-spaces that have rotated. Balls, capsules and
    /// cuboids may grow.
    #[must_use]
    pub fn displacement_from(&self, before: &Self) -> f64 {
        let (now, before) = (self.solids(), before.solids());
        if now.len() != before.len() {
            return f64::INFINITY;
        }
        let moved = now
            .iter()
            .zip(before)
            .map(|(now, before)| now.displacement_from(before));
        largest(moved) * (1.0 + 1e-9)
    }

    /// Returns whether a closed triangle in world space shares a point with the shape.
    ///
    /// - Cuboids: exact for the solid spanned by the eight `f64` corners and the `f64` centre, with each face split into two triangles.
    /// - Balls and capsules with radius 0: exact for the point, or for the segment between the `f64` ends.
    /// - Other shapes: whether the triangle's signed distance, computed in `f64`, is at most 0.
    #[must_use]
    pub fn intersects(&self, triangle: &Triangle) -> bool {
        self.solids().iter().any(|solid| solid.intersects(triangle))
    }

    /// The point of a triangle with the smallest signed distance. That is at most 0 if and only if they intersect.
    pub(super) fn closest(&self, triangle: &Triangle) -> Closest {
        let (first, others) = self.first_and_others();
        let closest = first.closest(triangle);
        let closest_of_others = others.iter().map(|solid| solid.closest(triangle));
        Closest::smallest(std::iter::once(closest).chain(closest_of_others)).unwrap_or(closest)
    }

    pub(super) fn first_and_others(&self) -> (&Solid, &[Solid]) {
        let solids = self.solids();
        (&solids[0], &solids[1..])
    }

    /// The largest `direction . x` for a unit vector; may be infinite.
    pub(super) fn support(&self, direction: DVec3) -> f64 {
        let larger = |p: f64, q: f64| if q > p { q } else { p };
        let supports = self.solids().iter().map(|solid| solid.support(direction));
        supports.fold(f64::NEG_INFINITY, larger)
    }

    /// The same parts, each changed.
    pub(super) fn map(&self, change: impl Fn(&Solid) -> Solid) -> Self {
        let parts = match &self.parts {
            Parts::One([solid]) => Parts::One([change(solid)]),
            Parts::Many(solids) => Parts::Many(solids.iter().map(change).collect()),
        };
        Self { parts }
    }

    /// A point inside.
    pub(super) fn center(&self) -> DVec3 {
        self.first_and_others().0.center()
    }

    /// An upper bound for the coordinates involved in a distance to the shape.
    pub(super) fn reach(&self) -> f64 {
        largest(self.solids().iter().map(Solid::reach))
    }
}

impl From<Solid> for PlacedShape {
    fn from(solid: Solid) -> Self {
        Self {
            parts: Parts::One([solid]),
        }
    }
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
