//! Two bodies in a step of the paper's experiments, for both kinds of benchmark.

use std::sync::Arc;

use glam::DVec3;
use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, Ray, WorldFromModel};
use morph_collision_testkit::bench::Experiment;

/// The placement of two bodies of the pass-through, or of two of the dolphins.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scene {
    /// Pass-through, 20480 triangles, deep inside each other.
    PassThroughDeep,
    /// The same, shortly after first contact.
    PassThroughShallow,
    /// Dolphins of 9024 triangles: the two of a step with the most pairs.
    DolphinsDeep,
    /// The two that touch with the fewest pairs.
    DolphinsShallow,
    /// Talking heads of 9534 triangles with about 40 active targets, cheek to cheek.
    HeadsCheek,
    /// The pass-through before first contact.
    Apart,
}

impl Scene {
    fn step(self) -> usize {
        match self {
            Self::PassThroughDeep => 200,
            Self::DolphinsDeep | Self::DolphinsShallow => 160,
            Self::PassThroughShallow => 50,
            Self::HeadsCheek => 100,
            Self::Apart => 20,
        }
    }

    fn experiment(self) -> Experiment {
        match self {
            Self::DolphinsDeep | Self::DolphinsShallow => Experiment::dolphins(2, self.step()),
            Self::PassThroughDeep | Self::PassThroughShallow | Self::Apart => Experiment::pass_through(5, self.step()),
            Self::HeadsCheek => Experiment::named("heads-cheek", self.step()).expect("the head in assets/"),
        }
    }
}

/// Two bodies of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Two {
    pub(crate) poses: [Pose; 2],
    pub(crate) places: [WorldFromModel; 2],
    pub(crate) weights: [Vec<f32>; 2],
    other_weights: [Vec<f32>; 2],
}

impl Two {
    /// A scene's bodies, with nothing blended yet.
    ///
    /// # Panics
    /// If the scene's mesh, weights or placements are refused, which would be a bug.
    pub(crate) fn new(scene: Scene) -> Self {
        let experiment = scene.experiment();
        let model = Arc::new(experiment.mesh.to_model().expect("the scene's mesh"));
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
        let frame = &experiment.frames[1];
        let body = |index: usize| {
            let (weights, place) = &frame[index];
            (weights.clone(), WorldFromModel::new(*place).expect("the scene's place"))
        };
        let two = |a: usize, b: usize| {
            let (weights, places): (Vec<_>, Vec<_>) = [body(a), body(b)].into_iter().unzip();
            let weights: [Vec<f32>; 2] = [weights[0].clone(), weights[1].clone()];
            let mut two = Self {
                poses: [Pose::new(Arc::clone(&bvh)), Pose::new(Arc::clone(&bvh))],
                places: [places[0], places[1]],
                other_weights: weights
                    .clone()
                    .map(|own| own.iter().map(|weight| 0.5 * weight + 0.125).collect()),
                weights,
            };
            two.forget();
            two
        };
        let candidates = (0..experiment.bodies).flat_map(|b| (0..b).map(move |a| (a, b)));
        let counted = candidates.map(|(a, b)| {
            let mut bodies = two(a, b);
            let (a, b) = bodies.bodies();
            let mut pairs = Vec::new();
            PairQuery::new().all(a, b, &mut pairs);
            (pairs.len(), bodies)
        });
        let chosen = match scene {
            Scene::DolphinsShallow => counted.filter(|(pairs, _)| *pairs > 0).min_by_key(|(pairs, _)| *pairs),
            _ => counted.max_by_key(|(pairs, _)| *pairs),
        };
        let mut chosen = chosen.expect("two bodies that touch").1;
        chosen.forget();
        chosen
    }

    /// Resets the poses, so that everything has to be blended again.
    pub(crate) fn forget(&mut self) {
        for ((pose, others), own) in self.poses.iter_mut().zip(&self.other_weights).zip(&self.weights) {
            for weights in [others, own] {
                pose.set_weights(weights).expect("the scene's weights");
            }
        }
    }

    /// The bodies, ready to be queried.
    pub(crate) fn bodies(&mut self) -> (Body<'_>, Body<'_>) {
        let ([a, b], [at_a, at_b]) = (&mut self.poses, &self.places);
        (Body::new(a, at_a), Body::new(b, at_b))
    }

    /// A ray from outside through the middle of the first body.
    pub(crate) fn ray(&mut self) -> Ray {
        let bounds = self.poses[0].world_bounds(&self.places[0]);
        let middle = bounds.center().as_dvec3();
        let from = middle + DVec3::new(3.0, 2.0, 1.0);
        Ray::new(from, middle - from, f64::INFINITY).expect("a ray of finite numbers")
    }
}
