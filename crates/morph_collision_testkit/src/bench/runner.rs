//! Runs an experiment's frames with one contender.

use std::time::Duration;

use morph_collision::QueryStats;

use super::{Answer, Contender, Experiment, Questions, Stopwatch};
use crate::rivals::{Method, PoseError};
use morph_collision::batch::Wanted;

/// A contender, and memory that its frames reuse.
#[derive(Debug)]
pub(super) struct Runner {
    pub(super) name: String,
    method: Box<dyn Method>,
    questions: Questions,
    /// Bodies whose volumes need an update.
    moved: Vec<usize>,
    /// The reading of an idle stopwatch.
    idle: Duration,
}

/// A contender's results in one pass over all frames; lists have an entry per frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Pass {
    pub(super) work: QueryStats,
    pub(super) found: Vec<Answer>,
    pub(super) times: Vec<Duration>,
}

/// Time by phase, over all frames of a pass.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SplitPass {
    pub(super) blend: Duration,
    pub(super) refit: Duration,
    pub(super) query: Duration,
}

impl Runner {
    pub(super) fn new(contender: Contender) -> Self {
        Self {
            name: contender.name,
            method: contender.method,
            questions: Questions::default(),
            moved: Vec::new(),
            idle: Stopwatch::idle(),
        }
    }

    /// Times every frame as a whole.
    pub(super) fn pass(&mut self, experiment: &Experiment, wanted: Wanted) -> Result<Pass, PoseError> {
        self.begin(experiment)?;
        let mut pass = Pass::default();
        for index in 0..experiment.frames.len() {
            self.questions
                .prepare(experiment, index, self.method.as_mut(), wanted)?;
            let before = self.method.work();
            let clock = Stopwatch::start();
            experiment.set_bodies(self.method.as_mut(), index)?;
            let found = self.questions.answer(experiment, index, self.method.as_mut(), wanted);
            pass.times.push(self.since(clock));
            pass.found.push(found);
            pass.work += self.method.work() - before;
        }
        Ok(pass)
    }

    /// Times every frame in parts.
    pub(super) fn split_pass(&mut self, experiment: &Experiment, wanted: Wanted) -> Result<SplitPass, PoseError> {
        self.begin(experiment)?;
        let mut split = SplitPass::default();
        for (index, frame) in experiment.frames.iter().enumerate() {
            self.questions
                .prepare(experiment, index, self.method.as_mut(), wanted)?;
            self.moved.clear();
            let clock = Stopwatch::start();
            for (body, (weights, place)) in frame.iter().enumerate() {
                if let Some(joints) = experiment.joints_of(index, body) {
                    self.method.set_joints(body, joints)?;
                }
                if self.method.blend(body, weights, place)? {
                    self.moved.push(body);
                }
            }
            split.blend += self.since(clock);
            let clock = Stopwatch::start();
            for &body in &self.moved {
                self.method.refit(body);
            }
            split.refit += self.since(clock);
            let mut query = self.time_asking(experiment, index, wanted);
            if self.method.is_lazy() {
                let again = self.time_asking(experiment, index, wanted).min(query);
                split.refit += query - again;
                query = again;
            }
            split.query += query;
        }
        Ok(split)
    }

    /// Gives bodies weights that the first frame changes. Otherwise a pass of one frame would find everything
    /// done.
    fn begin(&mut self, experiment: &Experiment) -> Result<(), PoseError> {
        for (body, (weights, place)) in experiment.frames.iter().take(1).flatten().enumerate() {
            let others: Vec<f32> = weights.iter().map(|weight| 0.5 * weight + 0.125).collect();
            self.method.set_body(body, &others, place)?;
        }
        Ok(())
    }

    fn time_asking(&mut self, experiment: &Experiment, index: usize, wanted: Wanted) -> Duration {
        let clock = Stopwatch::start();
        self.questions.answer(experiment, index, self.method.as_mut(), wanted);
        self.since(clock)
    }

    fn since(&self, clock: Stopwatch) -> Duration {
        clock.elapsed().saturating_sub(self.idle)
    }
}
