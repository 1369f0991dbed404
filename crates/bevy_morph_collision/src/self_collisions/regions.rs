//! Follows regions from run to run.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use morph_collision::{Body, MorphModel, TrianglePair, touching_regions};

use super::list::MorphSelfContact;

/// What began and ended.
#[derive(Default)]
pub(super) struct Changes {
    /// Numbers of regions.
    pub(super) ended: Vec<u32>,
    pub(super) started: Vec<u32>,
}

impl Changes {
    pub(super) fn is_empty(&self) -> bool {
        self.ended.is_empty() && self.started.is_empty()
    }
}

/// Replaces regions by those of the pairs that intersect now. A region goes on as a new one with which it has a triangle in common.
/// Older regions choose first, and each takes the largest new one that is left. `middle` computes the
/// point of a region, and `next` is the first number that was never used.
pub(super) fn replace(
    regions: &mut Vec<MorphSelfContact>,
    pairs: &[TrianglePair],
    model: &MorphModel,
    mut middle: impl FnMut(&[TrianglePair]) -> Vec3,
    next: &mut u32,
) -> Changes {
    let mut now = touching_regions(model, pairs);
    now.sort_by_key(|pairs| std::cmp::Reverse(pairs.len()));
    let mut regions_of: HashMap<u32, usize> = HashMap::default();
    for (index, pairs) in now.iter().enumerate() {
        for triangle in pairs.iter().flat_map(both) {
            regions_of.insert(triangle, index);
        }
    }
    let mut numbers: Vec<Option<u32>> = vec![None; now.len()];
    let mut changes = Changes::default();
    for before in regions.drain(..) {
        let mut shared: Vec<usize> = before
            .triangles
            .iter()
            .flat_map(both)
            .filter_map(|triangle| regions_of.get(&triangle).copied())
            .collect();
        shared.sort_unstable();
        match shared.into_iter().find(|&index| numbers[index].is_none()) {
            Some(index) => numbers[index] = Some(before.region),
            None => changes.ended.push(before.region),
        }
    }
    for (mut triangles, number) in now.into_iter().zip(numbers) {
        let region = number.unwrap_or_else(|| {
            changes.started.push(*next);
            std::mem::replace(next, next.wrapping_add(1))
        });
        triangles.sort_unstable();
        let point = middle(&triangles);
        regions.push(MorphSelfContact {
            region,
            point,
            triangles,
        });
    }
    regions.sort_unstable_by_key(|region| region.region);
    changes
}

fn both(pair: &TrianglePair) -> [u32; 2] {
    [pair.triangle_a, pair.triangle_b]
}

/// The mean of the centroids of all triangles.
pub(super) fn middle(pairs: &[TrianglePair], body: &mut Body<'_>) -> Vec3 {
    // In a fixed order, because a sum is rounded: that of a hash set differs between machines.
    let mut triangles: Vec<u32> = pairs.iter().flat_map(both).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let corners = triangles.iter().filter_map(|&triangle| body.triangle(triangle));
    let (sum, count) = corners
        .flatten()
        .fold((bevy::math::DVec3::ZERO, 0.0), |(sum, count), corner| {
            (sum + corner, count + 1.0)
        });
    (sum / f64::max(count, 1.0)).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(triangle_a: u32, triangle_b: u32) -> TrianglePair {
        TrianglePair { triangle_a, triangle_b }
    }

    /// Two strips of ten triangles.
    fn model() -> MorphModel {
        let positions: Vec<Vec3> = (0..24).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
        let strip = |from: u32| (from..from + 10).map(|i| [i, i + 1, i + 2]);
        let triangles: Vec<[u32; 3]> = strip(0).chain(strip(12)).collect();
        MorphModel::from_displacements(&positions, &triangles, &[] as &[Vec<Vec3>]).expect("a model")
    }

    #[test]
    fn regions_keep_their_numbers_while_their_triangles_touch() {
        let (model, mut regions, mut next) = (model(), Vec::new(), 0);
        let mut run = |pairs: &[TrianglePair]| {
            let changes = replace(&mut regions, pairs, &model, |_| Vec3::ZERO, &mut next);
            let numbers: Vec<u32> = regions.iter().map(|region| region.region).collect();
            (numbers, changes.started, changes.ended)
        };
        assert_eq!(run(&[pair(0, 3), pair(10, 13)]), (vec![0, 1], vec![0, 1], vec![]));
        assert_eq!(run(&[pair(10, 14), pair(1, 3)]), (vec![0, 1], vec![], vec![]));
        // They grow together: the older one goes on.
        assert_eq!(
            run(&[pair(10, 14), pair(1, 3), pair(3, 14)]),
            (vec![0], vec![], vec![1])
        );
        // They part: the larger one goes on.
        assert_eq!(
            run(&[pair(10, 14), pair(11, 14), pair(1, 3)]),
            (vec![0, 2], vec![2], vec![])
        );
        assert_eq!(run(&[pair(1, 3)]), (vec![2], vec![], vec![0]));
        assert_eq!(run(&[]), (vec![], vec![], vec![2]));
        assert_eq!(run(&[pair(1, 3)]), (vec![3], vec![3], vec![]));
    }
}
