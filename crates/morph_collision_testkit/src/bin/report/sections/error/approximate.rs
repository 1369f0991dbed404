//! Answers that may be off, as a method like the others.

use glam::Affine3A;
use morph_collision::{
    Aabb, ApproximatePairs, ApproximatePose, ApproximateQuery, Approximation, Body, BuildOptions, InputError, MorphBvh,
    PairQuery, QueryStats, TrianglePair, WorldFromModel,
};
use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::rivals::{Method, PoseError, Wanted};
use std::error::Error;
use std::sync::Arc;

/// What may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leave {
    /// Triangles at most so far apart pass for intersecting, in world units.
    Tolerance(f64),
    /// Work ends after so many tests for a pair of bodies.
    Budget(u64),
    /// Vertices may be displaced by so much, in model units.
    Displacement(f64),
}

/// Bodies that are asked for all pairs, as far as the limits let them be known.
#[derive(Debug)]
pub(super) struct ApproximateMorph {
    /// Exact ones where the displacement is 0.
    bodies: Vec<(ApproximatePose, WorldFromModel)>,
    limits: Option<Approximation>,
    approximate: ApproximateQuery,
    exact: PairQuery,
    work: QueryStats,
}

impl ApproximateMorph {
    pub(super) fn new(experiment: &Experiment, leave: Leave) -> Result<Self, Box<dyn Error>> {
        let model = Arc::new(experiment.mesh.to_model()?);
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default())?);
        let displacement = match leave {
            Leave::Displacement(displacement) => displacement,
            Leave::Tolerance(_) | Leave::Budget(_) => 0.0,
        };
        let body = |_| {
            (
                ApproximatePose::new(Arc::clone(&bvh), displacement),
                WorldFromModel::IDENTITY,
            )
        };
        Ok(Self {
            bodies: (0..experiment.bodies).map(body).collect(),
            limits: limits(leave)?,
            approximate: ApproximateQuery::new(),
            exact: PairQuery::new(),
            work: QueryStats::default(),
        })
    }

    /// All that is known of two bodies.
    pub(super) fn answer(&mut self, a: usize, b: usize) -> ApproximatePairs {
        let Ok([(a, at_a), (b, at_b)]) = self.bodies.get_disjoint_mut([a, b]) else {
            return ApproximatePairs::default();
        };
        let (limits, approximate, exact) = (&self.limits, &mut self.approximate, &mut self.exact);
        let both = a.ask(|a| {
            b.ask(|b| {
                let (a, b) = (Body::new(a, at_a), Body::new(b, at_b));
                match limits {
                    Some(limits) => approximate.all(a, b, limits),
                    None => {
                        let mut answer = ApproximatePairs::default();
                        answer.stats = exact.all(a, b, &mut answer.touching);
                        answer
                    }
                }
            })
        });
        both.answer.answer
    }

    /// The weights of a body's shape in use, and what no vertex of it should be farther off than.
    pub(super) fn shape_in_use(&self, body: usize) -> (&[f32], f64) {
        let pose = &self.bodies[body].0;
        (pose.weights_in_use(), pose.displacement())
    }
}

fn limits(leave: Leave) -> Result<Option<Approximation>, InputError> {
    Ok(match leave {
        Leave::Tolerance(tolerance) => Some(Approximation::new().with_tolerance(tolerance)?),
        Leave::Budget(tests) => Some(Approximation::new().with_budget(tests)),
        Leave::Displacement(_) => None,
    })
}

impl Method for ApproximateMorph {
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let (pose, place) = &mut self.bodies[body];
        let next = WorldFromModel::new(*world_from_model)?;
        pose.set_weights(weights)?;
        *place = next;
        Ok(false)
    }

    fn refit(&mut self, _: usize) {}

    fn is_lazy(&self) -> bool {
        true
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let (pose, place) = &mut self.bodies[body];
        pose.ask(|pose| pose.world_bounds(place)).answer
    }

    /// All pairs that are known to intersect, whatever is wanted.
    fn collide(&mut self, a: usize, b: usize, _: Wanted, pairs: &mut Vec<TrianglePair>) {
        let answer = self.answer(a, b);
        self.work += answer.stats;
        pairs.extend(answer.touching);
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
