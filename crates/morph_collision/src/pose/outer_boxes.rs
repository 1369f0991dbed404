//! Boxes of the nodes above the chunks of a skinned mesh's tree, from one box per child and joint. No vertex is posed for them.

use fearless_simd::prelude::*;
use fearless_simd::f64x4;
use glam::{DVec3, Vec3};

use super::blend::blend_group;
use super::skin_tree::{MAX_REACH, SkinTree};
use crate::bounds::{Aabb, BoxLanes, LANES, with_simd};
use crate::joints::JointMatrices;
use crate::tree::OuterTables;

/// The boxes of the parts before joints move them, blended for a pose's weights.
#[derive(Clone, Debug, Default)]
pub(super) struct OuterBoxes {
    /// By group above the chunks.
    groups: Vec<OuterParts>,
}

/// The boxes of the parts of a group's children.
#[derive(Clone, Debug, Default)]
struct OuterParts {
    /// Centres and half sizes, in the order of children and parts.
    parts: Vec<[[f64; 4]; 2]>,
    /// A bound on their coordinates.
    reach: f32,
    /// Whether they are valid for the current weights.
    is_current: bool,
}

impl OuterBoxes {
    pub(super) fn new(tables: &OuterTables) -> Self {
        Self {
            groups: vec![OuterParts::default(); tables.group_count()],
        }
    }

    /// Discards everything, because the weights have changed.
    pub(super) fn invalidate(&mut self) {
        self.groups.iter_mut().for_each(|group| group.is_current = false);
    }

    /// Sets `boxes` to boxes around the children of a group above the chunks, relative to `origin`. They contain every exact vertex.
    pub(super) fn compute(
        &mut self,
        tree: SkinTree<'_>,
        outer: usize,
        joints: &JointMatrices,
        origin: DVec3,
        boxes: &mut BoxLanes,
    ) {
        let group = &mut self.groups[outer];
        if !group.is_current {
            group.blend(tree, outer);
        }
        with_simd!(tree.level, simd => group.bound(simd, tree, outer, joints, origin, boxes));
    }

    pub(super) fn bytes(&self) -> usize {
        let parts: usize = self.groups.iter().map(|group| group.parts.capacity()).sum();
        size_of_val(&*self.groups) + parts * size_of::<[[f64; 4]; 2]>()
    }
}

impl OuterParts {
    fn blend(&mut self, tree: SkinTree<'_>, outer: usize) {
        self.is_current = true;
        self.reach = 0.0;
        self.parts.clear();
        let mut boxes = BoxLanes::default();
        for tables in tree.skin.outer.blocks(outer) {
            let reach = with_simd!(tree.level, simd => blend_group(simd, tables, tree.weights, &mut boxes));
            self.reach = self.reach.max(reach);
            for lane in 0..tables.width {
                let Aabb { min, max } = boxes.get(lane);
                let (min, max) = (min.as_dvec3(), max.as_dvec3());
                let padded = |v: DVec3| [v.x, v.y, v.z, 0.0];
                self.parts.push([padded(0.5 * (min + max)), padded(0.5 * (max - min))]);
            }
        }
    }

    /// Derived in docs/numerics.md, "Boxes under joints".
    #[inline(always)]
    fn bound<S: Simd>(
        &self,
        simd: S,
        tree: SkinTree<'_>,
        outer: usize,
        joints: &JointMatrices,
        origin: DVec3,
        boxes: &mut BoxLanes,
    ) {
        let zero = f64x4::splat(simd, 0.0);
        let world = f64x4::from_slice(simd, &[origin.x, origin.y, origin.z, 0.0]);
        let far = origin.abs().max_element();
        let reach = joints.world_reach(f64::from(self.reach)) + far;
        let mut parts = self.parts.iter();
        for (lane, child) in tree.skin.outer.group(outer).children.iter().enumerate() {
            // The lower ends, and the negated upper ends. The extra joint takes every point to the world's origin.
            let mut ends = [zero - world, world];
            for (index, (part, [center, half])) in child.parts.iter().zip(&mut parts).enumerate() {
                let matrix = joints.padded(part.joint);
                let (mut middle, mut radius) = (f64x4::from_slice(simd, &matrix[3]) - world, zero);
                for axis in 0..3 {
                    let column = f64x4::from_slice(simd, &matrix[axis]);
                    middle += column * f64x4::splat(simd, center[axis]);
                    radius += column.abs() * f64x4::splat(simd, half[axis]);
                }
                let image = [middle - radius, zero - middle - radius];
                for (end, image) in ends.iter_mut().zip(image) {
                    *end = if index == 0 {
                        image
                    } else {
                        *end + (image - *end).min(zero) * f64x4::splat(simd, f64::from(part.share))
                    };
                }
            }
            let [least, most] = child.missing.map(f64::from);
            let largest = least.abs().max(most.abs());
            let mut reach = reach;
            if largest > 0.0 {
                for (end, origin) in ends.iter_mut().zip([zero - world, world]) {
                    let from_origin = *end - origin;
                    let (least, most) = (f64x4::splat(simd, least), f64x4::splat(simd, most));
                    *end -= (from_origin * least).max(from_origin * most);
                }
                reach += largest * (reach + far);
            }
            let roundings = 20.0 + 8.0 * child.parts.len() as f64;
            let by = roundings * f64::EPSILON * reach + f64::from(f32::MIN_POSITIVE);
            // False for NaN.
            if reach + by <= f64::from(MAX_REACH) {
                // Narrowing rounds by at most half of this share.
                let share = f64x4::splat(simd, f64::from(f32::EPSILON));
                let [low, high] = ends.map(|end| end - end.abs() * share - f64x4::splat(simd, by));
                let mut packed = [0.0; LANES];
                low.narrow(high).store_slice(&mut packed);
                let [a, b, c, _, d, e, f, _] = packed;
                boxes.set(
                    lane,
                    &Aabb {
                        min: Vec3::new(a, b, c),
                        max: Vec3::new(-d, -e, -f),
                    },
                );
            } else {
                boxes.set(lane, &Aabb::UNBOUNDED);
            }
        }
    }
}
