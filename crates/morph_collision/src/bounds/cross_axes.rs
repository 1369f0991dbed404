use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3};

use super::frame::{LARGEST, MAP_ROUNDINGS};
use super::rounding::{U32, down, up};
use super::{Aabb, BoxLanes, Frame, Lanes};

/// The nine products of an axis of one body and one of another, along which their boxes may be apart when they are along no
/// axis of either (Gottschalk, Lin and Manocha 1996).
///
/// The axes are the same for all nodes of a pair of bodies; so a box has an interval along each, as it has along the
/// directions of a k-DOP.
#[derive(Clone, Debug)]
pub(crate) struct CrossAxes {
    axes: Vec<CrossAxis>,
}

/// A direction in the space of the target body and what it is in the space of the source body.
#[derive(Clone, Copy, Debug)]
struct CrossAxis {
    target: Vec3,
    source: Vec3,
    /// What is added to the source's ends, slack included.
    offset_min: f32,
    offset_max: f32,
}

/// Which of the two bodies a box belongs to: the one whose space the frame leads to, or from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FrameSide {
    Target,
    Source,
}

impl CrossAxes {
    /// For boxes of the target body within `target`, and boxes of the other within the frame's magnitude.
    ///
    /// Axes that are nearly parallel give no direction, and directions beyond `f32` are left out.
    pub(crate) fn new(target_from_source: &Frame, target: &Aabb) -> Self {
        const PARALLEL: f64 = 1e-6;
        let frame = target_from_source;
        let m = frame.linear;
        let directions = DVec3::AXES.into_iter().flat_map(|own| {
            [m.x_axis, m.y_axis, m.z_axis].map(|other| {
                let product = own.cross(other.normalize_or_zero());
                if product.length() > PARALLEL {
                    product.normalize()
                } else {
                    DVec3::ZERO
                }
            })
        });
        let axes = directions
            .filter(|direction| *direction != DVec3::ZERO)
            .filter_map(|direction| CrossAxis::new(direction.as_vec3(), frame, target.magnitude().as_dvec3()))
            .collect();
        Self { axes }
    }

    /// Which of eight boxes of one side, out of `mask`, may meet a box of the other.
    #[inline(always)]
    pub(crate) fn overlap_mask<S: Simd>(
        &self,
        simd: S,
        side: FrameSide,
        boxes: &BoxLanes,
        other: &Aabb,
        mut mask: u8,
    ) -> u8 {
        for axis in &self.axes {
            if mask == 0 {
                break;
            }
            mask &= axis.overlap_mask(simd, side, boxes, other);
        }
        mask
    }
}

impl CrossAxis {
    fn new(target: Vec3, frame: &Frame, target_magnitude: DVec3) -> Option<Self> {
        let direction = target.as_dvec3();
        let source = frame.linear.transpose() * direction;
        let offset = direction.dot(frame.translation);
        let reach = direction.abs().dot(target_magnitude) + source.abs().dot(frame.magnitude) + offset.abs();
        let slack = direction.abs().dot(frame.error) + 2.0 * MAP_ROUNDINGS * U32 * reach + 4.0 * frame.underflow();
        let largest = source.abs().max_element().max(reach + slack);
        (largest < LARGEST).then(|| Self {
            target,
            source: source.as_vec3(),
            offset_min: down(offset - slack),
            offset_max: up(offset + slack),
        })
    }

    #[inline(always)]
    fn overlap_mask<S: Simd>(&self, simd: S, side: FrameSide, boxes: &BoxLanes, other: &Aabb) -> u8 {
        let (own, others) = match side {
            FrameSide::Target => (self.target, self.source),
            FrameSide::Source => (self.source, self.target),
        };
        let (mut other_min, mut other_max) = (0.0, 0.0);
        for (k, along) in others.to_array().into_iter().enumerate() {
            let (low, high) = if along < 0.0 {
                (other.max[k], other.min[k])
            } else {
                (other.min[k], other.max[k])
            };
            other_min += along * low;
            other_max += along * high;
        }
        let (mut min, mut max) = (Lanes::default(), Lanes::default());
        for (k, along) in own.to_array().into_iter().enumerate() {
            let (low, high) = boxes.along(k);
            let (low, high) = if along < 0.0 { (high, low) } else { (low, high) };
            min.add_scaled(simd, along, low);
            max.add_scaled(simd, along, high);
        }
        // The offset belongs to the source's ends.
        let (below, above) = match side {
            FrameSide::Target => (other_min + self.offset_min, other_max + self.offset_max),
            FrameSide::Source => (other_min - self.offset_max, other_max - self.offset_min),
        };
        let apart =
            max.load(simd).simd_lt(f32x8::splat(simd, below)) | min.load(simd).simd_gt(f32x8::splat(simd, above));
        // Not "apart", so that what is not a number overlaps.
        !(apart.to_bitmask() as u8)
    }
}
