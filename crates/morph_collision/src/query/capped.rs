use std::ops::ControlFlow;

/// A list with a limit; remembers whether an item was left out.
#[derive(Debug)]
pub(super) struct Capped<'a, T> {
    items: &'a mut Vec<T>,
    left: usize,
    pub(super) is_truncated: bool,
}

impl<'a, T> Capped<'a, T> {
    pub(super) fn new(items: &'a mut Vec<T>, limit: usize) -> Self {
        Self {
            items,
            left: limit,
            is_truncated: false,
        }
    }

    /// Appends an item; breaks at the first one that there is no room for.
    #[inline]
    pub(super) fn push(&mut self, item: T) -> ControlFlow<()> {
        if self.left == 0 {
            self.is_truncated = true;
            return ControlFlow::Break(());
        }
        self.left -= 1;
        self.items.push(item);
        ControlFlow::Continue(())
    }
}
