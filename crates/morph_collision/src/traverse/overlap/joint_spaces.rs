//! Compares boxes of skinned bodies in the spaces of the joints in which they were blended.
//!
//! A box that was mapped from a joint's space to the frames of two bodies is larger there, unless the joint's axes happen to be
//! parallel to theirs. Compared in the spaces of both joints, each box is as tight as it was blended. Such a test costs more, so only
//! boxes that overlap in the frames of the bodies get it.

use fearless_simd::Simd;

use super::mapped_group::{MappedGroup, OwnBox};
use super::trees::Trees;
use crate::bounds::BoxLanes;
use crate::pose::BoxTree;
use crate::traverse::mapping::Mapping;
use crate::tree::BODY_FRAME;

/// The number of pairs of spaces whose maps are kept. If two pairs have the same entry, the later one replaces the other.
const KEPT: usize = 256;

/// The maps between the spaces of two bodies' joints. The next query reuses the memory.
#[derive(Debug, Default)]
pub(super) struct JointSpaces {
    /// Empty until a skinned body is met.
    maps: Vec<Maps>,
    /// Counts the queries.
    query: u32,
    /// Boxes of B in the space of A's boxes, and the slots of both.
    mapped: BoxLanes,
    slots: Option<[usize; 2]>,
}

/// The maps between a space of A and a space of B.
#[derive(Clone, Debug, Default)]
struct Maps {
    query: u32,
    spaces: [usize; 2],
    b_from_a: Mapping,
    a_from_b: Mapping,
}

impl JointSpaces {
    /// Starts a query: discards everything.
    pub(super) fn begin(&mut self) {
        self.slots = None;
        self.query = self.query.wrapping_add(1);
        if self.query == 0 {
            self.maps.clear();
            self.query = 1;
        }
    }

    /// Those of A's children in `mask` whose boxes overlap B's box in the space of A's boxes. The space of B's boxes is left out unless
    /// `is_leaf`, because otherwise the children of B's node are compared there next.
    #[inline(always)]
    pub(super) fn of_a<S: Simd, T: BoxTree>(
        &mut self,
        simd: S,
        trees: &mut Trees<'_, T>,
        a: &MappedGroup,
        b: OwnBox,
        is_leaf: bool,
        mut mask: u8,
    ) -> u8 {
        if [a.space, b.space] == [BODY_FRAME; 2] {
            return mask;
        }
        let maps = self.maps(trees, [a.space, b.space]);
        if a.space != BODY_FRAME {
            mask &= a.in_space.overlap_mask(simd, &maps.a_from_b.one(&b.bounds));
        }
        if mask != 0 && is_leaf && b.space != BODY_FRAME {
            let mut mapped = BoxLanes::default();
            maps.b_from_a.all(simd, &a.in_space, &mut mapped);
            mask &= mapped.overlap_mask(simd, &b.bounds);
        }
        mask
    }

    /// Those of B's children in `mask` whose boxes overlap A's box in the spaces of both. `slots` are those of A's box and of B's children.
    #[inline(always)]
    pub(super) fn of_b<S: Simd, T: BoxTree>(
        &mut self,
        simd: S,
        trees: &mut Trees<'_, T>,
        a: OwnBox,
        b: &MappedGroup,
        slots: [usize; 2],
        mut mask: u8,
    ) -> u8 {
        if [a.space, b.space] == [BODY_FRAME; 2] {
            return mask;
        }
        if b.space != BODY_FRAME {
            let maps = self.maps(trees, [a.space, b.space]);
            mask &= b.in_space.overlap_mask(simd, &maps.b_from_a.one(&a.bounds));
        }
        if mask != 0 && a.space != BODY_FRAME {
            let slots = Some(slots);
            if self.slots != slots {
                let mut mapped = BoxLanes::default();
                self.maps(trees, [a.space, b.space])
                    .a_from_b
                    .all(simd, &b.in_space, &mut mapped);
                (self.mapped, self.slots) = (mapped, slots);
            }
            mask &= self.mapped.overlap_mask(simd, &a.bounds);
        }
        mask
    }

    #[inline(always)]
    fn maps<T: BoxTree>(&mut self, trees: &mut Trees<'_, T>, spaces: [usize; 2]) -> &Maps {
        let entry = (spaces[0] * 31 + spaces[1]) % KEPT;
        let is_current = |maps: &Maps| maps.query == self.query && maps.spaces == spaces;
        if !self.maps.get(entry).is_some_and(is_current) {
            self.compute(trees.a, trees.b, spaces, entry);
        }
        &self.maps[entry]
    }

    #[inline(never)]
    fn compute<T: BoxTree>(&mut self, a: &mut T, b: &mut T, spaces: [usize; 2], entry: usize) {
        if self.maps.is_empty() {
            self.maps.resize(KEPT, Maps::default());
        }
        let (a, b) = (a.placed_space(spaces[0]), b.placed_space(spaces[1]));
        let maps = &mut self.maps[entry];
        (maps.query, maps.spaces) = (self.query, spaces);
        for (mapping, frame) in [
            (&mut maps.b_from_a, b.frame_from(&a)),
            (&mut maps.a_from_b, a.frame_from(&b)),
        ] {
            match frame {
                Some(frame) => mapping.set(Some(&frame)),
                None => mapping.set_unbounded(),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_4;
    use std::sync::Arc;

    use glam::{Affine3A, Vec3};

    use crate::{Body, BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, PairQuery, Pose, WorldFromModel};

    /// A stack of plates below, which decides the body's frame, and a thin strip along x. One joint moves the plates, ten move the strip.
    fn plates_and_strip() -> Pose {
        let plate = |i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| 16.0 * corner - (20.0 + 0.01 * i as f32) * Vec3::Z);
        let strip = (0..=64).flat_map(|i| [0.0, 0.01].map(|y| Vec3::new(i as f32 / 4.0, y, 0.0)));
        let positions: Vec<_> = (0..300).flat_map(plate).chain(strip).collect();
        let triangles: Vec<_> = (0..300)
            .map(|i| 3 * i)
            .chain(900..900 + 128)
            .map(|i| [i, i + 1, i + 2])
            .collect();
        let of = |vertex| match vertex {
            0..900 => ([0; 4], [1.0, 0.0, 0.0, 0.0]),
            _ => ([1, 2, 3 + vertex as u16 % 8, 0], [0.375, 0.3125, 0.3125, 0.0]),
        };
        let (joints, weights): (Vec<_>, Vec<_>) = (0..positions.len()).map(of).unzip();
        let influences = Influences {
            joints: &joints,
            weights: &weights,
        };
        let no_targets: [Vec<Vec3>; 0] = [];
        let model = MorphModel::skinned(&positions, &triangles, &no_targets, 11, &[influences]).unwrap();
        Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())))
    }

    /// The pairs of triangles tested and those found, for two strips that are turned by these angles. The second is moved along y, and its
    /// plates away. `refitted` bodies have no boxes in the spaces of joints.
    fn tested_and_found(mut poses: [Pose; 2], angles: [f32; 2], along_y: f32, refitted: bool) -> (u64, usize) {
        for ((pose, angle), [y, z]) in poses.iter_mut().zip(angles).zip([[0.0; 2], [along_y, 1000.0]]) {
            let strip = Affine3A::from_translation(Vec3::Y * y) * Affine3A::from_rotation_z(angle);
            let plates = Affine3A::from_translation(Vec3::Z * z);
            let mut joints = [strip; 11];
            joints[0] = plates;
            pose.set_joints(&JointMatrices::new(&joints).unwrap()).unwrap();
            if refitted {
                pose.refit();
            }
        }
        let [a, b] = &mut poses;
        let place = WorldFromModel::IDENTITY;
        let (mut query, mut pairs) = (PairQuery::default(), Vec::new());
        query.all(Body::new(a, &place), Body::new(b, &place), &mut pairs);
        (query.stats().triangle_tests, pairs.len())
    }

    fn two_strips() -> [Pose; 2] {
        [0; 2].map(|_| plates_and_strip())
    }

    #[test]
    fn slanted_boxes_side_by_side_are_told_apart() {
        for (angle, distance) in [(FRAC_PI_4, 0.5), (-FRAC_PI_4, -0.5)] {
            // The distance of the strips is less than the length of a leaf.
            let (in_body_frames, _) = tested_and_found(two_strips(), [angle; 2], distance, true);
            assert!(in_body_frames >= 64, "{in_body_frames}");
            assert_eq!(tested_and_found(two_strips(), [angle; 2], distance, false), (0, 0));
        }
    }

    #[test]
    fn slanted_boxes_that_touch_are_not() {
        for (angles, along_y, least) in [
            ([FRAC_PI_4, 0.1], 1.0, 1),
            ([0.1, -0.5], 1.0, 1),
            ([FRAC_PI_4; 2], 0.01, 64),
        ] {
            let (_, found) = tested_and_found(two_strips(), angles, along_y, false);
            let (_, expected) = tested_and_found(two_strips(), angles, along_y, true);
            assert_eq!(found, expected, "{angles:?}");
            assert!(found >= least, "{angles:?}: {found}");
        }
    }
}
