//! SAT-lite (van den Bergen 1997): compares boxes of two bodies along the axes of either, conservatively with regard to
//! the exact test in world space.
//!
//! A map between bodies is computed in `f64`. Its slack covers the `f64` errors of world-space vertices and of the map,
//! and the `f32` errors of a mapped box. The constants are generous: a slack of a millionth of the bodies culls no worse.

use glam::{Affine3A, DVec3, Vec3, Vec3A};
use morph_collision::Aabb;

use super::boxes::{Box3, Box8, LANES};
use super::relative::{Frame, Relative, RoundedBody, abs, column_maxima};

/// More than all rounding of a coordinate in `f32`, in units of the sum of its terms' magnitudes.
const ROUNDINGS_F32: f64 = 32.0 * (f32::EPSILON as f64 / 2.0);
/// Covers products that underflow in `f32`.
const UNDERFLOW: f64 = 1e-40;
/// Beyond this, `f32` overflows and nothing is culled.
const LARGEST: f64 = 1e36;

/// Maps boxes of one body into a frame, rounding outward.
#[derive(Clone, Debug)]
pub(super) struct BoxMap {
    columns: [Vec3A; 3],
    translation: Vec3A,
    slack: Vec3A,
}

impl BoxMap {
    /// `None` if `f32` cannot represent it.
    fn new(relative: &Relative) -> Option<Self> {
        let Relative {
            linear,
            translation,
            reach,
            error,
        } = *relative;
        let mapped = abs(linear) * reach + translation.abs();
        let slack = error + (ROUNDINGS_F32 * mapped) + DVec3::splat(UNDERFLOW * (1.0 + reach.element_sum()));
        let largest = mapped.max_element() + slack.max_element() + column_maxima(abs(linear)).max_element();
        let fits = largest.is_finite() && largest < LARGEST;
        fits.then(|| Self {
            columns: [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::as_vec3a),
            translation: translation.as_vec3a(),
            slack: slack.as_vec3a() * 1.001,
        })
    }

    #[inline]
    fn one(&self, source: &Box3) -> Box3 {
        let centre = source.min * 0.5 + source.max * 0.5;
        let half = source.max * 0.5 - source.min * 0.5;
        let [x, y, z] = self.columns;
        let middle = self.translation + x * centre.x + y * centre.y + z * centre.z;
        let reach = self.slack + x.abs() * half.x + y.abs() * half.y + z.abs() * half.z;
        Box3 {
            min: middle - reach,
            max: middle + reach,
        }
    }

    #[inline]
    fn eight(&self, source: &Box8) -> Box8 {
        let mut target = Box8::default();
        let (mut centre, mut half) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for axis in 0..3 {
            for lane in 0..LANES {
                centre[axis][lane] = 0.5 * source.min[axis][lane] + 0.5 * source.max[axis][lane];
                half[axis][lane] = 0.5 * source.max[axis][lane] - 0.5 * source.min[axis][lane];
            }
        }
        for row in 0..3 {
            let entries = self.columns.map(|column| column[row]);
            let (translation, slack) = (self.translation[row], self.slack[row]);
            for lane in 0..LANES {
                let (mut middle, mut reach) = (translation, slack);
                for axis in 0..3 {
                    middle += entries[axis] * centre[axis][lane];
                    reach += entries[axis].abs() * half[axis][lane];
                }
                target.min[row][lane] = middle - reach;
                target.max[row][lane] = middle + reach;
            }
        }
        target
    }
}

/// One of two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    A,
    B,
}

/// All frames of two placed bodies: the spaces of both, or world space if neither can be inverted.
#[derive(Clone, Debug)]
pub(super) struct SatLite {
    frames: Vec<Frame<BoxMap>>,
}

impl SatLite {
    /// `a` and `b` are boxes around the whole bodies, in their own spaces.
    pub(super) fn new(world_from_a: &Affine3A, a: &Box3, world_from_b: &Affine3A, b: &Box3) -> Self {
        let (body_a, body_b) = (
            RoundedBody::new(world_from_a, reach(a)),
            RoundedBody::new(world_from_b, reach(b)),
        );
        Self {
            frames: Frame::all(&body_a, &body_b, BoxMap::new),
        }
    }

    /// Whether the boxes may share a point, as far as these frames can tell.
    #[inline]
    pub(super) fn overlap(&self, a: &Box3, b: &Box3) -> bool {
        self.frames
            .iter()
            .all(|frame| mapped(&frame.a, a).overlaps(&mapped(&frame.b, b)))
    }

    /// The same for eight boxes of one side against a box of the other.
    #[inline]
    pub(super) fn overlap_mask(&self, side: Side, boxes: &Box8, other: &Box3) -> u8 {
        let mut mask = u8::MAX;
        for frame in &self.frames {
            let (own, others) = match side {
                Side::A => (&frame.a, &frame.b),
                Side::B => (&frame.b, &frame.a),
            };
            let other = mapped(others, other);
            mask &= match own {
                Some(map) => map.eight(boxes).overlap_mask(&other),
                None => boxes.overlap_mask(&other),
            };
            if mask == 0 {
                break;
            }
        }
        mask
    }
}

#[inline]
fn mapped(map: &Option<BoxMap>, one: &Box3) -> Box3 {
    map.as_ref().map_or(*one, |map| map.one(one))
}

/// A world-space box around all placed vertices of a body; infinite beyond `f32`.
pub(super) fn world_bounds(world_from_model: &Affine3A, bounds: &Box3) -> Aabb {
    let body = RoundedBody::new(world_from_model, reach(bounds));
    match BoxMap::new(&body.to_world(DVec3::ZERO, body.error())) {
        Some(map) => map.one(bounds).aabb(),
        None => Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        },
    }
}

/// The largest absolute coordinates in a box.
fn reach(bounds: &Box3) -> DVec3 {
    bounds.min.abs().max(bounds.max.abs()).as_dvec3()
}
