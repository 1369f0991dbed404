//! Builds contacts on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use morph_collision::{QueryStats, Workers};

use super::touch::{Found, Touch};
use super::{Asked, Pair, Placed};
use crate::contacts::MorphContact;
use crate::workers::TaskPoolWorkers;

/// Fewer contacts than this are built on the calling thread. Waking a thread takes as long as a dozen pairs that do not touch.
const MIN_CONTACTS: usize = 16;

/// A pair for which a contact might have to be built, and what is known about it.
pub(super) struct Job {
    pub(super) asked: Asked,
    pub(super) found: Found,
}

/// One [`Builder`] per thread, kept for their memory.
#[derive(Default)]
pub(super) struct Builders(Vec<Mutex<Builder>>);

#[derive(Default)]
struct Builder {
    touch: Touch,
    stats: QueryStats,
    answers: Vec<(Pair, Option<MorphContact>)>,
}

impl Builders {
    /// Builds the contacts of all jobs and appends the answers, in any order. Returns the work done.
    ///
    /// Threads take all successive jobs with the same first collider at once, so they rarely wait for each other's poses.
    pub(super) fn run(
        &mut self,
        placed: &[Placed<'_>],
        jobs: &mut [Job],
        limit: usize,
        answers: &mut Vec<(Pair, Option<MorphContact>)>,
    ) -> QueryStats {
        let count = jobs.len();
        let blocks: Vec<Mutex<&mut [Job]>> = jobs
            .chunk_by_mut(|one, other| one.asked.places.0 == other.asked.places.0)
            .map(Mutex::new)
            .collect();
        let threads = if count < MIN_CONTACTS {
            1
        } else {
            TaskPoolWorkers.count()
        };
        self.0.resize_with(threads.max(self.0.len()), Mutex::default);
        let (builders, next) = (&self.0, AtomicUsize::new(0));
        let work = |thread: usize| {
            let mut builder = builders[thread].lock().unwrap_or_else(PoisonError::into_inner);
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                for job in &mut **block.lock().unwrap_or_else(PoisonError::into_inner) {
                    builder.build(placed, job, limit);
                }
            }
        };
        if threads == 1 {
            work(0);
        } else {
            TaskPoolWorkers.run(&work);
        }
        let mut stats = QueryStats::default();
        for builder in &mut self.0 {
            let builder = builder.get_mut().unwrap_or_else(PoisonError::into_inner);
            stats += std::mem::take(&mut builder.stats);
            answers.append(&mut builder.answers);
        }
        stats
    }
}

impl Builder {
    fn build(&mut self, placed: &[Placed<'_>], job: &mut Job, limit: usize) {
        let contact = self
            .touch
            .contact(placed, job.asked, &mut job.found, limit, &mut self.stats);
        self.answers.push((job.asked.pair, contact));
    }
}
