//! Welding: vertices with equal positions, displacements and influences move together in all poses, so only one is kept.

use std::hash::{BuildHasher, Hasher, RandomState};

use glam::Vec3;
use hashbrown::HashTable;
use hashbrown::hash_table::Entry;

use super::influences::SlotInfluences;
use super::targets::TargetDisplacements;

/// The vertices that are kept.
pub(super) struct Welded {
    /// The welded vertex of each vertex, numbered by first appearance.
    pub(super) from_source: Vec<u32>,
    /// The first vertex of each welded vertex, ascending.
    pub(super) firsts: Vec<u32>,
}

/// Finds vertices that cannot be told apart in any pose.
pub(super) fn weld<T: TargetDisplacements>(
    base: &[Vec3],
    targets: &[T],
    influences: Option<&SlotInfluences<'_>>,
) -> Welded {
    let mut welded = Welded {
        from_source: Vec::with_capacity(base.len()),
        firsts: Vec::with_capacity(base.len()),
    };
    let slots = |vertex| influences.into_iter().flat_map(move |influences| influences.of(vertex));
    // Random, so that no mesh makes the search slow.
    let random = RandomState::new();
    let hash = |vertex: usize| {
        let mut hasher = random.build_hasher();
        hash_vector(base[vertex], &mut hasher);
        for (target, of_target) in targets.iter().enumerate() {
            let displacement = of_target.of(vertex);
            if displacement != Vec3::ZERO {
                hasher.write_u32(target as u32);
                hash_vector(displacement, &mut hasher);
            }
        }
        for influence in slots(vertex) {
            hasher.write_u64(u64::from(influence.joint) << 32 | u64::from(influence.weight.to_bits()));
        }
        hasher.finish()
    };
    // Coordinates are finite, so equality is reflexive.
    let is_same = |one: usize, other: usize| {
        base[one] == base[other]
            && targets.iter().all(|target| target.of(one) == target.of(other))
            && slots(one).eq(slots(other))
    };
    let mut known: HashTable<u32> = HashTable::with_capacity(base.len());
    for vertex in 0..base.len() {
        let is_known = |&first: &u32| is_same(first as usize, vertex);
        match known.entry(hash(vertex), is_known, |&first| hash(first as usize)) {
            Entry::Occupied(first) => welded.from_source.push(welded.from_source[*first.get() as usize]),
            Entry::Vacant(new) => {
                new.insert(vertex as u32);
                welded.from_source.push(welded.firsts.len() as u32);
                welded.firsts.push(vertex as u32);
            }
        }
    }
    welded.firsts.shrink_to_fit();
    welded
}

/// Hashes -0 like 0, because they are equal.
fn hash_vector(v: Vec3, hasher: &mut impl Hasher) {
    let [x, y, z] = (v + Vec3::ZERO).to_array().map(f32::to_bits);
    hasher.write_u64(u64::from(x) << 32 | u64::from(y));
    hasher.write_u32(z);
}
