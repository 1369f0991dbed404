//! The displacements of a model's vertices, in blocks.

use std::hash::{BuildHasher, RandomState};
use std::ops::Range;

use glam::Vec3;
use hashbrown::HashTable;
use hashbrown::hash_table::Entry;

use super::blocks::{BLOCK, BlockVectors, block_and_lane};
use super::targets::TargetDisplacements;
use super::weights::Weights;

/// The displacement of one vertex by one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Displacement {
    pub(crate) target: u16,
    pub(crate) delta: Vec3,
}

/// The displacements of all vertices.
#[derive(Clone, Debug)]
pub(super) struct Displacements {
    /// By block.
    columns: Vec<Columns>,
    deltas: Vec<BlockVectors>,
    targets: Vec<u16>,
    /// By target: the root of the share of blocks that it moves.
    spreads: Vec<f32>,
}

/// The displacements of a block, one per target that moves any of its vertices, ascending by target.
#[derive(Clone, Copy, Debug)]
struct Columns {
    /// The number of targets.
    count: u32,
    /// Where they start in `targets`. Blocks with equal lists share one.
    targets: u32,
    /// Where the displacements start in `deltas`.
    deltas: u32,
}

impl Displacements {
    /// The displacements of some vertices of a mesh.
    pub(super) fn new<T: TargetDisplacements>(targets: &[T], vertices: &[u32]) -> Self {
        let blocks = || vertices.chunks(BLOCK);
        let mut columns = Vec::with_capacity(blocks().len());
        let (mut list, mut known, mut count) = (Vec::new(), Lists::default(), 0);
        let mut moved = vec![0_u32; targets.len()];
        for block in blocks() {
            let moves = |target: &T| block.iter().any(|&vertex| target.of(vertex as usize) != Vec3::ZERO);
            list.clear();
            list.extend((0..).zip(targets).filter(|(_, of)| moves(of)).map(|(target, _)| target));
            list.iter().for_each(|&target: &u16| moved[usize::from(target)] += 1);
            columns.push(Columns {
                count: list.len() as u32,
                targets: known.start_of(&list),
                deltas: count,
            });
            count += list.len() as u32;
        }
        known.targets.shrink_to_fit();
        // Counted before anything is stored, so that nothing is stored twice.
        let mut deltas = Vec::with_capacity(count as usize);
        for (block, columns) in blocks().zip(&columns) {
            for &target in &known.targets[columns.targets as usize..][..columns.count as usize] {
                let of = &targets[usize::from(target)];
                deltas.push(BlockVectors::new(block, |&vertex| of.of(vertex as usize)));
            }
        }
        Self {
            columns,
            deltas,
            targets: known.targets,
            spreads: moved
                .iter()
                .map(|&moved| (moved as f32 / blocks().len() as f32).sqrt())
                .collect(),
        }
    }

    /// The targets that move a block, ascending, and their displacements of it. A vertex that a target does not move has zeros.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> (&[u16], &[BlockVectors]) {
        let Columns { count, targets, deltas } = self.columns[block];
        let of = |start: u32| start as usize..start as usize + count as usize;
        (&self.targets[of(targets)], &self.deltas[of(deltas)])
    }

    /// The displacements of a vertex that are not zero, in ascending target order.
    pub(super) fn of_vertex(&self, vertex: u32) -> impl Iterator<Item = Displacement> {
        let (block, lane) = block_and_lane(vertex);
        let (targets, deltas) = self.of_block(block);
        let all = targets.iter().zip(deltas).map(move |(&target, deltas)| Displacement {
            target,
            delta: deltas.of(lane),
        });
        all.filter(|displacement| displacement.delta != Vec3::ZERO)
    }

    /// An estimate of how loose blended boxes are: the sum of the absolute weights, each times the root of the share of vertices that its
    /// target moves.
    pub(super) fn looseness(&self, weights: &Weights) -> f32 {
        let of_target = |&(target, weight): &(u32, f32)| weight.abs() * self.spreads[target as usize];
        weights.active().iter().map(of_target).sum()
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.columns)
            + size_of_val(&*self.deltas)
            + size_of_val(&*self.targets)
            + size_of_val(&*self.spreads)
    }
}

/// Lists of targets, each stored once.
#[derive(Default)]
struct Lists {
    targets: Vec<u16>,
    /// The ranges of the lists in `targets`.
    known: HashTable<Range<usize>>,
    random: RandomState,
}

impl Lists {
    /// The index in `targets` where a list starts.
    fn start_of(&mut self, list: &[u16]) -> u32 {
        let Self { targets, known, random } = self;
        let is_known = |range: &Range<usize>| targets[range.clone()] == *list;
        let hash = |range: &Range<usize>| random.hash_one(&targets[range.clone()]);
        match known.entry(random.hash_one(list), is_known, hash) {
            Entry::Occupied(range) => range.get().start as u32,
            Entry::Vacant(new) => {
                let start = targets.len();
                new.insert(start..start + list.len());
                targets.extend_from_slice(list);
                start as u32
            }
        }
    }
}
