//! The frames of an experiment as batches, on any number of threads.

use std::error::Error;
use std::sync::Arc;

use morph_collision::batch::Wanted;
use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel, overlapping_pairs};
use morph_collision_testkit::bench::{Experiment, Frame};

/// The bodies of an experiment, queried in batches.
pub(super) struct Run {
    poses: Vec<Pose>,
    query: BatchQuery,
}

impl Run {
    pub(super) fn new(experiment: &Experiment) -> Result<Self, Box<dyn Error>> {
        let model = Arc::new(experiment.mesh.to_model()?);
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
        Ok(Self {
            poses: (0..experiment.bodies).map(|_| Pose::new(bvh.clone())).collect(),
            query: BatchQuery::new(),
        })
    }

    /// Runs all frames; returns the number of pairs.
    pub(super) fn pass(&mut self, experiment: &Experiment, wanted: Wanted, threads: usize) -> usize {
        experiment
            .frames
            .iter()
            .map(|frame| self.frame(frame, wanted, threads))
            .sum()
    }

    fn frame(&mut self, frame: &Frame, wanted: Wanted, threads: usize) -> usize {
        let mut places = Vec::with_capacity(frame.len());
        let mut bounds = Vec::with_capacity(frame.len());
        for (pose, (weights, place)) in self.poses.iter_mut().zip(frame) {
            // The scripts' weights and placements are valid.
            let _ = pose.set_weights(weights);
            let place = WorldFromModel::new(*place).unwrap_or(WorldFromModel::IDENTITY);
            bounds.push(Some(pose.world_bounds(&place)));
            places.push(place);
        }
        let mut overlaps = Vec::new();
        overlapping_pairs(&bounds, &mut overlaps);
        let task = |&(a, b): &(u32, u32)| PairTask::new(a as usize, b as usize, wanted);
        let mut tasks: Vec<_> = overlaps.iter().map(task).collect();
        let mut bodies: Vec<_> = self
            .poses
            .iter_mut()
            .zip(&places)
            .map(|(pose, place)| Body::new(pose, place))
            .collect();
        let workers = ThreadWorkers::new(threads);
        let answers = self.query.run(&mut bodies, &mut tasks, &workers);
        answers.iter().map(<[_]>::len).sum()
    }
}
