//! The parts of a mesh that push by themselves.

use std::sync::{Arc, Weak};

use bevy::prelude::Resource;
use morph_collision::MorphBvh;

/// How many triangles of a surface move as one rigid body at most: few, so that they nearly do; not so few that a body that rests
/// on a fine mesh touches dozens of patches.
const PATCH_TRIANGLES: usize = 16;

/// A mesh cut into patches; shared by all that show it.
pub(super) struct Patches {
    /// Triangle numbers, ascending within a patch.
    numbers: Vec<u32>,
    /// Those of patch `i` stand at `starts[i]..starts[i + 1]`.
    starts: Vec<u32>,
    of_triangle: Vec<u32>,
}

impl Patches {
    fn of(bvh: &MorphBvh) -> Self {
        let mut numbers = Vec::with_capacity(bvh.model().triangle_count());
        let mut starts = vec![0];
        let mut of_triangle = vec![0; bvh.model().triangle_count()];
        for (patch, part) in bvh.subtrees(PATCH_TRIANGLES).into_iter().enumerate() {
            let start = numbers.len();
            numbers.extend_from_slice(part);
            numbers[start..].sort_unstable();
            starts.push(numbers.len() as u32);
            for &triangle in part {
                of_triangle[triangle as usize] = patch as u32;
            }
        }
        Self {
            numbers,
            starts,
            of_triangle,
        }
    }

    pub(super) fn patch_of(&self, triangle: u32) -> u32 {
        self.of_triangle[triangle as usize]
    }

    pub(super) fn triangles(&self, patch: u32) -> &[u32] {
        let patch = patch as usize;
        &self.numbers[self.starts[patch] as usize..self.starts[patch + 1] as usize]
    }
}

/// The patches of every tree that is in use.
#[derive(Resource, Default)]
pub(super) struct AllPatches(Vec<(Weak<MorphBvh>, Weak<Patches>)>);

impl AllPatches {
    pub(super) fn of(&mut self, bvh: &Arc<MorphBvh>) -> Arc<Patches> {
        self.0.retain(|(_, patches)| patches.strong_count() > 0);
        let known = self.0.iter().find(|(of, _)| of.as_ptr() == Arc::as_ptr(bvh));
        if let Some(patches) = known.and_then(|(_, patches)| patches.upgrade()) {
            return patches;
        }
        let patches = Arc::new(Patches::of(bvh));
        self.0.push((Arc::downgrade(bvh), Arc::downgrade(&patches)));
        patches
    }
}
