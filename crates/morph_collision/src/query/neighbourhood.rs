//! The local frame in which leaves of two bodies are compared in `f32`.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::bounds::{Lanes, WorldFromModel};
use crate::exact::{power_of_two, power_of_two_below};

/// A frame near both bodies, in units of their size, where `f32` loses little of `f64`'s precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbourhood {
    origin: DVec3,
    /// A power of two.
    pub(super) scale: f64,
}

impl Neighbourhood {
    /// A frame for bodies near `origin`, of roughly this size.
    pub(super) fn new(origin: DVec3, size: f64) -> Self {
        let size = if size.is_normal() { size } else { 1.0 };
        // Within what leaves room on both sides.
        let unit = power_of_two_below(size).clamp(power_of_two(-900), power_of_two(900));
        Self {
            origin,
            scale: unit.recip(),
        }
    }
}

impl Default for Neighbourhood {
    fn default() -> Self {
        Self::new(DVec3::ZERO, 1.0)
    }
}

/// Maps eight posed corners to the neighbourhood.
///
/// Places them exactly like [`WorldFromModel::transform_point`], subtracts the origin in `f64` and rounds once. Monotonic in every
/// coordinate.
pub(super) struct Placement<S: Simd> {
    linear: [[f64x4<S>; 3]; 3],
    translation: [f64x4<S>; 3],
    origin: [f64x4<S>; 3],
    scale: f64x4<S>,
}

impl<S: Simd> Placement<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, world_from_model: &WorldFromModel, neighbourhood: &Neighbourhood) -> Self {
        let [x, y, z] = world_from_model.linear().to_cols_array_2d();
        let t = world_from_model.translation().to_array();
        let o = neighbourhood.origin.to_array();
        Self {
            linear: [splat3(simd, x), splat3(simd, y), splat3(simd, z)],
            translation: splat3(simd, t),
            origin: splat3(simd, o),
            scale: f64x4::splat(simd, neighbourhood.scale),
        }
    }

    #[inline(always)]
    pub(super) fn place(&self, simd: S, [x, y, z]: &[Lanes; 3], placed: &mut [Lanes; 3]) {
        let (x, x_high) = x.load(simd).widen();
        let (y, y_high) = y.load(simd).widen();
        let (z, z_high) = z.load(simd).widen();
        for (i, row) in placed.iter_mut().enumerate() {
            let low = self.coordinate(i, x, y, z);
            let high = self.coordinate(i, x_high, y_high, z_high);
            low.narrow(high).store_slice(&mut row.0);
        }
    }

    #[inline(always)]
    fn coordinate(&self, i: usize, x: f64x4<S>, y: f64x4<S>, z: f64x4<S>) -> f64x4<S> {
        let [m_x, m_y, m_z] = &self.linear;
        let world = ((m_x[i] * x + m_y[i] * y) + m_z[i] * z) + self.translation[i];
        (world - self.origin[i]) * self.scale
    }
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, [x, y, z]: [f64; 3]) -> [f64x4<S>; 3] {
    [f64x4::splat(simd, x), f64x4::splat(simd, y), f64x4::splat(simd, z)]
}
