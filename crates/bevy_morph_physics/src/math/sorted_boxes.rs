//! Finds the boxes that intersect another box without looking at each one.

use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Vector;

/// Boxes sorted by their start along the axis with the largest spread.
///
/// Sorting pays off for at least 16 searches. With fewer, every box is checked.
#[derive(Default)]
pub struct SortedBoxes {
    axis: usize,
    /// The start of each box on the axis, and its index among all.
    begins: Vec<(f32, u32)>,
    /// The maximum end of all boxes on the axis, up to each index in that order.
    reach: Vec<f32>,
    boxes: Vec<Aabb>,
}

/// The number of searches from which sorting is cheaper than checking every box each time.
const SEARCHES: usize = 16;

impl SortedBoxes {
    /// Takes over boxes for this number of searches.
    pub fn take(&mut self, boxes: impl Iterator<Item = Aabb>, searches: usize) {
        self.boxes.clear();
        self.begins.clear();
        self.reach.clear();
        self.boxes.extend(boxes);
        if searches < SEARCHES {
            return;
        }
        let (mut lowest, mut highest) = (Vector::splat(f32::INFINITY), Vector::splat(f32::NEG_INFINITY));
        for bounds in &self.boxes {
            lowest = lowest.min(bounds.mins);
            highest = highest.max(bounds.mins);
        }
        self.axis = (highest - lowest).max_position();
        let begins = self.boxes.iter().zip(0..);
        self.begins
            .extend(begins.map(|(bounds, index)| (bounds.mins[self.axis], index)));
        self.begins
            .sort_unstable_by(|(a, at), (b, bt)| a.total_cmp(b).then(at.cmp(bt)));
        let mut reach = f32::NEG_INFINITY;
        for (_, index) in &self.begins {
            reach = reach.max(self.boxes[*index as usize].maxs[self.axis]);
            self.reach.push(reach);
        }
    }

    /// The indices of the boxes that intersect another, in ascending order.
    pub fn meeting(&self, bounds: &Aabb, into: &mut Vec<u32>) {
        into.clear();
        if self.begins.is_empty() {
            let all = self.boxes.iter().zip(0..);
            into.extend(
                all.filter(|(other, _)| other.intersects(bounds))
                    .map(|(_, index)| index),
            );
            return;
        }
        let first = self.reach.partition_point(|&reach| reach < bounds.mins[self.axis]);
        let end = self
            .begins
            .partition_point(|(begin, _)| *begin <= bounds.maxs[self.axis]);
        let range = self.begins.get(first..end).unwrap_or_default();
        let indices = range.iter().map(|(_, index)| *index);
        into.extend(indices.filter(|&index| self.boxes[index as usize].intersects(bounds)));
        into.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn a_box() -> impl Strategy<Value = Aabb> {
        let number = || prop_oneof![8 => -10.0_f32..10.0, 1 => Just(0.0), 1 => -1e8_f32..1e8];
        let size = || prop_oneof![8 => 0.0_f32..2.0, 1 => Just(0.0), 1 => 0.0_f32..1e3];
        let three = (number(), number(), number()).prop_map(Vector::from);
        (three, (size(), size(), size()).prop_map(Vector::from)).prop_map(|(at, size)| Aabb::new(at, at + size))
    }

    proptest! {
        #[test]
        fn sorted_boxes_answer_as_a_look_at_each_does(
            boxes in prop::collection::vec(a_box(), 0..60),
            others in prop::collection::vec(a_box(), 1..20),
        ) {
            for searches in [1, SEARCHES] {
                let mut sorted = SortedBoxes::default();
                sorted.take(boxes.iter().copied(), searches);
                let mut found = vec![7];
                for other in &others {
                    sorted.meeting(other, &mut found);
                    let all = boxes.iter().zip(0..).filter(|(bounds, _)| bounds.intersects(other));
                    prop_assert_eq!(&found, &all.map(|(_, index)| index).collect::<Vec<u32>>());
                }
            }
        }
    }
}
