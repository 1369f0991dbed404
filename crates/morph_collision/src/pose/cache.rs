//! Values made at the first visit in an epoch and found again until the next one (the paper's Sect. 5).

/// Which slot of a growing store holds the value of an index, if any does in this epoch.
///
/// Only the slots grow with what is visited; the table of stamps is 8 bytes per index.
#[derive(Clone, Debug)]
pub(super) struct Stamped<T> {
    epoch: u32,
    stamps: Vec<(u32, u32)>,
    slots: Vec<T>,
}

impl<T> Stamped<T> {
    pub(super) fn new(indices: usize) -> Self {
        Self {
            epoch: 1,
            stamps: vec![(0, 0); indices],
            slots: Vec::new(),
        }
    }

    /// Forgets every value; keeps the memory.
    pub(super) fn next_epoch(&mut self) {
        self.slots.clear();
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch == 0 {
            self.stamps.fill((0, 0));
            self.epoch = 1;
        }
    }

    /// The slot of an index visited in this epoch.
    #[inline]
    pub(super) fn find(&self, index: usize) -> Option<usize> {
        let (epoch, slot) = self.stamps[index];
        (epoch == self.epoch).then_some(slot as usize)
    }

    /// Stores the value of an index at its first visit.
    #[inline]
    pub(super) fn insert(&mut self, index: usize, value: T) -> usize {
        let slot = self.slots.len();
        self.slots.push(value);
        self.stamps[index] = (self.epoch, slot as u32);
        slot
    }

    #[inline]
    pub(super) fn get(&self, slot: usize) -> &T {
        &self.slots[slot]
    }

    #[inline]
    pub(super) fn get_mut(&mut self, slot: usize) -> &mut T {
        &mut self.slots[slot]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.stamps) + self.slots.capacity() * size_of::<T>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_values_stay_forgotten_when_epochs_begin_again() {
        let mut values = Stamped::new(2);
        values.insert(0, 'a');
        values.epoch = u32::MAX;
        values.insert(1, 'b');
        assert_eq!(
            (values.find(0), values.find(1).map(|slot| *values.get(slot))),
            (None, Some('b'))
        );
        // The stamp of 'a' is that of the epoch that comes next.
        values.next_epoch();
        assert_eq!((values.find(0), values.find(1)), (None, None));
        values.insert(1, 'c');
        assert_eq!(values.find(1).map(|slot| *values.get(slot)), Some('c'));
    }
}
