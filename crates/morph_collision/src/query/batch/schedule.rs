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

    /// The next units, up to so many, whose bodies are free, which then are busy: one, and those after it of the same first
    /// body, whose cache stays where it is. Waits while there are only others; says if there are any.
    pub(super) fn take(
        &self,
        most: usize,
        bodies_of: impl Fn(usize) -> Option<[usize; 2]>,
        units: &mut Vec<usize>,
    ) -> bool {
        let mut guard = self.lock();
        loop {
            let State { left, busy } = &mut *guard;
            if left.is_empty() {
                return false;
            }
            let free = |&unit: &usize| bodies_of(unit).is_none_or(|[a, b]| !busy[a] && !busy[b]);
            let Some(place) = left.iter().rposition(free) else {
                guard = self.freed.wait(guard).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let mut first = place;
            if let Some([a, b]) = bodies_of(left[place]) {
                (busy[a], busy[b]) = (true, true);
                while first > 0 && place - first + 1 < most {
                    match bodies_of(left[first - 1]) {
                        Some([same, other]) if same == a && !busy[other] => busy[other] = true,
                        _ => break,
                    }
                    first -= 1;
                }
            }
            units.extend(left.drain(first..=place).rev());
            return true;
        }
    }

    /// Frees bodies of units that are done.
    pub(super) fn free(&self, bodies: impl Iterator<Item = [usize; 2]>) {
        let mut state = self.lock();
        for [a, b] in bodies {
            (state.busy[a], state.busy[b]) = (false, false);
        }
        drop(state);
        self.freed.notify_all();
    }

    /// A worker that panicked leaves the state as good as it was.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
