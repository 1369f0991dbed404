//! Decides which unit comes next.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// The units left to do. Never gives out two units with a common body at once.
#[derive(Debug)]
pub(super) struct Schedule {
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Debug)]
struct State {
    /// A stack: the last unit comes first.
    left: Vec<usize>,
    /// By body: whether a unit in progress needs it.
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

    /// Takes the next unit with free bodies, and up to `most` units after it with the same first body, whose cache is warm. Waits
    /// while no unit is free; returns false if none is left.
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

    /// Frees the bodies of finished units.
    pub(super) fn free(&self, bodies: impl Iterator<Item = [usize; 2]>) {
        let mut state = self.lock();
        for [a, b] in bodies {
            (state.busy[a], state.busy[b]) = (false, false);
        }
        drop(state);
        self.freed.notify_all();
    }

    /// A panic elsewhere leaves the state valid.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
