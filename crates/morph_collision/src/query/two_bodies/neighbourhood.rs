//! The local frame in which leaves of two bodies are compared in `f32`.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use crate::bounds::WorldFromModel;
use crate::exact::{power_of_two, power_of_two_below};
use crate::pose::LeafPositions;
use crate::tree::CornerLanes;

/// A frame near both bodies, in units of their size, where `f32` loses little of `f64`'s precision.
#[derive(Clone, Copy, Debug)]
pub(in crate::query) struct Neighbourhood {
    origin: DVec3,
    /// A power of two.
    pub(in crate::query) scale: f64,
}

impl Default for Neighbourhood {
    fn default() -> Self {
        Self::new(DVec3::ZERO, 1.0)
    }
}

impl Neighbourhood {
    /// A frame for bodies near `origin`, of roughly this size.
    pub(in crate::query) fn new(origin: DVec3, size: f64) -> Self {
        let size = if size.is_normal() { size } else { 1.0 };
        // Clamped so that no product of the scale, a placement and a coordinate overflows or underflows.
        let unit = power_of_two_below(size).clamp(power_of_two(-400), power_of_two(400));
        Self {
            origin,
            scale: unit.recip(),
        }
    }

    /// The map from a body's model space.
    pub(in crate::query) fn placement(&self, world_from_model: &WorldFromModel) -> Placement {
        Placement {
            linear: (world_from_model.linear() * self.scale).to_cols_array_2d(),
            translation: (world_from_model.translation() * self.scale).to_array(),
            origin: (self.origin * self.scale).to_array(),
            scale: self.scale,
        }
    }
}

/// The map from a body's model space to a neighbourhood.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::query) struct Placement {
    linear: [[f64; 3]; 3],
    translation: [f64; 3],
    origin: [f64; 3],
    scale: f64,
}

impl Placement {
    /// Takes the vertices of a leaf from world space to the neighbourhood. The fourth number of each point is padding.
    #[inline(always)]
    pub(in crate::query) fn place_points<S: Simd>(
        &self,
        simd: S,
        LeafPositions { vertices, world }: LeafPositions<'_>,
        placed: &mut Vec<[f32; 4]>,
    ) {
        let [x, y, z] = self.origin;
        let origin = f64x4::from_slice(simd, &[x, y, z, 0.0]);
        let scale = f64x4::splat(simd, self.scale);
        placed.clear();
        // In pairs; the last one may be padding.
        placed.resize(vertices.len().next_multiple_of(2), [0.0; 4]);
        for (pair, placed) in vertices.chunks(2).zip(placed.chunks_exact_mut(2)) {
            let (first, second) = (pair[0], pair[pair.len() - 1]);
            // The scale is a power of two, so it changes no rounding.
            let first = f64x4::from_slice(simd, &world[first as usize]) * scale - origin;
            let second = f64x4::from_slice(simd, &world[second as usize]) * scale - origin;
            first.narrow(second).store_slice(placed.as_flattened_mut());
        }
    }

    /// Maps the corners of eight triangles, in place.
    ///
    /// Places them exactly like [`WorldFromModel::transform_point`], except in the neighbourhood's unit. Its scale is a power of two, so
    /// it changes no rounding. Then subtracts the origin in `f64` and rounds once to `f32`. Monotonic in every coordinate.
    #[inline(always)]
    pub(in crate::query) fn place<S: Simd>(&self, simd: S, corners: &mut CornerLanes) {
        let [m_x, m_y, m_z] = self.linear;
        let (m_x, m_y, m_z) = (splat3(simd, m_x), splat3(simd, m_y), splat3(simd, m_z));
        let translation = splat3(simd, self.translation);
        let origin = splat3(simd, self.origin);
        for rows in corners {
            let [x, y, z] = &*rows;
            let (x, x_high) = x.load(simd).widen();
            let (y, y_high) = y.load(simd).widen();
            let (z, z_high) = z.load(simd).widen();
            for (i, row) in rows.iter_mut().enumerate() {
                let low = ((m_x[i] * x + m_y[i] * y) + m_z[i] * z) + translation[i];
                let high = ((m_x[i] * x_high + m_y[i] * y_high) + m_z[i] * z_high) + translation[i];
                let (low, high) = (low - origin[i], high - origin[i]);
                low.narrow(high).store_slice(&mut row.0);
            }
        }
    }
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, [x, y, z]: [f64; 3]) -> [f64x4<S>; 3] {
    [f64x4::splat(simd, x), f64x4::splat(simd, y), f64x4::splat(simd, z)]
}
