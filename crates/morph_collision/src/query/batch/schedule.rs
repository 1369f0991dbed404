//! Which unit comes next.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Units that are left to do; of those that need the same body one is given out at a time.
#[derive(Debug)]
pub(super) struct Schedule {
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Debug)]
struct State {
    /// The last one comes first.
    left: Vec<usize>,
    /// By body.
    busy: Vec<bool>,
}

impl Schedule {
    pub(super) fn new(units: usize, bodies: usize) -> Self {
        Self {
            state: Mutex::new(State {
                left: (0..units).rev().collect(),
                busy: vec![false; bodies],
            }),
            freed: Condvar::new(),
        }
    }

    /// The next unit whose bodies are free, which then are busy; waits while there are only others. `None` when none is left.
    pub(super) fn take(&self, bodies_of: impl Fn(usize) -> Option<[usize; 2]>) -> Option<usize> {
        let mut state = self.lock();
        loop {
            if state.left.is_empty() {
                return None;
            }
            let free = |&unit: &usize| bodies_of(unit).is_none_or(|[a, b]| !state.busy[a] && !state.busy[b]);
            if let Some(place) = state.left.iter().rposition(free) {
                let unit = state.left.swap_remove(place);
                if let Some([a, b]) = bodies_of(unit) {
                    state.busy[a] = true;
                    state.busy[b] = true;
                }
                return Some(unit);
            }
            state = self.freed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Frees the bodies of a unit that is done.
    pub(super) fn free(&self, [a, b]: [usize; 2]) {
        let mut state = self.lock();
        state.busy[a] = false;
        state.busy[b] = false;
        drop(state);
        self.freed.notify_all();
    }

    /// A worker that panicked leaves the state as good as it was.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
