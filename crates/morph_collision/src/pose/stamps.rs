//! Which entries of an array are valid; all of them can be discarded in constant time.

/// A stamp per entry. It is valid only in the epoch in which it was stamped.
#[derive(Clone, Debug)]
pub(super) struct Stamps {
    /// Never 0.
    pub(super) epoch: u32,
    stamps: Vec<u32>,
}

impl Stamps {
    /// Without entries, which are all invalid.
    pub(super) fn new() -> Self {
        Self {
            epoch: 1,
            stamps: Vec::new(),
        }
    }

    /// Sets the number of entries. They are all invalid.
    pub(super) fn reset(&mut self, entries: usize) {
        self.stamps = vec![0; entries];
    }

    /// Discards all entries.
    pub(super) fn discard(&mut self) {
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch == 0 {
            self.stamps.fill(0);
            self.epoch = 1;
        }
    }

    /// Whether an entry is valid.
    #[inline(always)]
    pub(super) fn is_valid(&self, entry: usize) -> bool {
        self.stamps.get(entry) == Some(&self.epoch)
    }

    /// Makes an entry valid. Returns whether it was not. The entry must have memory.
    #[inline(always)]
    pub(super) fn claim(&mut self, entry: usize) -> bool {
        std::mem::replace(&mut self.stamps[entry], self.epoch) != self.epoch
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.stamps)
    }
}
