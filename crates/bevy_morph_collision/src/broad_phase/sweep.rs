//! Which of many boxes overlap: sweep and prune along the x axis, in an order that is kept from run to run.

use morph_collision::Aabb;

/// If putting the boxes back in order takes more steps than this for each of them, all are sorted. An estimate: sorting a thousand takes
/// as long.
const MAX_STEPS: usize = 8;

/// Finds the boxes that overlap. Colliders move little between two runs, so the order of the last run is almost right.
#[derive(Default)]
pub(super) struct Sweep {
    /// By where they begin along the x axis.
    boxes: Vec<SortedBox>,
}

#[derive(Clone, Copy)]
struct SortedBox {
    bounds: Aabb,
    index: u32,
    /// Where it begins, as a number in the order of [`f32::total_cmp`]: NaN has a place, too.
    begin: i32,
}

impl Sweep {
    /// Replaces `pairs` by the index pairs `(i, j)`, `i < j`, of overlapping boxes, in ascending order: the same as
    /// [`overlapping_pairs`](morph_collision::overlapping_pairs) finds.
    pub(super) fn find(&mut self, bounds: &[Aabb], pairs: &mut Vec<(u32, u32)>) {
        self.arrange(bounds);
        pairs.clear();
        for (place, a) in self.boxes.iter().enumerate() {
            for b in &self.boxes[place + 1..] {
                let is_reached = b.bounds.min.x <= a.bounds.max.x;
                if !is_reached {
                    break;
                }
                if overlap(&a.bounds, &b.bounds) {
                    pairs.push((a.index.min(b.index), a.index.max(b.index)));
                }
            }
        }
        pairs.sort_unstable();
    }

    /// Takes over the boxes, and puts them in order.
    fn arrange(&mut self, bounds: &[Aabb]) {
        let count = bounds.len();
        let known = self.boxes.len() as u32;
        if known as usize != count {
            self.boxes.retain(|one| (one.index as usize) < count);
            let new = (known..).zip(bounds.iter().skip(known as usize));
            self.boxes
                .extend(new.map(|(index, &bounds)| SortedBox::new(index, bounds)));
        }
        let mut steps = 0;
        for place in 0..count {
            let index = self.boxes[place].index;
            let moved = SortedBox::new(index, bounds[index as usize]);
            let mut to = place;
            if steps <= MAX_STEPS * count {
                while to > 0 && moved.begin < self.boxes[to - 1].begin {
                    self.boxes[to] = self.boxes[to - 1];
                    to -= 1;
                }
                steps += place - to;
            }
            self.boxes[to] = moved;
        }
        if steps > MAX_STEPS * count {
            self.boxes.sort_unstable_by_key(|one| one.begin);
        }
    }
}

impl SortedBox {
    fn new(index: u32, bounds: Aabb) -> Self {
        let bits = bounds.min.x.to_bits().cast_signed();
        Self {
            bounds,
            index,
            // Reverses the order of negative numbers, as `f32::total_cmp` does.
            begin: bits ^ ((bits >> 31).cast_unsigned() >> 1).cast_signed(),
        }
    }
}

/// As [`Aabb::overlaps`], but one axis decides most pairs. Boxes that are compared overlap along x.
fn overlap(a: &Aabb, b: &Aabb) -> bool {
    (a.min.z <= b.max.z && b.min.z <= a.max.z)
        && (a.min.y <= b.max.y && b.min.y <= a.max.y)
        && (a.min.x <= b.max.x && b.min.x <= a.max.x)
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;
    use morph_collision::overlapping_pairs;
    use proptest::prelude::*;

    use super::*;

    /// What happens to the boxes between two runs.
    #[derive(Clone, Debug)]
    enum Change {
        Nothing,
        /// All move a little.
        Drift(f32),
        /// All are somewhere else.
        Shuffle(u32),
        /// A coordinate of one of them.
        Set(usize, usize, f32),
        Remove(usize),
        Add(usize, [f32; 3]),
        Truncate(usize),
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        let special = [
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
            -f32::NAN,
            0.0,
            -0.0,
            f32::MAX,
            f32::MIN,
        ];
        prop_oneof![4 => -9.0..9.0_f32, 1 => proptest::sample::select(special.to_vec())]
    }

    fn change() -> impl Strategy<Value = Change> {
        let corner = || [-9.0..9.0_f32, -9.0..9.0_f32, -9.0..9.0_f32];
        prop_oneof![
            1 => Just(Change::Nothing),
            4 => (0.0..0.5_f32).prop_map(Change::Drift),
            1 => any::<u32>().prop_map(Change::Shuffle),
            4 => (0..200_usize, 0..6_usize, coordinate()).prop_map(|(one, axis, to)| Change::Set(one, axis, to)),
            2 => (0..200_usize).prop_map(Change::Remove),
            2 => (0..200_usize, corner()).prop_map(|(place, at)| Change::Add(place, at)),
            1 => (0..200_usize).prop_map(Change::Truncate),
        ]
    }

    fn noise(i: usize, k: u32) -> f32 {
        let bits = ((i as u32).wrapping_mul(2_654_435_761) ^ k.wrapping_mul(974_634_641)).wrapping_mul(2_246_822_519);
        (bits >> 8) as f32 / (1 << 24) as f32
    }

    fn at(min: Vec3) -> Aabb {
        Aabb { min, max: min + 3.0 }
    }

    fn scattered(count: usize, seed: u32) -> Vec<Aabb> {
        let corner = |i| Vec3::new(noise(i, seed), noise(i, seed ^ 1), noise(i, seed ^ 2)) * 18.0 - 9.0;
        (0..count).map(|i| at(corner(i))).collect()
    }

    fn apply(change: &Change, boxes: &mut Vec<Aabb>) {
        let count = boxes.len();
        match *change {
            Change::Drift(speed) => {
                for (i, one) in boxes.iter_mut().enumerate() {
                    let way = speed * (Vec3::new(noise(i, 5), noise(i, 6), noise(i, 7)) - 0.5);
                    (one.min, one.max) = (one.min + way, one.max + way);
                }
            }
            Change::Shuffle(seed) => *boxes = scattered(count, seed),
            Change::Set(one, axis, to) if count > 0 => {
                let one = &mut boxes[one % count];
                let corner = if axis < 3 { &mut one.min } else { &mut one.max };
                corner[axis % 3] = to;
            }
            Change::Remove(one) if count > 0 => _ = boxes.remove(one % count),
            Change::Add(place, corner) => boxes.insert(place.min(count), at(Vec3::from_array(corner))),
            Change::Truncate(to) => boxes.truncate(to),
            Change::Nothing | Change::Set(..) | Change::Remove(_) => {}
        }
    }

    proptest! {
        #[test]
        fn finds_the_same_pairs_as_a_sweep_from_scratch(
            count in 0..150_usize,
            seed in any::<u32>(),
            changes in proptest::collection::vec(change(), 1..30),
        ) {
            let (mut sweep, mut boxes) = (Sweep::default(), scattered(count, seed));
            let (mut found, mut expected) = (vec![(7, 7)], Vec::new());
            for change in &changes {
                apply(change, &mut boxes);
                sweep.find(&boxes, &mut found);
                expected.clear();
                let present: Vec<_> = boxes.iter().copied().map(Some).collect();
                overlapping_pairs(&present, &mut expected);
                prop_assert_eq!(&found, &expected, "after {:?}", change);
            }
        }
    }

    #[test]
    fn the_order_is_kept_while_boxes_drift_and_restored_when_they_jump() {
        let mut sweep = Sweep::default();
        let mut found = Vec::new();
        for seed in 0..4 {
            let mut boxes = scattered(120, seed);
            for _ in 0..20 {
                sweep.find(&boxes, &mut found);
                assert!(found.len() > 50);
                assert!(sweep.boxes.is_sorted_by_key(|one| one.begin));
                apply(&Change::Drift(0.2), &mut boxes);
            }
        }
    }

    #[test]
    fn boxes_without_volume_overlap_as_the_boxes_say() {
        let inverted = Aabb {
            min: Vec3::splat(1.0),
            max: Vec3::splat(-1.0),
        };
        let everything = Aabb {
            min: Vec3::NEG_INFINITY,
            max: Vec3::INFINITY,
        };
        let boxes = [at(Vec3::ZERO), inverted, everything, Aabb::EMPTY, at(Vec3::splat(3.0))];
        let mut found = Vec::new();
        Sweep::default().find(&boxes, &mut found);
        assert_eq!(found, [(0, 2), (0, 4), (1, 2), (2, 3), (2, 4)]);
    }
}
