//! Many questions about one body.

use std::sync::{Mutex, PoisonError, RwLock};

use super::lock::{locked, unlocked};
use super::questions::QuestionBatch;
use super::workers::Workers;
use crate::pose::Pose;
use crate::query::{Body, QueryStats};

/// A query about one body.
pub(in crate::query) trait OneBodyQuery: Default + Send + Sync {
    /// Returns the work done by the last call.
    fn work(&self) -> QueryStats;
}

/// Memory for many questions about one body.
#[derive(Debug, Default)]
pub(in crate::query) struct OneBodyBatch<Q> {
    pub(in crate::query) questions: QuestionBatch,
    /// One entry per worker. The first worker has the caller's query and pose instead.
    helpers: Vec<Mutex<Helper<Q>>>,
}

/// What a worker works with.
#[derive(Debug, Default)]
struct Helper<Q> {
    query: Q,
    /// A copy of the body's pose.
    pose: Option<Pose>,
    work: QueryStats,
}

/// What a worker remembers from question to question: the triangle of its latest answer.
pub(in crate::query) type Latest = Option<u32>;

/// The number of questions that the caller's thread answers before others are woken, to see how much work the rest is.
const SAMPLE: usize = 64;
/// Tests of boxes and triangles for which waking a thread pays: they take about a millisecond. Not measured on a quiet machine.
const MIN_TESTS: usize = 20_000;
/// Tests that take longer than copying a vertex and its share of the boxes. Not measured on a quiet machine.
const TESTS_PER_VERTEX: usize = 2;

impl<Q: OneBodyQuery> OneBodyBatch<Q> {
    /// Answers the sorted questions with `ask`. Replaces `answers`, which are `none` at first. Returns the work.
    ///
    /// An answer must not depend on the latest one, only the work that it takes. The questions are spread over workers if that pays.
    pub(in crate::query) fn run<A: Clone + Send>(
        &mut self,
        query: &mut Q,
        mut body: Body<'_>,
        workers: &dyn Workers,
        (answers, none): (&mut Vec<A>, A),
        ask: impl Fn(&mut Q, Body<'_>, u32, &mut Latest) -> A + Sync,
    ) -> QueryStats {
        let count = self.questions.order().len();
        answers.clear();
        answers.resize(count, none);
        let mut latest = None;
        let mut answer = |mut body: Body<'_>, questions: &[u32]| {
            questions.iter().fold(QueryStats::default(), |work, &question| {
                answers[question as usize] = ask(query, body.reborrow(), question, &mut latest);
                work + query.work()
            })
        };
        if workers.count() < 2 || count < 4 * SAMPLE {
            return answer(body, self.questions.order());
        }
        let work = answer(body.reborrow(), &self.questions.take_sample(SAMPLE));
        let of_sample = work.node_tests + work.triangle_tests;
        let tests = of_sample.saturating_mul(self.questions.order().len() as u64) / SAMPLE as u64;
        let worth_waking = MIN_TESTS + TESTS_PER_VERTEX * body.pose.bvh().model().vertex_count();
        let parts = (tests / worth_waking as u64).min(workers.count() as u64) as usize;
        if parts < 2 {
            return work + answer(body, self.questions.order());
        }
        work + self.spread((query, body), (parts, workers), answers, ask)
    }

    /// Answers the questions on several workers.
    fn spread<A: Send>(
        &mut self,
        own: (&mut Q, Body<'_>),
        (parts, workers): (usize, &dyn Workers),
        answers: &mut [A],
        ask: impl Fn(&mut Q, Body<'_>, u32, &mut Latest) -> A + Sync,
    ) -> QueryStats {
        if self.helpers.len() < parts {
            self.helpers.resize_with(parts, Default::default);
        }
        let world_from_model = own.1.world_from_model;
        // The first worker locks it while it answers a chunk, the others while they copy the pose.
        let own = RwLock::new(own);
        let helpers = &self.helpers;
        self.questions
            .answer(parts, workers, answers, |worker, mut chunks, found| {
                let Helper { query, pose, work } = &mut *locked(&helpers[worker]);
                *work = QueryStats::default();
                let mut latest = None;
                let mut answer = |query: &mut Q, mut body: Body<'_>, questions: &[u32]| {
                    for &question in questions {
                        found.push((question, ask(query, body.reborrow(), question, &mut latest)));
                        *work += query.work();
                    }
                };
                if worker == 0 {
                    for chunk in chunks {
                        let (query, body) = &mut *own.write().unwrap_or_else(PoisonError::into_inner);
                        answer(query, body.reborrow(), chunk);
                    }
                } else if let Some(first) = chunks.next() {
                    let (_, body) = &*own.read().unwrap_or_else(PoisonError::into_inner);
                    let pose = Pose::copied(pose, body.pose);
                    for chunk in std::iter::once(first).chain(chunks) {
                        answer(query, Body::new(pose, world_from_model), chunk);
                    }
                }
            });
        let helpers = self.helpers.iter_mut().take(parts);
        helpers.fold(QueryStats::default(), |sum, helper| sum + unlocked(helper).work)
    }
}
