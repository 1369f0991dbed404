//! The local frame in which leaves of two bodies are compared in `f32`.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::bounds::WorldFromModel;
use crate::exact::{power_of_two, power_of_two_below};
use crate::tree::CornerLanes;

/// A frame near both bodies, in units of their size, where `f32` loses little of `f64`'s precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbourhood {
    origin: DVec3,
    /// A power of two.
    pub(super) scale: f64,
}

impl Default for Neighbourhood {
    fn default() -> Self {
        Self::new(DVec3::ZERO, 1.0)
    }
}

impl Neighbourhood {
    /// A frame for bodies near `origin`, of roughly this size.
    pub(super) fn new(origin: DVec3, size: f64) -> Self {
        let size = if size.is_normal() { size } else { 1.0 };
        // Clamped so that neither the unit nor its inverse overflows or underflows.
        let unit = power_of_two_below(size).clamp(power_of_two(-900), power_of_two(900));
        Self {
            origin,
            scale: unit.recip(),
        }
    }

    /// Maps the posed corners of eight triangles to the neighbourhood, in place.
    ///
    /// Places them exactly like [`WorldFromModel::transform_point`], subtracts the origin in `f64` and rounds once. Monotonic in
    /// every coordinate.
    #[inline(always)]
    pub(super) fn place<S: Simd>(
        &self,
        simd: S,
        world_from_model: &WorldFromModel,
        corners: &mut CornerLanes,
    ) {
        let linear = world_from_model.linear().to_cols_array_2d();
        let [m_x, m_y, m_z] = [
            splat3(simd, linear[0]),
            splat3(simd, linear[1]),
            splat3(simd, linear[2]),
        ];
        let translation = splat3(simd, world_from_model.translation().to_array());
        let origin = splat3(simd, self.origin.to_array());
        let scale = f64x4::splat(simd, self.scale);
        for rows in corners {
            let [x, y, z] = &*rows;
            let (x, x_high) = x.load(simd).widen();
            let (y, y_high) = y.load(simd).widen();
            let (z, z_high) = z.load(simd).widen();
            for (i, row) in rows.iter_mut().enumerate() {
                let low = ((m_x[i] * x + m_y[i] * y) + m_z[i] * z) + translation[i];
                let high = ((m_x[i] * x_high + m_y[i] * y_high) + m_z[i] * z_high) + translation[i];
                let (low, high) = ((low - origin[i]) * scale, (high - origin[i]) * scale);
                low.narrow(high).store_slice(&mut row.0);
            }
        }
    }
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, [x, y, z]: [f64; 3]) -> [f64x4<S>; 3] {
    [f64x4::splat(simd, x), f64x4::splat(simd, y), f64x4::splat(simd, z)]
}
