//! A space in which joints are seen.

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::DVec3;

use super::WorldFromModel;
use crate::joints::Columns;

/// A space in which joints are seen. The map from world space into it is `inverse (x - translation)`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MapFrame {
    inverse: [[f64; 4]; 3],
    translation: [f64; 4],
}

impl MapFrame {
    /// The space of `world_from_model`, which must be invertible.
    pub(crate) fn new(world_from_model: &WorldFromModel) -> Self {
        let pad = |v: DVec3| [v.x, v.y, v.z, 0.0];
        let inverse = world_from_model.inverse_linear();
        Self {
            inverse: [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(pad),
            translation: pad(world_from_model.translation()),
        }
    }

    /// The columns of a joint's linear part and its translation, as seen in this frame.
    #[inline(always)]
    pub(crate) fn joint<S: Simd>(&self, simd: S, [x, y, z, offset]: &Columns) -> [f64x4<S>; 4] {
        let mut relative = [0.0; 4];
        (f64x4::from_slice(simd, offset) - f64x4::from_slice(simd, &self.translation)).store_slice(&mut relative);
        // Closures are not inlined here.
        let offset = self.turn(simd, &relative);
        [self.turn(simd, x), self.turn(simd, y), self.turn(simd, z), offset]
    }

    /// The image of a vector under the linear part.
    #[inline(always)]
    fn turn<S: Simd>(&self, simd: S, vector: &[f64; 4]) -> f64x4<S> {
        let [x, y, z] = &self.inverse;
        let x = f64x4::from_slice(simd, x) * f64x4::splat(simd, vector[0]);
        let y = f64x4::from_slice(simd, y) * f64x4::splat(simd, vector[1]);
        let z = f64x4::from_slice(simd, z) * f64x4::splat(simd, vector[2]);
        (x + y) + z
    }
}
