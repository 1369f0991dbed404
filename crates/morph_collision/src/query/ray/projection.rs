//! Triangles projected along a ray, eight side by side in `f32`.

use fearless_simd::prelude::*;
use fearless_simd::{f32x8, f64x4};
use glam::DVec3;

use crate::bounds::{LANES, PlacedBounds};
use crate::exact::{Line, power_of_two, power_of_two_below};
use crate::pose::Posed;
use crate::tree::{CornerLanes, Leaf, gather};

/// A sheared projection along a ray to a coordinate plane, in which the ray's line is the origin.
///
/// Let `d` be the ray's direction, `k` its largest axis, and `q = p - origin` for a point `p`. The projection of `p` has the coordinates
/// `q_i - d_i / d_k q_k` for the two other axes `i`. The line passes through a triangle if the triangle's projection contains the
/// origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayProjection {
    /// `axes[2]` is the largest axis of the ray's direction.
    axes: [usize; 3],
    shear: [f64; 2],
    origin: DVec3,
    /// The map from model space to both coordinates: factors for x, y and z, and an offset.
    from_model: [[f64; 4]; 2],
    /// A power of two that brings coordinates to a size around 1 or below.
    scale: f64,
    /// A bound on how far `f64` rounding moves a point.
    error: f32,
}

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

impl RayProjection {
    pub(super) fn new(line: &Line, body: &PlacedBounds) -> Self {
        let Line { origin, direction, .. } = *line;
        let k = direction.abs().max_position();
        let axes = [(k + 1) % 3, (k + 2) % 3, k];
        let shear = [direction[axes[0]] / direction[k], direction[axes[1]] / direction[k]];
        let reach = body.world_reach().element_sum() + origin.abs().element_sum();
        // Clamped so that neither the scale nor its products overflow or underflow.
        let unit = power_of_two_below(reach).clamp(power_of_two(-400), power_of_two(400));
        let scale = unit.recip();
        let world_from_model = body.world_from_model();
        let along = |axis: usize, of: DVec3| scale * (of[axes[axis]] - shear[axis] * of[k]);
        let columns = [
            world_from_model.linear().x_axis,
            world_from_model.linear().y_axis,
            world_from_model.linear().z_axis,
            world_from_model.translation() - origin,
        ];
        Self {
            axes,
            shear,
            origin,
            from_model: [0, 1].map(|axis| columns.map(|column| along(axis, column))),
            scale,
            // 128 roundings. A corner has fewer than 40, including those of its placement.
            error: (64.0 * f64::EPSILON * reach * scale) as f32 + f32::MIN_POSITIVE,
        }
    }

    /// The triangles of a leaf's patch that the ray's line might meet, as a bit mask. `points` is scratch memory.
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(
        &self,
        simd: S,
        tree: &mut Posed<'_>,
        leaf: Leaf,
        patch: usize,
        points: &mut Vec<[f32; 4]>,
    ) -> u8 {
        let mut corners = CornerLanes::default();
        let mesh = tree.topology.leaf_mesh(leaf);
        let triangles = mesh.corners.chunks(LANES).nth(patch).unwrap_or_default();
        if tree.is_skinned() {
            if patch == 0 {
                points.clear();
                for &[x, y, z, _] in tree.world_vertices(leaf) {
                    points.push(self.project(DVec3::new(x, y, z)));
                }
            }
            gather(simd, triangles, points, &mut corners);
        } else {
            tree.patch_corners(simd, leaf, patch, &mut corners);
            self.project_lanes(simd, &mut corners);
        }
        let used = ((1_u16 << triangles.len()) - 1) as u8;
        used & !self.misses(simd, &corners)
    }

    /// Projects a point of world space; the result is in the first two numbers.
    #[inline(always)]
    fn project(&self, point: DVec3) -> [f32; 4] {
        let from_origin = point - self.origin;
        let [i, j, k] = self.axes;
        let along = from_origin[k];
        let x = self.scale * (from_origin[i] - self.shear[0] * along);
        let y = self.scale * (from_origin[j] - self.shear[1] * along);
        [x as f32, y as f32, 0.0, 0.0]
    }

    /// Projects corners in model space, in place: replaces their first two coordinates.
    #[inline(always)]
    fn project_lanes<S: Simd>(&self, simd: S, corners: &mut CornerLanes) {
        for rows in corners {
            let (x, x_high) = rows[0].load(simd).widen();
            let (y, y_high) = rows[1].load(simd).widen();
            let (z, z_high) = rows[2].load(simd).widen();
            for (&[m_x, m_y, m_z, translation], row) in self.from_model.iter().zip(rows) {
                let (m_x, m_y) = (f64x4::splat(simd, m_x), f64x4::splat(simd, m_y));
                let (m_z, translation) = (f64x4::splat(simd, m_z), f64x4::splat(simd, translation));
                let low = ((m_x * x + m_y * y) + m_z * z) + translation;
                let high = ((m_x * x_high + m_y * y_high) + m_z * z_high) + translation;
                low.narrow(high).store_slice(&mut row.0);
            }
        }
    }

    /// A bit mask of the triangles that the line certainly misses: the origin is certainly left of one edge and right of another.
    ///
    /// Let `E` be the error of a coordinate before it is rounded to `f32`, and `R` the largest coordinate of a triangle. The error of a
    /// turn `x_1 y_2 - y_1 x_2` is at most `4 R E + 8 U R^2` plus underflow. If `R^2` overflows, nothing is certain.
    #[inline(always)]
    fn misses<S: Simd>(&self, simd: S, corners: &CornerLanes) -> u8 {
        let [a, b, c] = corners;
        let (a_x, a_y) = (a[0].load(simd), a[1].load(simd));
        let (b_x, b_y) = (b[0].load(simd), b[1].load(simd));
        let (c_x, c_y) = (c[0].load(simd), c[1].load(simd));
        let of_a = a_x.abs().max(a_y.abs());
        let of_b = b_x.abs().max(b_y.abs());
        let of_c = c_x.abs().max(c_y.abs());
        let error = f32x8::splat(simd, self.error);
        let reach = of_a.max(of_b).max(of_c) + error;
        let eight = f32x8::splat(simd, 8.0);
        let bound =
            reach * (reach * f32x8::splat(simd, 16.0 * U) + error * eight) + f32x8::splat(simd, f32::MIN_POSITIVE);
        let turns = [a_x * b_y - a_y * b_x, b_x * c_y - b_y * c_x, c_x * a_y - c_y * a_x];
        let least = turns[0].min(turns[1]).min(turns[2]);
        let most = turns[0].max(turns[1]).max(turns[2]);
        (least.simd_lt(-bound) & most.simd_gt(bound)).to_bitmask() as u8
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Affine3A, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::bounds::{WorldFromModel, levels, with_simd};
    use crate::exact::ray_meets_triangle;
    use crate::model::{Influences, MorphModel};
    use crate::pose::Pose;
    use crate::query::Body;
    use crate::tree::{BuildOptions, MorphBvh};

    /// Random triangles in a cube of a given size, with a target that moves them a little.
    fn soup(rng: &mut Pcg64Mcg, size: f32, is_skinned: bool) -> Pose {
        let mut points = |reach: f32| -> Vec<Vec3> {
            let point = |_| Vec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)));
            (0..60).map(point).collect()
        };
        let (base, target) = (points(size), points(0.1 * size));
        let triangles: Vec<[u32; 3]> = (0..50).map(|i| [i, (i + 7) % 60, (i * 3 + 1) % 60]).collect();
        let model = if is_skinned {
            let influences = Influences {
                joints: &[[0, 1, 0, 0]; 60],
                weights: &[[0.25, 0.75, 0.0, 0.0]; 60],
            };
            MorphModel::skinned(&base, &triangles, &[target], 2, &[influences])
        } else {
            MorphModel::from_displacements(&base, &triangles, &[target])
        };
        let mut pose = Pose::new(Arc::new(MorphBvh::build(
            Arc::new(model.unwrap()),
            &BuildOptions::default(),
        )));
        pose.set_weights(&[0.7]).unwrap();
        pose
    }

    #[test]
    fn no_triangle_that_a_ray_meets_is_left_out_and_most_others_are() {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        let (mut met, mut left_out, mut kept) = (0, 0, 0);
        for case in 0..300 {
            let size = [1.0, 1e-6, 1e6, 1e-30, 1e30][case % 5];
            let mut pose = soup(&mut rng, size, case % 2 == 1);
            let far = [0.0, 1e4 * size, (1e12 * size).min(1e37)][case % 3];
            let turn = Affine3A::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), case as f32);
            let place = Affine3A::from_translation(Vec3::new(far, -far, 0.5 * far)) * turn;
            let place = WorldFromModel::new(place).unwrap();
            let mut body = Body::new(&mut pose, &place);
            let middle = place.translation();
            let tree = &mut body.posed();
            for ray in 0..40 {
                let mut share = |reach: f64| rng.random_range(-reach..reach);
                let origin = middle + f64::from(size) * DVec3::new(share(3.0), share(3.0), share(3.0));
                let [a, b, c] = tree.world_triangle(ray);
                // Aim at a corner, at an edge, into the triangle, or beside it.
                let target = match ray % 4 {
                    0 => a,
                    1 => a.lerp(b, 0.3),
                    2 => a.lerp(b, 0.4).lerp(c, 0.4),
                    _ => a + f64::from(size) * DVec3::new(share(1.0), share(1.0), share(1.0)),
                };
                let along = target - origin;
                let line = Line {
                    origin,
                    direction: along / along.abs().max_element(),
                    max_t: f64::INFINITY,
                };
                let projection = RayProjection::new(&line, &tree.placed_body().placed);
                for leaf in (0..tree.topology.leaf_count()).map(Leaf) {
                    for patch in 0..tree.topology.patches(leaf).len() {
                        for &level in levels() {
                            let mut points = Vec::new();
                            if patch > 0 {
                                with_simd!(level, simd => projection.candidates(simd, tree, leaf, 0, &mut points));
                            }
                            let candidates =
                                with_simd!(level, simd => projection.candidates(simd, tree, leaf, patch, &mut points));
                            let numbers = tree
                                .topology
                                .leaf_triangles(leaf)
                                .chunks(LANES)
                                .nth(patch)
                                .unwrap()
                                .to_vec();
                            assert_eq!(u32::from(candidates) >> numbers.len(), 0);
                            for (lane, number) in numbers.into_iter().enumerate() {
                                let is_met = ray_meets_triangle(&line, &tree.world_triangle(number)).is_some();
                                let is_candidate = candidates >> lane & 1 == 1;
                                assert!(is_candidate || !is_met, "case {case}, ray {ray}, triangle {number}");
                                met += u32::from(is_met);
                                // Very far away, triangles are no larger than the rounding errors of their positions.
                                let is_sharp = case % 3 != 2;
                                left_out += u32::from(is_sharp && !is_candidate);
                                kept += u32::from(is_sharp && is_candidate && !is_met);
                            }
                        }
                    }
                }
            }
        }
        // The kept triangles are behind the origin, or next to a corner or edge that a ray passes through.
        assert!(met > 50_000 && left_out > 10 * kept, "{met} {left_out} {kept}");
    }
}
