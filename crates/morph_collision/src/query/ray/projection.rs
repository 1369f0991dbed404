//! Triangles projected along a ray, eight side by side in `f32`.

use fearless_simd::f32x8;
use fearless_simd::prelude::*;

use crate::bounds::{Lanes, LocalRay};
use crate::exact::{power_of_two, power_of_two_below};
use crate::tree::CornerLanes;

/// A sheared projection along a ray to a coordinate plane, in which the ray's line is the origin.
///
/// Let `d` be the ray's direction in the space of the boxes, `k` its largest axis, and `q = p - origin` for a point `p`. The projection of
/// `p` has the coordinates `q_i - d_i / d_k q_k` for the two other axes `i`. The line passes through a triangle if the triangle's
/// projection contains the origin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RayProjection {
    /// `axes[2]` is the largest axis of the ray's direction.
    axes: [usize; 3],
    /// The origin, along these axes.
    origin: [f32; 3],
    /// A power of two that brings coordinates to a size around 1 or below.
    scale: f32,
    /// Times `scale`.
    shear: [f32; 2],
    /// A bound on the error of a projected coordinate before its last rounding. Infinite if nothing can be left out.
    error: f32,
}

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

impl RayProjection {
    /// `corner_error` bounds the error of corners along each axis. Without a ray in model space, no triangle is left out.
    pub(super) fn new(ray: Option<&LocalRay>, corner_error: f32) -> Self {
        let Some(ray) = ray.filter(|ray| ray.is_in_model) else {
            let error = f32::INFINITY;
            return Self {
                error,
                ..Self::default()
            };
        };
        let direction = ray.direction;
        let k = direction.abs().max_position();
        let axes = [(k + 1) % 3, (k + 2) % 3, k];
        let widest = ray.reach.max_element();
        // Clamped so that neither the scale nor its products overflow or underflow.
        let unit = power_of_two_below(widest).clamp(power_of_two(-100), power_of_two(100));
        let scale = unit.recip();
        let shear = |axis: usize| (scale * (direction[axes[axis]] / direction[k])) as f32;
        // A coordinate has the errors of two axes of the ray and of the corner, and less than eight roundings.
        let error = 2.0 * (ray.error.max_element() + f64::from(corner_error)) + 8.0 * f64::from(U) * widest;
        Self {
            axes,
            origin: axes.map(|axis| ray.origin[axis] as f32),
            scale: scale as f32,
            shear: [shear(0), shear(1)],
            error: (error * scale) as f32 * (1.0 + 4.0 * U) + f32::MIN_POSITIVE,
        }
    }

    /// A bit mask of the triangles that the ray's line might meet, given their corners in the space of the boxes.
    #[inline(always)]
    pub(super) fn candidates<S: Simd>(&self, simd: S, [a, b, c]: &CornerLanes) -> u8 {
        // Closures are not inlined here.
        let projected = [self.project(simd, a), self.project(simd, b), self.project(simd, c)];
        !self.misses(simd, projected)
    }

    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, corner: &[Lanes; 3]) -> [f32x8<S>; 2] {
        let [i, j, k] = self.axes;
        let scale = f32x8::splat(simd, self.scale);
        let along = corner[k].load(simd) - f32x8::splat(simd, self.origin[2]);
        let x = (corner[i].load(simd) - f32x8::splat(simd, self.origin[0])) * scale;
        let y = (corner[j].load(simd) - f32x8::splat(simd, self.origin[1])) * scale;
        [
            x - along * f32x8::splat(simd, self.shear[0]),
            y - along * f32x8::splat(simd, self.shear[1]),
        ]
    }

    /// A bit mask of the triangles that the line certainly misses: the origin is certainly left of one edge and right of another.
    ///
    /// Let `E` be the error of a coordinate before it is rounded to `f32`, and `R` the largest coordinate of a triangle. The error of a
    /// turn `x_1 y_2 - y_1 x_2` is at most `4 R E + 8 U R^2` plus underflow. If `R^2` overflows, nothing is certain.
    #[inline(always)]
    fn misses<S: Simd>(&self, simd: S, [[a_x, a_y], [b_x, b_y], [c_x, c_y]]: [[f32x8<S>; 2]; 3]) -> u8 {
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

    use glam::{Affine3A, DVec3, Vec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::bounds::{LANES, WorldFromModel, levels, with_simd};
    use crate::exact::{Line, ray_meets_triangle};
    use crate::model::{Influences, MorphModel};
    use crate::pose::Pose;
    use crate::query::Body;
    use crate::tree::{BuildOptions, Leaf, MorphBvh};

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
                let local = LocalRay::new(line.origin, line.direction, &tree.placed_body().placed);
                let projection = RayProjection::new(local.as_ref(), tree.corner_error());
                for leaf in (0..tree.topology.leaf_count()).map(Leaf) {
                    for patch in 0..tree.topology.patches(leaf).len() {
                        for &level in levels() {
                            let mut corners = CornerLanes::default();
                            let candidates = with_simd!(level, simd => {
                                tree.box_corners(simd, leaf, patch, &mut corners);
                                projection.candidates(simd, &corners)
                            });
                            let numbers = tree
                                .topology
                                .leaf_triangles(leaf)
                                .chunks(LANES)
                                .nth(patch)
                                .unwrap()
                                .to_vec();
                            for (lane, number) in numbers.into_iter().enumerate() {
                                let is_met =
                                    ray_meets_triangle(tree.level, &line, &tree.world_triangle(number)).is_some();
                                let is_candidate = candidates >> lane & 1 == 1;
                                let triangle = tree.patch_triangle(leaf, patch * LANES + lane, &corners);
                                assert_eq!(triangle, tree.world_triangle(number));
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
