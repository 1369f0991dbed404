//! Numbers things in the order in which they first occur. Equal things get the same number.

use std::hash::{BuildHasher, DefaultHasher, Hasher, RandomState};

/// A hash table from things to their numbers. The caller keeps the things and compares them. Memory: 16 to 32 bytes per thing.
pub(super) struct Numbering {
    /// A power of two of numbers, each with a part of the thing's hash.
    slots: Vec<(u32, u32)>,
    /// Random, so that no mesh makes the search slow.
    random: RandomState,
    next: u32,
}

const FREE: u32 = u32::MAX;

impl Numbering {
    /// Makes room for up to `count` different things, fewer than 2^31.
    pub(super) fn new(count: usize) -> Self {
        Self {
            slots: vec![(FREE, 0); (2 * count).next_power_of_two()],
            random: RandomState::new(),
            next: 0,
        }
    }

    pub(super) fn hasher(&self) -> DefaultHasher {
        self.random.build_hasher()
    }

    /// The number of a thing, and whether it is new. `is_same` says whether it is the same as the one with a number.
    pub(super) fn number(&mut self, hasher: &DefaultHasher, is_same: impl Fn(u32) -> bool) -> (u32, bool) {
        let (hash, mask) = (hasher.finish(), self.slots.len() - 1);
        let mut place = hash as usize & mask;
        let part = (hash >> 32) as u32;
        loop {
            match self.slots[place] {
                (FREE, _) => {
                    let number = self.next;
                    self.slots[place] = (number, part);
                    self.next += 1;
                    return (number, true);
                }
                (number, other) if other == part && is_same(number) => return (number, false),
                _ => place = (place + 1) & mask,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_are_numbered_by_first_appearance() {
        let things = [7, 3, 7, 9, 3, 1, 7];
        let mut numbering = Numbering::new(4);
        let mut seen = Vec::new();
        let numbers: Vec<u32> = things
            .iter()
            .map(|&thing| {
                let mut hasher = numbering.hasher();
                // All but one have the same hash.
                hasher.write_u64(u64::from(thing == 9));
                let (number, is_new) = numbering.number(&hasher, |number| seen[number as usize] == thing);
                if is_new {
                    seen.push(thing);
                }
                number
            })
            .collect();
        assert_eq!(numbers, [0, 1, 0, 2, 1, 3, 0]);
    }
}
