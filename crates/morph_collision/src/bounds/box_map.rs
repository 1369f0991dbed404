//! Affine maps of boxes in `f32`, rounded outward.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;
use glam::{DVec3, Vec3A};

use super::frame::{PlacedBounds, relative_to, to_world};
use super::{Aabb, BoxLanes, Frame, WorldFromModel};

/// The number of roundings allowed for in a row of the map. Each is at most half a unit in the last place of the largest
/// magnitude reached. At most ten happen: of the entries, of three products and sums, of the offset, and of the slack itself
/// (docs/numerics.md).
const MAP_ROUNDINGS: f32 = 16.0;
/// Larger magnitudes could overflow in sums; such a map is not used.
const MAX_REACH: f32 = 1e37;
/// Covers underflow in entries and in products with them; far below any normal `f32`.
const UNDERFLOW: f32 = 1e-42;

/// A conservative affine map of boxes: each end of the image is an offset plus one scaled end of the source per axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct BoxMap {
    columns: [Vec3A; 3],
    pub(super) offset_min: Vec3A,
    pub(super) offset_max: Vec3A,
}

impl BoxMap {
    /// The map to a frame, for boxes of points within the frame's magnitude; `None` if `f32` cannot represent it.
    pub(crate) fn new(frame: &Frame) -> Option<Self> {
        let mut map = Self::default();
        map.set(frame).then_some(map)
    }

    /// Replaces this map with the map to a frame; returns false if `f32` cannot represent it.
    #[inline]
    pub(crate) fn set(&mut self, frame: &Frame) -> bool {
        let rounded = |v: DVec3| v.as_vec3a();
        let [x, y, z] = [frame.linear.x_axis, frame.linear.y_axis, frame.linear.z_axis].map(rounded);
        let (offset, magnitude) = (rounded(frame.translation), rounded(frame.magnitude));
        let (row_sums, underflow) = (x.abs() + y.abs() + z.abs(), UNDERFLOW * (1.0 + magnitude.element_sum()));
        let reach = x.abs() * magnitude.x + y.abs() * magnitude.y + z.abs() * magnitude.z + offset.abs();
        // The factor covers the roundings of the error itself.
        let error = rounded(frame.error) * (1.0 + 8.0 * f32::EPSILON) + underflow;
        let slack = error + reach * (MAP_ROUNDINGS * f32::EPSILON / 2.0);
        self.columns = [x, y, z];
        self.offset_min = offset - slack;
        self.offset_max = offset + slack;
        // Sums everything, so that one comparison finds any number that is too large or NaN.
        (reach + slack + row_sums).element_sum() <= MAX_REACH
    }

    /// The image of one box.
    #[inline]
    pub(crate) fn one(&self, one: &Aabb) -> Aabb {
        let (mut low, mut high) = (self.offset_min, self.offset_max);
        for (axis, column) in self.columns.iter().enumerate() {
            let (x, y) = (*column * one.min[axis], *column * one.max[axis]);
            low += x.min(y);
            high += x.max(y);
        }
        Aabb {
            min: low.into(),
            max: high.into(),
        }
    }

    /// Sets `mapped` to the images of eight boxes. Lanes without a child get arbitrary values.
    #[inline(always)]
    pub(crate) fn all<S: Simd>(&self, simd: S, source: &BoxLanes, mapped: &mut BoxLanes) {
        let ([a, b, c], [d, e, f]) = (&source.min, &source.max);
        let low = [a.load(simd), b.load(simd), c.load(simd)];
        let high = [d.load(simd), e.load(simd), f.load(simd)];
        let (offset_min, offset_max) = (self.offset_min.to_array(), self.offset_max.to_array());
        let [x, y, z] = &self.columns;
        let columns = [x.to_array(), y.to_array(), z.to_array()];
        for i in 0..3 {
            let mut min = f32x8::splat(simd, offset_min[i]);
            let mut max = f32x8::splat(simd, offset_max[i]);
            for (j, column) in columns.iter().enumerate() {
                let factor = f32x8::splat(simd, column[i]);
                let (x, y) = (low[j] * factor, high[j] * factor);
                min += x.min(y);
                max += x.max(y);
            }
            min.store_slice(&mut mapped.min[i].0);
            max.store_slice(&mut mapped.max[i].0);
        }
    }
}

/// The map to world space for boxes of a placed body. Mapped boxes contain the body's points as they are placed.
/// `None` if world coordinates exceed the range of `f32`.
pub(crate) fn world_map(placed: &PlacedBounds) -> Option<BoxMap> {
    let error = DVec3::splat(placed.error());
    BoxMap::new(&to_world(
        placed.world_from_model(),
        DVec3::ZERO,
        placed.magnitude(),
        error,
    ))
}

/// The map from the source's space to the model space of `to`; `None` if there is none that `f32` can represent.
pub(crate) fn map_into(to: &WorldFromModel, source: &PlacedBounds) -> Option<BoxMap> {
    let mut frame = Frame::default();
    let exists = relative_to(to, 0.0, source, &mut frame);
    exists.then(|| BoxMap::new(&frame)).flatten()
}
