//! The influences of joints on a model's vertices, in blocks.

use super::blocks::{BLOCK, block_and_lane, repeated};
use super::influences::{Influence, SlotInfluences};

/// The weights of a joint for the vertices of a block; 0 for those that it does not move.
#[derive(Clone, Copy, Debug)]
pub(super) struct InfluenceRow {
    pub(super) weights: [f32; BLOCK],
    pub(super) joint: u16,
    /// Whether all weights are 1, so that no other joint moves the block.
    pub(super) is_whole: bool,
}

/// The influences of all vertices.
#[derive(Clone, Debug)]
pub(super) struct InfluenceRows {
    /// `rows[starts[b]..starts[b + 1]]` are those of block `b`. Each vertex has its influences in slot order, but the first two may be
    /// swapped. A joint has several rows if the orders of the block's vertices disagree.
    rows: Vec<InfluenceRow>,
    starts: Vec<u32>,
}

impl InfluenceRows {
    /// The influences of some vertices.
    pub(super) fn new(all: &SlotInfluences<'_>, vertices: &[u32]) -> Self {
        let mut rows = Rows {
            left: vec![0; all.joint_count()],
            rows: Vec::new(),
        };
        let mut starts = Vec::with_capacity(vertices.len().div_ceil(BLOCK) + 1);
        starts.push(0);
        let mut lanes = [(); BLOCK].map(|()| Lane::default());
        for block in vertices.chunks(BLOCK) {
            for (lane, &vertex) in repeated(block) {
                lanes[lane].set(all.of(vertex as usize));
            }
            rows.push(&mut lanes);
            starts.push(rows.rows.len() as u32);
        }
        rows.rows.shrink_to_fit();
        Self {
            rows: rows.rows,
            starts,
        }
    }

    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> &[InfluenceRow] {
        &self.rows[self.starts[block] as usize..self.starts[block + 1] as usize]
    }

    /// The influences of a vertex, without those of weight 0.
    #[inline(always)]
    pub(super) fn of_vertex(&self, vertex: u32) -> impl Iterator<Item = Influence> {
        let (block, lane) = block_and_lane(vertex);
        let of_row = move |row: &InfluenceRow| Influence {
            joint: row.joint,
            weight: row.weights[lane],
        };
        self.of_block(block).iter().map(of_row).filter(|of| of.weight > 0.0)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.rows) + size_of_val(&*self.starts)
    }
}

/// Merges the influences of vertices into rows.
struct Rows {
    /// By joint, the number of the block's influences that have no row yet. All are 0 between blocks.
    left: Vec<u32>,
    rows: Vec<InfluenceRow>,
}

impl Rows {
    /// Adds the rows of a block.
    fn push(&mut self, lanes: &mut [Lane; BLOCK]) {
        for influence in lanes.iter().flat_map(|lane| &lane.influences) {
            self.left[usize::from(influence.joint)] += 1;
        }
        while let Some((joint, count)) = self.next(lanes) {
            let mut weights = [0.0; BLOCK];
            for (weight, lane) in weights.iter_mut().zip(&mut *lanes) {
                *weight = lane.take(joint);
            }
            self.left[usize::from(joint)] -= count;
            self.rows.push(InfluenceRow {
                weights,
                joint,
                is_whole: weights == [1.0; BLOCK] && lanes.iter().all(|lane| lane.influences.len() == 1),
            });
        }
    }

    /// The joint of the next row, and the number of vertices that can take it now. A joint that all its vertices can take now has one
    /// row for all of them, so it comes first; otherwise the one that most vertices can take.
    fn next(&self, lanes: &[Lane]) -> Option<(u16, u32)> {
        let joints = lanes.iter().flat_map(Lane::next).map(|influence| influence.joint);
        let count = |joint| lanes.iter().filter(|lane| lane.next_of(joint).is_some()).count() as u32;
        let counted = joints.map(|joint| (joint, count(joint)));
        let is_last = |&(joint, count): &(u16, u32)| self.left[usize::from(joint)] == count;
        counted.max_by_key(|of| (is_last(of), of.1, std::cmp::Reverse(of.0)))
    }
}

/// A vertex whose influences are put into rows.
#[derive(Default)]
struct Lane {
    influences: Vec<Influence>,
    /// The number of those that have a row.
    taken: usize,
}

impl Lane {
    fn set(&mut self, influences: impl Iterator<Item = Influence>) {
        self.influences.clear();
        self.influences.extend(influences);
        self.taken = 0;
    }

    /// The influences of which any may come next. The first two products can be summed in either order, because `0 + a + b` and
    /// `0 + b + a` are the same.
    fn next(&self) -> &[Influence] {
        let left = &self.influences[self.taken..];
        &left[..left.len().min(if self.taken == 0 { 2 } else { 1 })]
    }

    /// Where the influence of a joint is, if it may come next.
    fn next_of(&self, joint: u16) -> Option<usize> {
        let index = self.next().iter().position(|influence| influence.joint == joint)?;
        Some(self.taken + index)
    }

    /// Takes the influence of a joint if it may come next. Returns its weight, or 0.
    fn take(&mut self, joint: u16) -> f32 {
        let Some(index) = self.next_of(joint) else {
            return 0.0;
        };
        self.influences.swap(self.taken, index);
        self.taken += 1;
        self.influences[self.taken - 1].weight
    }
}
