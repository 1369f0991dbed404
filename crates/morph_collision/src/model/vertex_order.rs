//! The order in which a model numbers its vertices: those of a block are near each other and share joints.

use glam::Vec3;

use super::blocks::BLOCK;
use super::influences::SlotInfluences;

/// Within this many neighbouring vertices, those that the same joints move are put next to each other.
const CELL: usize = 8 * BLOCK;

/// Sorts vertices with these positions. Cost: `O(n log n)`. Up to eight vertices keep their order.
pub(super) fn sort(vertices: &mut [u32], positions: &[Vec3], influences: Option<&SlotInfluences<'_>>) {
    if vertices.len() <= BLOCK {
        return;
    }
    split(vertices, positions);
    if let Some(influences) = influences {
        for cell in vertices.chunks_mut(CELL) {
            cell.sort_by_cached_key(|&vertex| joints(influences, vertex));
        }
    }
}

/// Splits vertices at the median along their longest side, down to blocks.
fn split(vertices: &mut [u32], positions: &[Vec3]) {
    if vertices.len() <= BLOCK {
        vertices.sort_unstable();
        return;
    }
    let position = |vertex: &u32| positions[*vertex as usize];
    let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (min, max) = vertices
        .iter()
        .map(position)
        .fold(empty, |(min, max), p| (min.min(p), max.max(p)));
    let axis = (max - min).max_position();
    let unit = if vertices.len() > CELL { CELL } else { BLOCK };
    let half = (vertices.len() / 2).next_multiple_of(unit);
    vertices.select_nth_unstable_by(half, |a, b| {
        position(a)[axis].total_cmp(&position(b)[axis]).then(a.cmp(b))
    });
    let (low, high) = vertices.split_at_mut(half);
    split(low, positions);
    split(high, positions);
}

/// The joints that move a vertex, in the order in which their matrices are summed. The first two are interchangeable.
fn joints(influences: &SlotInfluences<'_>, vertex: u32) -> Vec<u16> {
    let mut joints: Vec<u16> = influences
        .of(vertex as usize)
        .map(|influence| influence.joint)
        .collect();
    if let Some([first, second]) = joints.first_chunk_mut()
        && first > second
    {
        std::mem::swap(first, second);
    }
    joints
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::model::Influences;

    /// The largest distance of two vertices in a block, on average over all blocks.
    fn spread(order: &[u32], positions: &[Vec3]) -> f32 {
        let of_block = |block: &[u32]| {
            let at = |vertex: &u32| positions[*vertex as usize];
            let distances = block
                .iter()
                .flat_map(|a| block.iter().map(move |b| at(a).distance(at(b))));
            distances.fold(0.0, f32::max)
        };
        let blocks = order.chunks(BLOCK);
        let count = blocks.len() as f32;
        blocks.map(of_block).sum::<f32>() / count
    }

    #[test]
    fn every_vertex_has_a_place_near_its_neighbours() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for count in [1, 8, 9, 17, 63, 64, 65, 128, 129, 1000, 4003] {
            let positions: Vec<Vec3> = (0..count).map(|_| rng.random::<[f32; 3]>().into()).collect();
            let all: Vec<u32> = (0..count).collect();
            let mut order = all.clone();
            sort(&mut order, &positions, None);
            let mut again: Vec<u32> = all.iter().rev().copied().collect();
            sort(&mut again, &positions, None);
            assert!(again == order || count <= 8, "the order depends on nothing else");
            if count <= 8 {
                assert_eq!(order, all);
            } else if count > 128 {
                assert!(spread(&order, &positions) < 0.6 * spread(&all, &positions));
            }
            order.sort_unstable();
            assert_eq!(order, all);
        }
        // Positions do not matter if they are all the same.
        let mut order: Vec<u32> = (0..100).rev().collect();
        sort(&mut order, &[Vec3::ZERO; 100], None);
        assert!(order.is_sorted());
    }

    #[test]
    fn neighbours_that_the_same_joints_move_are_in_one_block() {
        // Along a line, vertices alternate between two pairs of joints, and each pair comes in both orders.
        let positions: Vec<Vec3> = (0..256).map(|i| Vec3::X * i as f32).collect();
        let of = |i: usize| [[0, 1, 0, 0], [3, 2, 0, 0], [1, 0, 0, 0], [2, 3, 0, 0]][i % 4];
        let joints: Vec<[u16; 4]> = (0..256).map(of).collect();
        let weights = vec![[0.5, 0.5, 0.0, 0.0]; 256];
        let sets = [Influences {
            joints: &joints,
            weights: &weights,
        }];
        let influences = SlotInfluences::checked(256, 4, &sets).unwrap();
        let mut order: Vec<u32> = (0..256).collect();
        sort(&mut order, &positions, Some(&influences));
        for block in order.chunks(BLOCK) {
            assert!(block.iter().all(|vertex| vertex % 2 == block[0] % 2), "{block:?}");
            assert!(block.iter().all(|vertex| vertex / 64 == block[0] / 64), "{block:?}");
        }
    }
}
