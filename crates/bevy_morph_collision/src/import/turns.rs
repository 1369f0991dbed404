//! Decides when a background task may continue: at any time on a thread of its own, and for a few milliseconds per frame on the
//! main thread.
//!
//! On the web, and natively without Bevy's feature `multi_threaded`, tasks run on the thread that draws. Yielding to the executor
//! is not enough there, because it resumes the task before the next frame. So tasks wait for the next frame.

use std::future::poll_fn;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Poll, Waker};
use std::thread::{self, ThreadId};
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::tasks::futures_lite::future::yield_now;
use morph_collision::{MorphBvh, MorphBvhBuilder};

/// How long copies and tasks together may delay a frame of 1/60 s. Tasks stop after the step that exceeds it.
const PER_FRAME: Duration = Duration::from_millis(4);
/// The longest frame, in units of 1/60 s, that lets them do more.
const LONGEST_FRAME: f64 = 12.0;

/// Shared by all tasks.
#[derive(Clone)]
pub(super) struct Turns(Arc<Shared>);

struct Shared {
    frames_thread: ThreadId,
    per_frame: Duration,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    frame: u64,
    /// How long copies and tasks may delay this frame, and how long they have.
    allowed: Duration,
    spent: Duration,
    waiting: Vec<Waker>,
}

impl Default for Turns {
    /// For an app that is set up on this thread.
    fn default() -> Self {
        Self::with(PER_FRAME)
    }
}

impl Turns {
    fn with(per_frame: Duration) -> Self {
        Self(Arc::new(Shared {
            frames_thread: thread::current().id(),
            per_frame,
            state: Mutex::new(State {
                allowed: per_frame,
                ..State::default()
            }),
        }))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes up all tasks that wait for a frame. Returns how many times as much as usual they and copies may do in it, because the
    /// last frame was slow for other reasons.
    pub(super) fn begin_frame(&self, last_frame: Duration) -> f64 {
        let (woken, pace) = {
            let mut state = self.state();
            let pace = pace(last_frame.saturating_sub(state.spent));
            state.frame += 1;
            state.allowed = self.0.per_frame.mul_f64(pace);
            state.spent = Duration::ZERO;
            (std::mem::take(&mut state.waiting), pace)
        };
        woken.into_iter().for_each(Waker::wake);
        pace
    }

    /// Counts time that the main thread spent on copies.
    pub(super) fn spend(&self, took: Duration) {
        self.state().spent += took;
    }

    /// Yields after a step of work.
    pub(super) async fn after_step(&self, took: Duration) {
        if thread::current().id() != self.0.frames_thread {
            return yield_now().await;
        }
        let frame = {
            let mut state = self.state();
            state.spent += took;
            (state.spent >= state.allowed).then_some(state.frame)
        };
        let Some(frame) = frame else { return yield_now().await };
        poll_fn(|context| {
            let mut state = self.state();
            if state.frame != frame {
                return Poll::Ready(());
            }
            state.waiting.push(context.waker().clone());
            Poll::Pending
        })
        .await;
    }

    /// Whether a thread draws the frames.
    #[cfg(feature = "gltf")]
    pub(super) fn has_thread(&self, thread: ThreadId) -> bool {
        thread == self.0.frames_thread
    }

    /// Builds a tree and yields after each step.
    pub(super) async fn finish(&self, mut builder: MorphBvhBuilder) -> MorphBvh {
        loop {
            let start = Instant::now();
            builder = match builder.step() {
                ControlFlow::Break(tree) => return tree,
                ControlFlow::Continue(builder) => builder,
            };
            self.after_step(start.elapsed()).await;
        }
    }
}

/// The length of a frame in units of 1/60 s, from 1 to `LONGEST_FRAME`. Where frames are slow, loading does more in each, so that it takes
/// about as long.
fn pace(frame: Duration) -> f64 {
    (60.0 * frame.as_secs_f64()).clamp(1.0, LONGEST_FRAME)
}

#[cfg(test)]
mod tests {
    use std::pin::pin;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::task::{Context, Wake};

    use bevy::prelude::*;
    use morph_collision::{BuildOptions, MorphModel};

    use super::*;

    /// Counts how often a task was woken up.
    #[derive(Default)]
    struct Woken(AtomicUsize);

    impl Wake for Woken {
        fn wake(self: Arc<Self>) {
            self.0.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// A bumpy square with this many triangles per side, twice.
    fn model(side: u32) -> Arc<MorphModel> {
        let vertex = |i: u32| Vec3::new((i % side) as f32, (i / side) as f32, (i as f32 * 0.7).sin());
        let positions: Vec<Vec3> = (0..side * side).map(vertex).collect();
        let corners: Vec<[u32; 3]> = (0..side - 1)
            .flat_map(|row| (0..side - 1).map(move |column| row * side + column))
            .flat_map(|i| [[i, i + 1, i + side], [i + 1, i + side + 1, i + side]])
            .collect();
        let lifted: Vec<Vec3> = positions.iter().map(|p| Vec3::Z * p.x).collect();
        Arc::new(MorphModel::from_displacements(&positions, &corners, &[lifted]).unwrap())
    }

    #[test]
    fn a_task_on_the_thread_of_the_frames_waits_for_the_next_one() {
        let (model, options) = (model(80), BuildOptions::default());
        let turns = Turns::with(Duration::ZERO);
        let woken = Arc::new(Woken::default());
        let waker = Waker::from(woken.clone());
        let mut context = Context::from_waker(&waker);
        let mut task = pin!(turns.finish(MorphBvhBuilder::new(model.clone(), &options)));
        let mut frames = 0;
        let tree = loop {
            if let Poll::Ready(tree) = task.as_mut().poll(&mut context) {
                break tree;
            }
            // It does nothing more in this frame, and is not woken up to try.
            assert!(task.as_mut().poll(&mut context).is_pending());
            assert_eq!(woken.0.swap(0, Ordering::Relaxed), 0);
            turns.begin_frame(Duration::ZERO);
            assert!(woken.0.swap(0, Ordering::Relaxed) >= 1, "the frame wakes it");
            frames += 1;
        };
        assert!(frames >= 10, "{frames}");
        assert!(tree.layout() == MorphBvh::build(model, &options).layout());
    }

    #[test]
    fn a_task_on_another_thread_yields_and_goes_on() {
        let turns = Turns::with(Duration::ZERO);
        let yields = thread::spawn(move || {
            let woken = Arc::new(Woken::default());
            let waker = Waker::from(woken.clone());
            let options = BuildOptions::default();
            let mut task = pin!(turns.finish(MorphBvhBuilder::new(model(80), &options)));
            let mut polls = 0;
            while task.as_mut().poll(&mut Context::from_waker(&waker)).is_pending() {
                polls += 1;
                assert_eq!(woken.0.load(Ordering::Relaxed), polls, "whoever yields is polled again");
            }
            polls
        });
        assert!(yields.join().unwrap() >= 10);
    }

    #[test]
    fn tasks_share_the_time_of_a_frame() {
        let turns = Turns::with(Duration::from_millis(4));
        let mut context = Context::from_waker(Waker::noop());
        let mut is_ready = |took: u64| {
            let mut step = pin!(turns.after_step(Duration::from_millis(took)));
            // The first poll of a yield is never ready.
            step.as_mut().poll(&mut context).is_ready() || step.as_mut().poll(&mut context).is_ready()
        };
        assert_eq!([1, 1, 1, 1, 0].map(&mut is_ready), [true, true, true, false, false]);
        turns.begin_frame(Duration::ZERO);
        assert_eq!([3, 2].map(&mut is_ready), [true, false]);
        // The last frame took twice as long as usual, without what was done for tasks.
        turns.begin_frame(Duration::from_secs(1) / 30 + Duration::from_millis(5));
        assert_eq!([3, 2, 4].map(&mut is_ready), [true, true, false]);
        // It was slow only because of that, and because of copies.
        turns.spend(Duration::from_millis(80));
        assert_eq!(turns.begin_frame(Duration::from_millis(100)), 1.0);
        assert_eq!([4].map(&mut is_ready), [false]);
        assert_eq!(turns.begin_frame(Duration::from_secs(100)), LONGEST_FRAME);
    }
}
