//! Random motions of two features, most of them in or next to an exact contact.
//!
//! Numbers of the constructions have few bits ([`numbers`]), so that contacts are exact: at a dyadic time a point of one feature is
//! exactly at a point of the other ([`meeting`]), or all points stay in a plane ([`planes`]). What makes them difficult comes after:
//! coordinates move by units in the last place, or everything is scaled ([`variation`]). Some get random digits, so that the contact
//! is off by rounding.

mod meeting;
mod numbers;
mod planes;
mod variation;

use std::fmt;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use self::meeting::{Approach, Meeting, Shape};
use self::numbers::{any_motion, grid_motion, instant};
use super::elementary::{ElementaryMotion, MotionKind};

/// A kind of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// Points from a cube to a cube.
    Generic,
    /// Whole coordinates between -2 and 2, so that all kinds of coincidences are common.
    Grid,
    /// Points of both features meet exactly at a dyadic time. The points are inside or a little outside.
    Crossing,
    /// The same with random digits, so that the contact is off by the rounding of the coordinates.
    RoundedCrossing,
    /// An exact contact at time 0 or time 1 alone, or one unit in the last place beside it.
    AtTheEnds,
    /// Touching all the time, or nearly.
    Resting,
    /// Contact without crossing: the determinant has a double root there, or two roots or none close by.
    Tangential,
    /// A vertex at a corner, a vertex at an edge, or the end of an edge at another.
    Grazing,
    /// Parallel edges, and vertices that slide in a face's plane.
    Parallel,
    /// All points in one plane, all the time. The plane may move.
    Coplanar,
    /// Faces that are segments or points and edges that are points, all the time.
    Degenerate,
    /// Faces and edges that collapse to segments or points at the time of contact.
    Collapsing,
    /// Another family at a scale of up to `2^300` or down to `2^-300`.
    Scaled,
    /// Another family with scales that differ between axes, or between coordinates.
    MixedScales,
    /// Next to the largest and the smallest numbers, and random bits.
    Extreme,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 15] = [
        Self::Generic,
        Self::Grid,
        Self::Crossing,
        Self::RoundedCrossing,
        Self::AtTheEnds,
        Self::Resting,
        Self::Tangential,
        Self::Grazing,
        Self::Parallel,
        Self::Coplanar,
        Self::Degenerate,
        Self::Collapsing,
        Self::Scaled,
        Self::MixedScales,
        Self::Extreme,
    ];

    /// A name for tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Generic => "generic",
            Self::Grid => "grid",
            Self::Crossing => "crossing",
            Self::RoundedCrossing => "rounded-crossing",
            Self::AtTheEnds => "at-the-ends",
            Self::Resting => "resting",
            Self::Tangential => "tangential",
            Self::Grazing => "grazing",
            Self::Parallel => "parallel",
            Self::Coplanar => "coplanar",
            Self::Degenerate => "degenerate",
            Self::Collapsing => "collapsing",
            Self::Scaled => "scaled",
            Self::MixedScales => "mixed-scales",
            Self::Extreme => "extreme",
        }
    }

    /// A motion of the family. The same seed and index give the same motion. Coordinates are finite.
    #[must_use]
    pub fn motion(self, seed: u64, index: u64) -> ElementaryMotion {
        // Separate streams for all three, so that a single motion can be drawn again.
        let stream = (self as u64) << 56 ^ index;
        let mut rng = Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ stream);
        self.draw(&mut rng)
    }

    fn draw(self, rng: &mut Pcg64Mcg) -> ElementaryMotion {
        let kind = MotionKind::ALL[rng.random_range(0..2)];
        let motion = self.plain(kind, rng);
        let motion = if self.is_nudged() && rng.random_bool(0.5) {
            variation::nudged(motion, rng)
        } else {
            motion
        };
        let motion = if rng.random_bool(0.5) {
            motion.reversed()
        } else {
            motion
        };
        let orders = motion.reordered();
        orders[rng.random_range(0..orders.len())]
    }

    /// Whether motions next to those of the construction belong to the family.
    fn is_nudged(self) -> bool {
        !matches!(self, Self::Generic | Self::Grid | Self::Extreme)
    }

    fn plain(self, kind: MotionKind, rng: &mut Pcg64Mcg) -> ElementaryMotion {
        let time = instant(rng);
        let exactly = |shape, approach, rng: &mut Pcg64Mcg| Meeting::draw(kind, shape, approach, rng);
        let meeting = |shape, approach, rng: &mut Pcg64Mcg| {
            let meeting = exactly(shape, approach, rng);
            if rng.random_bool(0.3) {
                meeting.with_random_digits(rng)
            } else {
                meeting
            }
        };
        match self {
            Self::Generic => any_motion(kind, rng),
            Self::Grid => grid_motion(kind, rng),
            Self::Crossing => exactly(Shape::full(rng), Approach::Any, rng).motion(time),
            Self::RoundedCrossing => {
                let meeting = exactly(Shape::full(rng), Approach::Any, rng);
                meeting.with_random_digits(rng).motion(time)
            }
            Self::AtTheEnds => meeting(Shape::Full, Approach::Any, rng).motion(time.round()),
            Self::Resting => meeting(Shape::Full, Approach::None, rng).motion(time),
            Self::Tangential => meeting(Shape::Full, Approach::Tangential, rng).motion(time),
            Self::Grazing => meeting(Shape::AtBoundary, Approach::any_kind(rng), rng).motion(time),
            Self::Parallel => planes::parallel(kind, time, rng),
            Self::Coplanar => planes::coplanar(kind, rng),
            Self::Degenerate => meeting(Shape::flat(rng), Approach::any_kind(rng), rng).motion(time),
            Self::Collapsing => {
                let meeting = exactly(Shape::flat(rng), Approach::Any, rng);
                meeting.with_shape_of_velocities(Shape::Full, rng).motion(time)
            }
            Self::Scaled => variation::scaled(Self::unscaled(rng).draw(rng), rng),
            Self::MixedScales => variation::mixed_scales(Self::unscaled(rng).draw(rng), rng),
            Self::Extreme => {
                let motion = Self::unscaled(rng).draw(rng);
                variation::extreme(motion, rng)
            }
        }
    }

    fn unscaled(rng: &mut Pcg64Mcg) -> Self {
        Self::ALL[rng.random_range(0..12)]
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
