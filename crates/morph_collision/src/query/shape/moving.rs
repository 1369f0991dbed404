//! Shapes that move and turn.

use glam::DVec3;

use super::core::turn;
use super::placed::PlacedShape;
use super::solid::Solid;
use crate::exact::largest;
use crate::input_error::{InputError, check_number, check_vector};

/// A shape that moves: along a straight line, and turning at a constant rate around a point that moves with it.
///
/// Times are shares of the motion, from 0 to 1.
///
/// ```
/// use glam::{DVec3, Quat, Vec3};
/// use morph_collision::motion::MovingShape;
/// use morph_collision::{PlacedShape, Shape};
///
/// // A rod falls over: its foot stays where it is, and it turns by a quarter of a turn.
/// let rod = Shape::Capsule { half_length: 1.0, radius: 0.1 };
/// let rod = PlacedShape::new(rod, Quat::IDENTITY, Vec3::Y)?;
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let falling = MovingShape::new(rod, DVec3::ZERO)?.turning(DVec3::ZERO, DVec3::Z * -quarter)?;
/// assert!(falling.at(0.0).signed_distance(DVec3::new(2.0, 0.0, 0.0)) > 1.0);
/// assert!(falling.at(1.0).signed_distance(DVec3::new(2.0, 0.0, 0.0)) < 0.0);
/// # Ok::<(), morph_collision::InputError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MovingShape {
    /// The shape at `known_at`.
    shape: PlacedShape,
    known_at: f64,
    /// The point around which it turns, at `known_at`.
    pivot: DVec3,
    translation: DVec3,
    /// The axis times the angle in radians.
    rotation: DVec3,
    /// How far the point of each solid that is farthest from the pivot is away from it.
    radii: Vec<f64>,
}

impl MovingShape {
    /// Creates a shape that moves from where it is by `translation`, in world units.
    ///
    /// # Errors
    /// [`InputError`] if a coordinate is not finite or beyond 1e37, or if a part of the shape is a half-space.
    pub fn new(start: PlacedShape, translation: DVec3) -> Result<Self, InputError> {
        check_vector("translation", translation, LARGEST)?;
        let half_spaces = start.solids().iter().filter(|solid| solid.is_half_space()).count();
        check_number(
            "number of half-spaces",
            half_spaces as f64,
            half_spaces == 0,
            "0 in a shape that moves",
        )?;
        Ok(Self {
            pivot: start.center(),
            shape: start,
            known_at: 0.0,
            translation,
            rotation: DVec3::ZERO,
            radii: Vec::new(),
        })
    }

    /// Also turns the shape around a point, given where it is at the start. `rotation` is the axis times the angle in radians.
    ///
    /// # Errors
    /// [`InputError`] if a coordinate is not finite, or beyond 1e37, or if the angle is above 1e3.
    pub fn turning(mut self, pivot: DVec3, rotation: DVec3) -> Result<Self, InputError> {
        check_vector("pivot", pivot, LARGEST)?;
        let angle = rotation.length();
        check_number("angle", angle, angle <= 1e3, "at most 1000 radians")?;
        self.pivot = pivot;
        self.rotation = rotation;
        self.measure();
        Ok(self)
    }

    /// Returns the motion between two placements of a shape: the shortest rotation of the first of its parts, around its middle.
    ///
    /// Sizes are those at the end. `None` if the two are shapes of different kinds, or if a part is a half-space.
    #[must_use]
    pub fn between(start: &PlacedShape, end: &PlacedShape) -> Option<Self> {
        let (from, to) = (start.solids(), end.solids());
        if from.len() != to.len() || to.iter().any(Solid::is_half_space) {
            return None;
        }
        let rotation = to[0].rotation_from(&from[0])?;
        let pivot = to[0].center();
        let mut motion = Self {
            shape: end.clone(),
            known_at: 1.0,
            pivot,
            translation: pivot - from[0].center(),
            rotation,
            radii: Vec::new(),
        };
        motion.measure();
        Some(motion)
    }

    fn measure(&mut self) {
        let solids = self.shape.solids().iter();
        self.radii = if self.rotation == DVec3::ZERO {
            Vec::new()
        } else {
            solids.map(|solid| solid.farthest_from(self.pivot)).collect()
        };
    }

    /// Returns the shape at a time.
    #[must_use]
    pub fn at(&self, time: f64) -> PlacedShape {
        self.shape.map(|solid| self.moved(solid, time))
    }

    fn moved(&self, solid: &Solid, time: f64) -> Solid {
        let since = time - self.known_at;
        if since == 0.0 {
            return solid.clone();
        }
        let offset = self.translation * since;
        if self.rotation == DVec3::ZERO {
            return solid.moved_by(offset);
        }
        solid.turned(&turn(self.rotation * since), self.pivot).moved_by(offset)
    }

    pub(super) fn translation(&self) -> DVec3 {
        self.translation
    }

    /// The solids as functions of time, each with the largest distance of a point from the pivot; 0 if it does not turn.
    pub(super) fn solids(&self) -> impl Iterator<Item = (f64, impl Fn(f64) -> Solid)> {
        let solids = self.shape.solids().iter().enumerate();
        solids.map(move |(index, solid)| {
            let radius = self.radii.get(index).copied().unwrap_or(0.0);
            (radius, move |time| self.moved(solid, time))
        })
    }

    /// How fast points at this distance from the pivot move along a unit vector at most.
    pub(super) fn speed_along(&self, direction: DVec3, radius: f64) -> f64 {
        direction.dot(self.translation) + direction.cross(self.rotation).length() * radius
    }

    /// The velocity of the shape's point that is at a place at a time.
    pub(super) fn velocity(&self, point: DVec3, time: f64) -> DVec3 {
        let pivot = self.pivot + self.translation * (time - self.known_at);
        self.translation + self.rotation.cross(point - pivot)
    }

    /// How far a point is at most from where it would be if it moved on a straight line from its start to its end.
    pub(super) fn bulge(&self) -> f64 {
        largest(self.radii.iter().copied()) * self.rotation.length_squared() / 8.0
    }

    /// The largest coordinate involved.
    pub(super) fn reach(&self) -> f64 {
        self.shape.reach() + self.translation.abs().max_element() + largest(self.radii.iter().copied())
    }

    /// Returns two opposite corners of a box around the whole motion, in world space.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let [[low, high], [low_after, high_after]] = self.boxes();
        [low.min(low_after), high.max(high_after)]
    }

    /// Boxes around it at the start and at the end, by their corners. It is in a box in between that moves on straight lines from one to the
    /// other.
    pub(in super::super) fn boxes(&self) -> [[DVec3; 2]; 2] {
        // More than the rounding of all this.
        let slack = self.bulge() + 64.0 * f64::EPSILON * self.reach();
        [0.0, 1.0].map(|time| {
            let shape = self.at(time);
            let high = DVec3::from(DVec3::AXES.map(|axis| shape.support(axis)));
            let low = -DVec3::from(DVec3::AXES.map(|axis| shape.support(-axis)));
            [low - slack, high + slack]
        })
    }
}

/// The largest coordinate.
const LARGEST: f64 = 1e37;
