//! The order in which the walk over two trees visits node pairs when it looks for one intersection.

use super::node::NodePair;
use crate::bounds::{LANES, lanes_of};

/// Sorts node pairs by their depth, so that the deepest is popped first. Reuses its memory.
#[derive(Debug, Default)]
pub(super) struct DepthSort {
    /// Depths, and the indices of their pairs.
    keys: Vec<u64>,
    pairs: Vec<NodePair>,
}

impl DepthSort {
    /// Starts a list.
    pub(super) fn clear(&mut self) {
        self.keys.clear();
    }

    /// Adds the depths of the next pairs: one for each lane in the mask.
    pub(super) fn add(&mut self, mask: u8, depths: &[f32; LANES]) {
        for lane in lanes_of(mask) {
            // Non-negative floats sort like their bits; adding 0 turns a negative zero into a positive one. The low half of the
            // key is the pair's index.
            let bits = (depths[lane % LANES].max(0.0) + 0.0).to_bits();
            self.keys.push(u64::from(bits) << 32 | self.keys.len() as u64);
        }
    }

    #[inline(never)]
    pub(super) fn sort(&mut self, pairs: &mut [NodePair]) {
        if let [first, second] = pairs {
            if self.keys[0] > self.keys[1] {
                std::mem::swap(first, second);
            }
            return;
        }
        self.keys.sort_unstable();
        self.pairs.clear();
        self.pairs.extend_from_slice(pairs);
        for (pair, key) in pairs.iter_mut().zip(&self.keys) {
            *pair = self.pairs[*key as u32 as usize];
        }
    }
}
