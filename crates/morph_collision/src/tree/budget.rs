//! Building in steps: long work is cut into pieces, and the build can pause before each piece.
//!
//! Building code is `async` and awaits [`Budget::spend`] before each piece, so the compiler generates the state that is kept between pieces. A
//! build that must not pause gets an unlimited budget; its future is ready at the first poll.

use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::task::{Context, Poll, Waker};

use crate::model::MorphModel;

/// The work left in the current step. One unit is roughly the work of adding one triangle of one shape to a box.
#[derive(Debug)]
pub(super) struct Budget {
    left: AtomicUsize,
}

impl Budget {
    pub(super) fn unlimited() -> Self {
        Self {
            left: AtomicUsize::new(usize::MAX),
        }
    }

    /// Begins a step with this much work.
    pub(super) fn begin(&self, work: usize) {
        self.left.store(work, Relaxed);
    }

    #[cfg(test)]
    pub(super) fn left(&self) -> usize {
        self.left.load(Relaxed)
    }

    /// Pauses if a piece does not fit into the rest of the step. A piece larger than a step gets a step of its own.
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
        // Nothing else writes it while a step runs.
        self.left.store(self.left.load(Relaxed).saturating_sub(work), Relaxed);
    }
}

/// Runs a build up to its next pause.
pub(super) fn resume<T>(build: Pin<&mut (impl Future<Output = T> + ?Sized)>) -> Poll<T> {
    build.poll(&mut Context::from_waker(Waker::noop()))
}

/// Runs a build to its end.
pub(super) fn run_to_end<T>(build: impl Future<Output = T>) -> T {
    let mut build = pin!(build);
    loop {
        if let Poll::Ready(built) = resume(build.as_mut()) {
            return built;
        }
    }
}

/// The work of measuring `count` vertices or children on every target.
pub(super) fn work_on(model: &MorphModel, count: usize) -> usize {
    /// Joints are not counted one by one, because a vertex has few.
    const JOINTS: usize = 4;
    count * (JOINTS + model.target_count())
}
