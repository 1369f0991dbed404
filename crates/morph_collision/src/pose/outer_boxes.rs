//! Boxes around the children of the root, from one box per child and joint. Queries need them before they know which children to blend.

use fearless_simd::prelude::*;
use fearless_simd::{Level, f32x8, f64x4};
use glam::Vec3;

use super::blend::blend_group;
use super::skin_blend::MAX_REACH;
use crate::bounds::{Aabb, BoxLanes, LANES, Lanes, MapFrame, with_simd};
use crate::joints::{Columns, JointMatrices};
use crate::model::Weights;
use crate::tree::RootChildren;

/// The lower ends of a box along x, y and z, and the negated upper ends, each with a fourth number that does not matter. A hull is a
/// minimum of such numbers.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
struct Packed([f32; LANES]);

/// How a joint moves points, as seen in the body's frame: the columns of its matrix and its translation, each followed by its negative.
type PackedMap = [Packed; 4];

/// A box around each child of the root, in the body's frame.
#[derive(Clone, Debug, Default)]
pub(super) struct OuterBoxes {
    /// The centres and half sizes of the parts before joints move them, valid for the current weights.
    parts: Vec<([f32; 4], [f32; 4])>,
    /// A bound on the coordinates of the parts.
    reach: f32,
    are_current: bool,
    maps: Vec<PackedMap>,
    /// The blended boxes of children that have been blended for this pose, and outer boxes of all others.
    pub(super) boxes: BoxLanes,
    /// The children that have outer boxes.
    pub(super) are_outer: u8,
}

impl OuterBoxes {
    /// Discards what depends on the weights, because they have changed.
    pub(super) fn invalidate(&mut self) {
        self.are_current = false;
    }

    /// Computes the boxes anew. `spread` is the largest coordinate of a joint's translation relative to the origin of `frame`.
    pub(super) fn compute(
        &mut self,
        level: Level,
        children: &RootChildren,
        weights: &Weights,
        joints: &JointMatrices,
        frame: &MapFrame,
        spread: f64,
    ) {
        with_simd!(level, simd => {
            self.blend(simd, children, weights);
            let reach = frame.norm() * (joints.linear_reach() * f64::from(self.reach) + spread);
            self.bound(simd, children, joints, frame, reach as f32);
        });
        self.are_outer = u8::MAX;
    }

    #[inline(always)]
    fn blend<S: Simd>(&mut self, simd: S, children: &RootChildren, weights: &Weights) {
        if self.are_current {
            return;
        }
        self.are_current = true;
        self.reach = 0.0;
        self.parts.clear();
        let half = f32x8::splat(simd, 0.5);
        let mut boxes = BoxLanes::default();
        for tables in children.blocks() {
            self.reach = self.reach.max(blend_group(simd, tables, weights, &mut boxes));
            for axis in 0..3 {
                let (low, high) = (boxes.min[axis].load(simd), boxes.max[axis].load(simd));
                ((low + high) * half).store_slice(&mut boxes.min[axis].0);
                ((high - low) * half).store_slice(&mut boxes.max[axis].0);
            }
            for lane in 0..LANES {
                let at = |[x, y, z]: &[Lanes; 3]| [x.0[lane], y.0[lane], z.0[lane], 0.0];
                self.parts.push((at(&boxes.min), at(&boxes.max)));
            }
        }
    }

    /// Derived in docs/numerics.md, "Boxes under joints".
    #[inline(always)]
    fn bound<S: Simd>(
        &mut self,
        simd: S,
        children: &RootChildren,
        joints: &JointMatrices,
        frame: &MapFrame,
        reach: f32,
    ) {
        self.maps.clear();
        for &joint in &children.joints {
            self.maps.push(packed_map(simd, frame, joints.padded(joint)));
        }
        // The extra joint takes every point here.
        let [.., origin] = packed_map(simd, frame, &Columns::default());
        let far = origin.0.iter().fold(0.0_f32, |far, of| far.max(of.abs()));
        let origin = f32x8::from_slice(simd, &origin.0);
        let mut parts = self.parts.iter();
        for (lane, child) in children.children.iter().enumerate() {
            let mut ends = origin;
            for (index, (part, (center, half))) in child.parts.iter().zip(&mut parts).enumerate() {
                let map = &self.maps[usize::from(part.joint)];
                let mut image = f32x8::from_slice(simd, &map[3].0);
                for axis in 0..3 {
                    let column = f32x8::from_slice(simd, &map[axis].0);
                    image += column * f32x8::splat(simd, center[axis]);
                    image -= column.abs() * f32x8::splat(simd, half[axis]);
                }
                ends = if index == 0 {
                    image
                } else {
                    ends + (image - ends).min(f32x8::splat(simd, 0.0)) * f32x8::splat(simd, part.share)
                };
            }
            let [least, most] = child.missing;
            let largest = least.abs().max(most.abs());
            let reach = if largest > 0.0 {
                let from_origin = ends - origin;
                let least = from_origin * f32x8::splat(simd, least);
                ends -= least.max(from_origin * f32x8::splat(simd, most));
                reach + largest * (reach + far)
            } else {
                reach
            };
            let roundings = 20.0 + 8.0 * child.parts.len() as f32;
            let by = roundings * U * reach + f32::MIN_POSITIVE;
            // False for NaN.
            if reach + by <= MAX_REACH {
                let mut of_child = Packed::default();
                (ends - f32x8::splat(simd, by)).store_slice(&mut of_child.0);
                self.boxes.set(lane, &of_child.unpacked());
            } else {
                self.boxes.set(lane, &Aabb::UNBOUNDED);
            }
        }
    }

    /// Replaces the box of a child with its blended box.
    pub(super) fn replace(&mut self, lane: usize, blended: &Aabb) {
        self.boxes.set(lane, blended);
        self.are_outer &= !(1 << lane);
    }

    pub(super) fn bytes(&self) -> usize {
        self.parts.capacity() * size_of::<([f32; 4], [f32; 4])>() + self.maps.capacity() * size_of::<PackedMap>()
    }
}

/// Half a unit in the last place of 1.
const U: f32 = f32::EPSILON / 2.0;

#[inline(always)]
fn packed_map<S: Simd>(simd: S, frame: &MapFrame, joint: &Columns) -> PackedMap {
    let zero = f64x4::splat(simd, 0.0);
    let columns = frame.joint(simd, joint);
    let mut map = PackedMap::default();
    for column in 0..4 {
        let of = columns[column];
        of.narrow(zero - of).store_slice(&mut map[column].0);
    }
    map
}

impl Packed {
    #[inline(always)]
    fn unpacked(&self) -> Aabb {
        let [a, b, c, _, d, e, f, _] = self.0;
        Aabb {
            min: Vec3::new(a, b, c),
            max: Vec3::new(-d, -e, -f),
        }
    }
}
