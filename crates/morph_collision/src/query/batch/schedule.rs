//! Decides which unit comes next.

use std::sync::{Condvar, Mutex, PoisonError};

use super::lock::locked;

/// The remaining units. Two units that lock the same body are never given out at the same time to different workers.
#[derive(Debug)]
pub(super) struct Schedule {
    /// For each unit, the bodies that it locks, if any.
    bodies: Vec<Option<[usize; 2]>>,
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Debug)]
struct State {
    /// A stack: the last unit comes first.
    left: Vec<usize>,
    /// For each body, whether a unit in progress needs it.
    busy: Vec<bool>,
}

impl Schedule {
    pub(super) fn new(bodies: Vec<Option<[usize; 2]>>, body_count: usize) -> Self {
        Self {
            state: Mutex::new(State {
                left: (0..bodies.len()).rev().collect(),
                busy: vec![false; body_count],
            }),
            bodies,
            freed: Condvar::new(),
        }
    }

    /// Takes the next unit whose bodies are free, and the units after it with the same first body, whose cache is warm: at most `most`
    /// units. Waits while no unit is free. Returns false if none is left.
    pub(super) fn take(&self, most: usize, units: &mut Vec<usize>) -> bool {
        let mut guard = locked(&self.state);
        loop {
            let State { left, busy } = &mut *guard;
            if left.is_empty() {
                return false;
            }
            let free = |&unit: &usize| self.bodies[unit].is_none_or(|[a, b]| !busy[a] && !busy[b]);
            let Some(index) = left.iter().rposition(free) else {
                guard = self.freed.wait(guard).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let mut first = index;
            if let Some([a, b]) = self.bodies[left[index]] {
                (busy[a], busy[b]) = (true, true);
                while first > 0 && index - first + 1 < most {
                    match self.bodies[left[first - 1]] {
                        Some([same, other]) if same == a && !busy[other] => busy[other] = true,
                        _ => break,
                    }
                    first -= 1;
                }
            }
            units.extend(left.drain(first..=index).rev());
            return true;
        }
    }

    /// Frees the bodies of finished units.
    pub(super) fn free(&self, units: impl Iterator<Item = usize>) {
        let mut state = locked(&self.state);
        for [a, b] in units.filter_map(|unit| self.bodies[unit]) {
            (state.busy[a], state.busy[b]) = (false, false);
        }
        drop(state);
        self.freed.notify_all();
    }
}
