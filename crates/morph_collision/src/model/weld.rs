//! Welding: vertices with equal positions, displacements and influences move together in all poses, so only one is kept.

use std::collections::HashMap;
use std::hash::{Hash, Hasher};

use glam::Vec3;

use super::Displacement;
use super::skin::Influence;

/// Everything that determines where a vertex can be. Vertices with equal keys have equal positions in all poses.
#[derive(PartialEq)]
struct Key<'a> {
    base: Vec3,
    displacements: &'a [Displacement],
    influences: &'a [Influence],
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
        for influence in self.influences {
            (influence.joint, influence.weight.to_bits()).hash(state);
        }
    }
}

/// Hashes -0 like 0, because they are equal.
fn hash_vector<H: Hasher>(v: Vec3, state: &mut H) {
    (v + Vec3::ZERO).to_array().map(f32::to_bits).hash(state);
}

/// Returns the welded vertex of each vertex, numbered by first appearance, and the first vertex of each welded vertex. `influences`
/// is empty for a mesh without joints.
pub(super) fn weld(
    base: &[Vec3],
    displacements: &[Vec<Displacement>],
    influences: &[Vec<Influence>],
) -> (Vec<u32>, Vec<usize>) {
    let mut welded_of = HashMap::with_capacity(base.len());
    let mut firsts = Vec::new();
    let keys = base.iter().zip(displacements).enumerate();
    let keys = keys.map(|(vertex, (&base, displacements))| Key {
        base,
        displacements,
        influences: influences.get(vertex).map_or(&[], Vec::as_slice),
    });
    let welded_from_source = keys
        .enumerate()
        .map(|(vertex, key)| {
            *welded_of.entry(key).or_insert_with(|| {
                firsts.push(vertex);
                firsts.len() as u32 - 1
            })
        })
        .collect();
    (welded_from_source, firsts)
}
