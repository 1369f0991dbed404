//! Welding: vertices that agree in position and in every displacement move as one, whatever the weights.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};

use glam::Vec3;

use super::Displacement;

/// Everything that decides where a vertex can go; equal keys mean equal vertices for all weights.
#[derive(PartialEq)]
struct Key<'a> {
    base: Vec3,
    displacements: &'a [Displacement],
}

// Coordinates are finite, so equality is reflexive.
impl Eq for Key<'_> {}

impl Hash for Key<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        hash_vector(self.base, state);
        for displacement in self.displacements {
            displacement.target.hash(state);
            hash_vector(displacement.delta, state);
        }
    }
}

/// -0 and 0 are equal, so they must hash alike.
fn hash_vector<H: Hasher>(v: Vec3, state: &mut H) {
    (v + Vec3::ZERO).to_array().map(f32::to_bits).hash(state);
}

/// For each vertex the index of its welded vertex, numbered in the order of first appearance, and the first vertex of each.
pub(super) fn weld<'a>(base: &[Vec3], displacements: impl Fn(usize) -> &'a [Displacement]) -> (Vec<u32>, Vec<usize>) {
    let mut welded_of = HashMap::with_capacity(base.len());
    let mut firsts = Vec::new();
    let welded_from_source = base
        .iter()
        .enumerate()
        .map(|(vertex, &base)| {
            let displacements = displacements(vertex);
            *welded_of.entry(Key { base, displacements }).or_insert_with(|| {
                firsts.push(vertex);
                firsts.len() as u32 - 1
            })
        })
        .collect();
    (welded_from_source, firsts)
}
