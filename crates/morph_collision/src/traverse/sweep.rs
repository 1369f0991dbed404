//! Which of many boxes overlap: sweep and prune.

use crate::bounds::Aabb;

/// A broad phase: appends the index pairs `(i, j)`, `i < j`, of overlapping boxes, in ascending order. Entries that are `None` overlap
/// nothing.
///
/// Sorts and sweeps along the x axis. Cost: `O(n log n)`, plus the number of overlaps along x.
pub fn overlapping_pairs(bounds: &[Option<Aabb>], pairs: &mut Vec<(u32, u32)>) {
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

    fn unit_box(x: f32) -> Option<Aabb> {
        let min = Vec3::new(x, 0.0, 0.0);
        Some(Aabb {
            min,
            max: min + Vec3::ONE,
        })
    }

    #[test]
    fn touching_boxes_are_a_pair_and_absent_ones_are_not() {
        let mut pairs = Vec::new();
        overlapping_pairs(
            &[unit_box(2.0), unit_box(0.0), None, unit_box(1.0), unit_box(9.0)],
            &mut pairs,
        );
        assert_eq!(pairs, [(0, 3), (1, 3)]);
    }

    #[test]
    fn boxes_apart_along_another_axis_are_no_pair() {
        let mut lifted = unit_box(0.0);
        if let Some(bounds) = &mut lifted {
            bounds.min.y = 2.0;
            bounds.max.y = 3.0;
        }
        let mut pairs = Vec::new();
        overlapping_pairs(&[unit_box(0.0), lifted], &mut pairs);
        assert_eq!(pairs, []);
    }
}
