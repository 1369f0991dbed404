//! A cache of values by index that can be cleared in constant time: when the weights change (the paper's Sect. 5), or when a query
//! starts.

/// Values by index. Each is valid only in the epoch in which it was stored.
///
/// Values are stored densely in slots, so memory grows with what is visited; the stamps take 8 bytes per index. Outdated values stay
/// in their slots until the slots are reused, so large values are overwritten in place.
#[derive(Clone, Debug)]
pub(crate) struct EpochCache<T> {
    epoch: u32,
    /// For each index, the epoch and the slot of its last value.
    stamps: Vec<(u32, u32)>,
    slots: Vec<T>,
    /// The number of slots with values of this epoch.
    used: usize,
}

impl<T: Default> Default for EpochCache<T> {
    fn default() -> Self {
        Self::new(0)
    }
}

impl<T: Default> EpochCache<T> {
    /// A cache with room for this many indices; it grows as needed.
    pub(crate) fn new(indices: usize) -> Self {
        Self {
            epoch: 1,
            stamps: vec![(0, 0); indices],
            slots: Vec::new(),
            used: 0,
        }
    }

    /// Discards every value and keeps the memory.
    pub(crate) fn next_epoch(&mut self) {
        self.used = 0;
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch == 0 {
            self.stamps.fill((0, 0));
            self.epoch = 1;
        }
    }

    /// The slot of an index, if its value was stored in this epoch.
    #[inline]
    pub(crate) fn find(&self, index: usize) -> Option<usize> {
        let (epoch, slot) = *self.stamps.get(index)?;
        (epoch == self.epoch).then_some(slot as usize)
    }

    /// Stores the value of an index and returns its slot.
    #[inline]
    pub(crate) fn insert(&mut self, index: usize, value: T) -> usize {
        let slot = self.claim(index);
        self.slots[slot] = value;
        slot
    }

    /// Assigns a slot to an index. The caller must overwrite the old value in it.
    #[inline]
    pub(crate) fn claim(&mut self, index: usize) -> usize {
        let slot = self.used;
        self.used += 1;
        if self.stamps.len() <= index || self.slots.len() <= slot {
            self.grow(index, slot);
        }
        self.stamps[index] = (self.epoch, slot as u32);
        slot
    }

    #[cold]
    fn grow(&mut self, index: usize, slot: usize) {
        self.stamps.resize(self.stamps.len().max(index + 1), (0, 0));
        self.slots.resize_with(self.slots.len().max(slot + 1), T::default);
    }

    #[inline]
    pub(crate) fn get(&self, slot: usize) -> &T {
        &self.slots[slot]
    }

    #[inline]
    pub(crate) fn get_mut(&mut self, slot: usize) -> &mut T {
        &mut self.slots[slot]
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.stamps) + self.slots.capacity() * size_of::<T>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_values_stay_forgotten_when_the_epoch_wraps() {
        let mut values = EpochCache::new(2);
        values.insert(0, 'a');
        values.epoch = u32::MAX;
        values.insert(1, 'b');
        assert_eq!(
            (values.find(0), values.find(1).map(|slot| *values.get(slot))),
            (None, Some('b'))
        );
        // The epoch wraps around to the number under which 'a' was stored.
        values.next_epoch();
        assert_eq!((values.find(0), values.find(1)), (None, None));
        values.insert(1, 'c');
        assert_eq!(values.find(1).map(|slot| *values.get(slot)), Some('c'));
    }

    #[test]
    fn a_new_cache_grows_without_finding_what_was_never_stored() {
        let mut values = EpochCache::default();
        assert_eq!(values.find(1), None);
        values.insert(1, 'a');
        assert_eq!(
            (values.find(0), values.find(1).map(|slot| *values.get(slot))),
            (None, Some('a'))
        );
    }

    #[test]
    fn a_cache_has_the_bytes_of_its_stamps_and_of_its_values() {
        let mut values = EpochCache::<[u64; 4]>::new(3);
        assert_eq!(values.bytes(), 3 * 8);
        values.insert(1, [0; 4]);
        assert_eq!(values.bytes(), 3 * 8 + values.slots.capacity() * 32);
    }
}
