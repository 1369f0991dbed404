//! SAT-lite (van den Bergen 1997): boxes of two bodies compared along the axes of either, conservatively for the exact
//! test in world space.
//!
//! A map between bodies is made in `f64`; its slack covers how far world-space vertices and the map are off, in `f64`, and
//! what happens to a box in `f32`. The constants are generous: a slack of a millionth of the bodies culls no worse.

use glam::{Affine3A, DMat3, DVec3, Vec3, Vec3A};
use morph_collision::Aabb;

use super::boxes::{Box3, Box8, LANES};

/// More than all roundings that a coordinate goes through in `f64`, in units of the sum of its terms' magnitudes.
const ROUNDINGS_F64: f64 = 64.0 * (f64::EPSILON / 2.0);
/// The same in `f32`.
const ROUNDINGS_F32: f64 = 32.0 * (f32::EPSILON as f64 / 2.0);
/// Covers products that underflow in `f32`.
const UNDERFLOW: f64 = 1e-40;
/// Beyond this `f32` overflows, and nothing is culled.
const LARGEST: f64 = 1e36;

/// Takes boxes of one body into a frame, outward.
#[derive(Clone, Debug)]
pub(super) struct BoxMap {
    columns: [Vec3A; 3],
    translation: Vec3A,
    slack: Vec3A,
}

impl BoxMap {
    /// A map for boxes within `reach` (largest absolute coordinates); `error` is how far points may be off in the target.
    fn new(linear: DMat3, translation: DVec3, reach: DVec3, error: DVec3) -> Option<Self> {
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

/// Where boxes of both bodies are compared; a side without a map is in its own space there.
#[derive(Clone, Debug)]
struct Frame {
    a: Option<BoxMap>,
    b: Option<BoxMap>,
}

/// All frames of two placed bodies: the spaces of both, or world space where neither can be inverted.
#[derive(Clone, Debug)]
pub(super) struct SatLite {
    frames: Vec<Frame>,
}

impl SatLite {
    /// `a` and `b` are boxes around the whole bodies, in their own spaces.
    pub(super) fn new(world_from_a: &Affine3A, a: &Box3, world_from_b: &Affine3A, b: &Box3) -> Self {
        let (body_a, body_b) = (Placed::new(world_from_a, a), Placed::new(world_from_b, b));
        let error = body_a.error() + body_b.error();
        let mut frames = Vec::with_capacity(2);
        if let Some(b) = body_a.from(&body_b, error) {
            frames.push(Frame { a: None, b: Some(b) });
        }
        if let Some(a) = body_b.from(&body_a, error) {
            frames.push(Frame { a: Some(a), b: None });
        }
        if frames.is_empty() {
            // Around A's origin, so that bodies far out stay sharp.
            let origin = body_a.translation;
            if let (Some(a), Some(b)) = (body_a.to_world(origin, error), body_b.to_world(origin, error)) {
                frames.push(Frame { a: Some(a), b: Some(b) });
            }
        }
        Self { frames }
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

/// A box in world space around all vertices of a body, as they are placed; infinite beyond `f32`.
pub(super) fn world_bounds(world_from_model: &Affine3A, bounds: &Box3) -> Aabb {
    let body = Placed::new(world_from_model, bounds);
    match body.to_world(DVec3::ZERO, body.error()) {
        Some(map) => map.one(bounds).aabb(),
        None => Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        },
    }
}

/// A body's affine in `f64` and how far its box reaches.
struct Placed {
    linear: DMat3,
    translation: DVec3,
    reach: DVec3,
}

impl Placed {
    fn new(world_from_model: &Affine3A, bounds: &Box3) -> Self {
        let matrix = world_from_model.matrix3;
        Self {
            linear: DMat3::from_cols(
                matrix.x_axis.as_dvec3(),
                matrix.y_axis.as_dvec3(),
                matrix.z_axis.as_dvec3(),
            ),
            translation: world_from_model.translation.as_dvec3(),
            reach: bounds.min.abs().max(bounds.max.abs()).as_dvec3(),
        }
    }

    /// How far world-space vertices may be off the exact images of model-space ones.
    fn error(&self) -> DVec3 {
        ROUNDINGS_F64 * (abs(self.linear) * self.reach + self.translation.abs())
    }

    fn to_world(&self, origin: DVec3, error: DVec3) -> Option<BoxMap> {
        BoxMap::new(self.linear, self.translation - origin, self.reach, error)
    }

    /// The map of `other`'s boxes to this body's space; none where this body is too flat to invert.
    fn from(&self, other: &Self, world_error: DVec3) -> Option<BoxMap> {
        let largest = column_maxima(abs(self.linear)).max_element();
        let scaled = self.linear * (1.0 / largest);
        if largest == 0.0 || scaled.determinant().abs() < 1e-60 {
            return None;
        }
        let inverse = scaled.inverse() * (1.0 / largest);
        // |A^-1 y - N y| <= rho / (1 - rho) |N| |y| in the largest coordinate, with rho around |I - N A|.
        let residual = abs(DMat3::IDENTITY - inverse * self.linear);
        let rho = row_sum(residual) + ROUNDINGS_F64 * row_sum(abs(inverse) * abs(self.linear));
        if rho.is_nan() || rho > 0.01 {
            return None;
        }
        let offset = other.translation - self.translation;
        let reach = abs(other.linear) * other.reach + offset.abs() + world_error;
        let of_inverse = DVec3::splat(1.02 * rho * (abs(inverse) * reach).max_element());
        let error = of_inverse + abs(inverse) * (world_error + ROUNDINGS_F64 * reach);
        BoxMap::new(inverse * other.linear, inverse * offset, other.reach, error)
    }
}

fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The largest row sum of a matrix without negative entries.
fn row_sum(m: DMat3) -> f64 {
    (m * DVec3::ONE).max_element()
}

fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
