//! Lists with a limit.

use std::ops::ControlFlow;

/// A list with a limit. It records whether an item was left out.
#[derive(Debug)]
pub(super) struct Capped<'a, T> {
    items: &'a mut Vec<T>,
    room: usize,
    pub(super) is_truncated: bool,
}

impl<'a, T> Capped<'a, T> {
    /// A list that appends at most `limit` items to `items`.
    pub(super) fn new(items: &'a mut Vec<T>, limit: usize) -> Self {
        Self {
            items,
            room: limit,
            is_truncated: false,
        }
    }

    /// Appends an item; breaks at the first one that does not fit.
    #[inline]
    pub(super) fn push(&mut self, item: T) -> ControlFlow<()> {
        if self.room == 0 {
            self.is_truncated = true;
            return ControlFlow::Break(());
        }
        self.room -= 1;
        self.items.push(item);
        ControlFlow::Continue(())
    }
}
