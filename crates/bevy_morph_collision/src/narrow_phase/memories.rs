//! What is remembered of pairs from one run to the next.

use morph_collision::{PairMemory, Remember};

use super::touch::wants_all;
use super::{Asked, Pair};
use crate::collider::CollisionMode;

/// Whether something is remembered of a pair: always where one pair of triangles is asked for.
pub(super) fn has_memory(mode: CollisionMode, remember: Remember) -> bool {
    remember.separation || !wants_all(mode)
}

/// Makes `memories` those of the pairs that have one, in their order: the ones there are, and new ones. Both are sorted.
pub(super) fn keep_memories(
    asked: &[Asked],
    remember: Remember,
    memories: &mut Vec<(Pair, PairMemory)>,
    next: &mut Vec<(Pair, PairMemory)>,
) {
    let mut known = memories.drain(..).peekable();
    next.clear();
    for &Asked { pair, .. } in asked.iter().filter(|asked| has_memory(asked.mode, remember)) {
        while known.next_if(|(other, _)| *other < pair).is_some() {}
        let memory = known.next_if(|(other, _)| *other == pair);
        next.push(memory.unwrap_or_else(|| (pair, PairMemory::new(remember))));
    }
    drop(known);
    std::mem::swap(memories, next);
}
