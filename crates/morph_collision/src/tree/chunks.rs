//! The chunks of a skinned mesh's tree: subtrees whose vertices are posed together when a query first looks into one of them.
//!
//! Inside a chunk, boxes are fitted to posed vertices, so they are tight and need no tables. Only the few groups above the chunks have
//! boxes that are computed without vertices (`outer_tables`).

use std::ops::Range;

use super::budget::Budget;
use super::topology::{Child, ChildKind, Leaf, Topology};
use crate::model::BLOCK;

/// A chunk is a largest subtree with at most this many triangles, or a single leaf. Chosen by instruction counts (docs/tried.md).
pub(super) const MAX_TRIANGLES: usize = 128;

/// A subtree that is posed as a whole. It may be a single leaf.
#[derive(Clone, Debug)]
pub(crate) struct Chunk {
    /// Its groups; none if it is a leaf.
    groups: Range<u32>,
    /// The blocks of vertices that its triangles use, as entries of [`Chunks::blocks`].
    blocks: Range<u32>,
}

impl Chunk {
    #[inline]
    pub(crate) fn groups(&self) -> Range<usize> {
        self.groups.start as usize..self.groups.end as usize
    }
}

/// Where the boxes of a group's children come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// They are in the chunk with this index.
    Chunk(usize),
    /// The group is above the chunks. The index counts such groups in preorder.
    Outer(usize),
}

/// The chunks in preorder.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chunks {
    chunks: Vec<Chunk>,
    /// The numbers of blocks of vertices, chunk by chunk.
    blocks: Vec<u32>,
    /// The chunk of each leaf.
    of_leaves: Vec<u32>,
    /// The chunk of each group, or the number of a group above the chunks, with [`OUTER`] set.
    of_groups: Vec<u32>,
}

/// Marks the number of a group above the chunks.
const OUTER: u32 = 1 << 31;

impl Chunks {
    pub(super) async fn new(topology: &Topology, budget: &Budget) -> Self {
        let mut chunks = Self {
            of_leaves: vec![0; topology.leaf_count()],
            of_groups: vec![0; topology.group_count()],
            ..Self::default()
        };
        // Group 0 holds the root and is above everything.
        let mut outer = 0;
        let mut rest = vec![Child::group(0)];
        while let Some(node) = rest.pop() {
            match node.kind() {
                ChildKind::Group(group) if group == 0 || topology.triangles_below(node).len() > MAX_TRIANGLES => {
                    chunks.of_groups[group] = outer | OUTER;
                    outer += 1;
                    rest.extend(topology.group(group).children().iter().rev());
                }
                _ => {
                    budget.spend(topology.triangles_below(node).len()).await;
                    chunks.push(topology, node);
                }
            }
        }
        chunks.chunks.shrink_to_fit();
        chunks.blocks.shrink_to_fit();
        chunks
    }

    /// Adds the subtree of a node.
    fn push(&mut self, topology: &Topology, node: Child) {
        let chunk = self.chunks.len() as u32;
        let [first, last] = topology.leaves_below(node);
        self.of_leaves[first.0..=last.0].fill(chunk);
        let mut groups = 0..0;
        if let ChildKind::Group(group) = node.kind() {
            groups = group as u32..topology.groups_below(group).end as u32;
            self.of_groups[group..groups.end as usize].fill(chunk);
        }
        let leaves = (first.0..=last.0).flat_map(|leaf| topology.leaf_vertices(Leaf(leaf)));
        let mut blocks: Vec<u32> = leaves.map(|vertex| vertex / BLOCK as u32).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let start = self.blocks.len() as u32;
        self.blocks.extend(blocks);
        let blocks = start..self.blocks.len() as u32;
        self.chunks.push(Chunk { groups, blocks });
    }

    pub(crate) fn len(&self) -> usize {
        self.chunks.len()
    }

    #[inline]
    pub(crate) fn chunk(&self, chunk: usize) -> &Chunk {
        &self.chunks[chunk]
    }

    /// The numbers of the blocks of vertices that the triangles of a chunk use, ascending.
    #[inline]
    pub(crate) fn blocks(&self, chunk: usize) -> &[u32] {
        let Range { start, end } = self.chunks[chunk].blocks;
        &self.blocks[start as usize..end as usize]
    }

    #[inline]
    pub(crate) fn of_leaf(&self, leaf: Leaf) -> usize {
        self.of_leaves[leaf.0] as usize
    }

    #[inline]
    pub(crate) fn source(&self, group: usize) -> Source {
        match self.of_groups[group] {
            of if of & OUTER == 0 => Source::Chunk(of as usize),
            of => Source::Outer((of & !OUTER) as usize),
        }
    }

    /// Whether a node has a group above the chunks.
    pub(crate) fn is_outer(&self, node: Child) -> bool {
        matches!(node.kind(), ChildKind::Group(group) if matches!(self.source(group), Source::Outer(_)))
    }

    /// The groups above the chunks, in preorder.
    pub(crate) fn outer_groups(&self) -> impl DoubleEndedIterator<Item = usize> {
        let of_groups = self.of_groups.iter().enumerate();
        of_groups.filter_map(|(group, of)| (of & OUTER != 0).then_some(group))
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.chunks)
            + size_of_val(&*self.blocks)
            + size_of_val(&*self.of_leaves)
            + size_of_val(&*self.of_groups)
    }
}
