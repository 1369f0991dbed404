//! Which of many boxes overlap: sweep and prune.

use crate::bounds::Aabb;

/// Of fewer boxes, every pair is tested: of twelve that takes half of the instructions of sorting them. The number is an estimate.
const FEW: usize = 32;

/// A broad phase: appends the index pairs `(i, j)`, `i < j`, of overlapping boxes, in ascending order. Entries that are `None` overlap
/// nothing.
///
/// Sorts and sweeps along the x axis, unless there are only a few boxes. Cost: `O(n log n)`, plus the number of overlaps along x.
pub fn overlapping_pairs(bounds: &[Option<Aabb>], pairs: &mut Vec<(u32, u32)>) {
    if bounds.len() < FEW {
        test_all(bounds, pairs);
    } else {
        sweep(bounds, pairs);
    }
}

fn test_all(bounds: &[Option<Aabb>], pairs: &mut Vec<(u32, u32)>) {
    for (i, a) in bounds.iter().enumerate() {
        let Some(a) = a else { continue };
        for (j, b) in bounds.iter().enumerate().skip(i + 1) {
            let Some(b) = b else { continue };
            // One axis decides most pairs.
            if a.min.x <= b.max.x && b.min.x <= a.max.x && a.overlaps(b) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
}

fn sweep(bounds: &[Option<Aabb>], pairs: &mut Vec<(u32, u32)>) {
    let start = pairs.len();
    let mut order: Vec<(Aabb, u32)> = bounds
        .iter()
        .enumerate()
        .filter_map(|(i, bounds)| Some(((*bounds)?, i as u32)))
        .collect();
    order.sort_by(|(a, i), (b, j)| a.min.x.total_cmp(&b.min.x).then(i.cmp(j)));
    for (index, (a, i)) in order.iter().enumerate() {
        let reached = order[index + 1..].iter().take_while(|(b, _)| b.min.x <= a.max.x);
        for (_, j) in reached.filter(|(b, _)| a.overlaps(b)) {
            pairs.push((*i.min(j), *i.max(j)));
        }
    }
    pairs[start..].sort_unstable();
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// A broad phase.
    type Way = fn(&[Option<Aabb>], &mut Vec<(u32, u32)>);
    const WAYS: [Way; 2] = [test_all, sweep];

    fn unit_box(x: f32) -> Option<Aabb> {
        let min = Vec3::new(x, 0.0, 0.0);
        Some(Aabb {
            min,
            max: min + Vec3::ONE,
        })
    }

    #[test]
    fn touching_boxes_are_a_pair_and_absent_ones_are_not() {
        for way in WAYS {
            let mut pairs = Vec::new();
            way(
                &[unit_box(2.0), unit_box(0.0), None, unit_box(1.0), unit_box(9.0)],
                &mut pairs,
            );
            assert_eq!(pairs, [(0, 3), (1, 3)]);
        }
    }

    #[test]
    fn boxes_apart_along_another_axis_are_no_pair() {
        let mut lifted = unit_box(0.0);
        if let Some(bounds) = &mut lifted {
            bounds.min.y = 2.0;
            bounds.max.y = 3.0;
        }
        for way in WAYS {
            let mut pairs = Vec::new();
            way(&[unit_box(0.0), lifted], &mut pairs);
            assert_eq!(pairs, []);
        }
    }

    #[test]
    fn both_ways_append_the_same_pairs_for_few_and_many_boxes() {
        for count in [FEW - 1, FEW, 3 * FEW] {
            let place = |i: usize, step: usize| (i * step % 61) as f32 * 0.3;
            let bounds: Vec<_> = (0..count)
                .map(|i| {
                    let min = Vec3::new(place(i, 17), place(i, 23), place(i, 31));
                    let max = min + Vec3::splat(4.0);
                    (i % 7 > 0).then_some(Aabb { min, max })
                })
                .collect();
            let before = vec![(9, 3)];
            let [all, swept, chosen] = [WAYS[0], WAYS[1], overlapping_pairs].map(|way| {
                let mut pairs = before.clone();
                way(&bounds, &mut pairs);
                pairs
            });
            assert!(all.len() > 5, "{}", all.len());
            assert_eq!(all, swept);
            assert_eq!(all, chosen);
        }
    }
}
