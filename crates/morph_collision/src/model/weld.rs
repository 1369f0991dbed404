//! Welding: vertices with equal positions, displacements and influences move together in all poses, so only one is kept.

use std::hash::{DefaultHasher, Hasher};

use glam::Vec3;

use super::numbering::Numbering;
use super::skin::SlotInfluences;
use super::targets::TargetDisplacements;

/// The vertices that are kept.
pub(super) struct Welded {
    /// The welded vertex of each vertex, numbered by first appearance.
    pub(super) from_source: Vec<u32>,
    /// The first vertex of each welded vertex, ascending.
    pub(super) firsts: Vec<u32>,
    /// The number of displacements of all welded vertices.
    pub(super) displacements: usize,
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
        displacements: 0,
    };
    let mut numbering = Numbering::new(base.len());
    for (vertex, &position) in base.iter().enumerate() {
        let mut hasher = numbering.hasher();
        hash_vector(position, &mut hasher);
        let mut displacements = 0;
        for (target, of_target) in targets.iter().enumerate() {
            let displacement = of_target.of(vertex);
            if displacement != Vec3::ZERO {
                hasher.write_u32(target as u32);
                hash_vector(displacement, &mut hasher);
                displacements += 1;
            }
        }
        let slots = |vertex| influences.into_iter().flat_map(move |influences| influences.of(vertex));
        for influence in slots(vertex) {
            hasher.write_u64(u64::from(influence.joint) << 32 | u64::from(influence.weight.to_bits()));
        }
        let (number, is_new) = numbering.number(&hasher, |number| {
            let other = welded.firsts[number as usize] as usize;
            // Coordinates are finite, so equality is reflexive.
            base[other] == position
                && targets.iter().all(|target| target.of(other) == target.of(vertex))
                && slots(other).eq(slots(vertex))
        });
        if is_new {
            welded.firsts.push(vertex as u32);
            welded.displacements += displacements;
        }
        welded.from_source.push(number);
    }
    welded.firsts.shrink_to_fit();
    welded
}

/// Hashes -0 like 0, because they are equal.
fn hash_vector(v: Vec3, hasher: &mut DefaultHasher) {
    let [x, y, z] = (v + Vec3::ZERO).to_array().map(f32::to_bits);
    hasher.write_u64(u64::from(x) << 32 | u64::from(y));
    hasher.write_u32(z);
}
