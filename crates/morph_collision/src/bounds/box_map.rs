//! Affine maps of boxes in `f32`, rounded outward.

use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, f64x4};
use glam::{DVec3, Vec3A, Vec4};

use super::frame::{FrameLanes, PlacedBounds, to_world};
use super::kernel::with_simd;
use super::{Aabb, BoxLanes, Frame, Kernel};

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
    pub(crate) fn set(&mut self, frame: &Frame) -> bool {
        with_simd!(Kernel::default().level, simd => self.set_lanes(simd, &FrameLanes::load(simd, frame)))
    }

    /// [`BoxMap::set`] for a frame in registers.
    #[inline(always)]
    pub(crate) fn set_lanes<S: Simd>(&mut self, simd: S, frame: &FrameLanes<S>) -> bool {
        let [x, y, z] = frame.axes;
        let (x, y, z) = (rounded(x), rounded(y), rounded(z));
        let offset = rounded(frame.translation);
        let magnitude = vector(rounded(frame.magnitude));
        let underflow = UNDERFLOW * (1.0 + magnitude.element_sum());
        let row_sums = x.abs() + y.abs() + z.abs();
        let along = |magnitude: f32| f32x4::splat(simd, magnitude);
        let reach =
            x.abs() * along(magnitude.x) + y.abs() * along(magnitude.y) + z.abs() * along(magnitude.z) + offset.abs();
        // The factor covers the roundings of the error itself.
        let error = rounded(frame.error) * f32x4::splat(simd, 1.0 + 8.0 * f32::EPSILON) + f32x4::splat(simd, underflow);
        let slack = error + reach * f32x4::splat(simd, MAP_ROUNDINGS * f32::EPSILON / 2.0);
        self.columns = [vector(x), vector(y), vector(z)];
        self.offset_min = vector(offset - slack);
        self.offset_max = vector(offset + slack);
        // Sums everything, so that one comparison finds any number that is too large or NaN.
        vector(reach + slack + row_sums).element_sum() <= MAX_REACH
    }

    /// The image of one box.
    #[inline(always)]
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

#[inline(always)]
fn rounded<S: Simd>(numbers: f64x4<S>) -> f32x4<S> {
    numbers.narrow(numbers).split().0
}

#[inline(always)]
fn vector<S: Simd>(lanes: f32x4<S>) -> Vec3A {
    let mut numbers = [0.0; 4];
    lanes.store_slice(&mut numbers);
    Vec3A::from_vec4(Vec4::from_array(numbers))
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

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat, Vec3};

    use super::*;
    use crate::bounds::WorldFromModel;
    use crate::bounds::visit_frames;

    #[test]
    fn all_kernels_give_the_same_maps() {
        let turned = Affine3A::from_rotation_translation(Quat::from_rotation_z(0.6), Vec3::new(0.9, 0.3, 5.0));
        let scaled =
            Affine3A::from_scale_rotation_translation(Vec3::new(0.3, 1.0, 7.0), Quat::from_rotation_x(2.0), Vec3::X);
        let [a, b] = [turned, scaled].map(|place| {
            let place = WorldFromModel::new(place).unwrap();
            PlacedBounds::new(&place, DVec3::new(1.0, 2.0, 3.0))
        });
        let maps_of = |kernel: &Kernel| {
            let mut maps = Vec::new();
            with_simd!(kernel.level, simd => visit_frames(simd, &a, &b, |frames| {
                for frame in frames.into_iter().flatten() {
                    let mut map = BoxMap::default();
                    assert!(map.set_lanes(simd, frame));
                    maps.push(format!("{map:?}"));
                }
                true
            }));
            maps
        };
        let expected = maps_of(&Kernel::default());
        assert_eq!(expected.len(), 2);
        for kernel in Kernel::available() {
            assert_eq!(maps_of(kernel), expected, "{}", kernel.name());
        }
    }
}
