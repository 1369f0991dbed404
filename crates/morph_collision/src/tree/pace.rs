//! Building in steps: what is long pauses after every piece of work that it can be cut into.
//!
//! The compiler makes the state between two pieces: what builds is `async`, and awaits [`Pace::spend`] before each piece. A build that must not
//! pause has an endless pace, and its future is ready at the first poll.

use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::task::{Context, Poll, Waker};

/// The work that is left in a step. The unit is about that of taking one triangle of one shape into a box.
#[derive(Debug)]
pub(super) struct Pace {
    left: AtomicUsize,
}

impl Pace {
    pub(super) fn endless() -> Self {
        Self {
            left: AtomicUsize::new(usize::MAX),
        }
    }

    /// Begins a step.
    pub(super) fn begin(&self, work: usize) {
        self.left.store(work, Relaxed);
    }

    #[cfg(test)]
    pub(super) fn left(&self) -> usize {
        self.left.load(Relaxed)
    }

    /// Pauses before a piece that does not fit into what is left of the step. A piece that is larger than a step has one of its own.
    #[inline]
    pub(super) async fn spend(&self, work: usize) {
        if work > self.left.load(Relaxed) {
            let mut has_paused = false;
            poll_fn(|_| match std::mem::replace(&mut has_paused, true) {
                true => Poll::Ready(()),
                false => Poll::Pending,
            })
            .await;
        }
        // Nobody else writes it while a step runs.
        self.left.store(self.left.load(Relaxed).saturating_sub(work), Relaxed);
    }
}

/// Goes on with a build up to its next pause.
pub(super) fn go_on<T>(build: Pin<&mut (impl Future<Output = T> + ?Sized)>) -> Poll<T> {
    build.poll(&mut Context::from_waker(Waker::noop()))
}

/// Builds without a pause.
pub(super) fn at_once<T>(build: impl Future<Output = T>) -> T {
    let mut build = pin!(build);
    loop {
        if let Poll::Ready(built) = go_on(build.as_mut()) {
            return built;
        }
    }
}
