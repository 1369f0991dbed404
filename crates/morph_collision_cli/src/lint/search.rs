//! Tries shapes on several threads.

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Affine3A;
use morph_collision::{
    Body, JointMatrices, MorphBvh, Pose, SelfDistanceQuery, SelfQuery, TrianglePair, WorldFromModel,
};

use super::findings::Finding;
use super::poses::Tried;
use super::regions::{Region, regions};
use crate::error::PoseError;
use crate::touching::depth::{ThresholdArgs, depth};

/// Pairs of triangles that are not reported.
pub(super) type Known = HashSet<TrianglePair>;

/// At most this many new pairs of a shape are looked at. A shape that collapses the mesh has far more.
pub(super) const MOST_PAIRS: usize = 20_000;

/// At most this many new pairs of a shape are measured to find those that are deep enough.
const MOST_MEASURED: usize = 10 * MOST_PAIRS;

/// Which pairs of triangles count.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rules {
    /// The first triangle of the garment. Only pairs of one of its triangles and one of the mesh's count.
    pub(super) garment_from: Option<u32>,
    pub(super) thresholds: ThresholdArgs,
}

/// What a shape does that the rest shape does not.
#[derive(Debug, Default)]
pub(super) struct NewPairs {
    /// The new pairs, ascending.
    pub(super) pairs: Vec<TrianglePair>,
    pub(super) regions: Vec<Region>,
    /// Whether there are more than [`MOST_PAIRS`].
    pub(super) is_truncated: bool,
}

/// A pose to try shapes on. Each thread has its own.
#[derive(Debug)]
pub(super) struct Searcher {
    pose: Pose,
    query: SelfQuery,
    distances: SelfDistanceQuery,
    rules: Rules,
}

impl Searcher {
    pub(super) fn new(tree: &Arc<MorphBvh>, rules: Rules) -> Self {
        Self {
            pose: Pose::new(Arc::clone(tree)),
            query: SelfQuery::new(),
            distances: SelfDistanceQuery::new(),
            rules,
        }
    }

    /// The pairs of triangles that count in a shape and are not in any of the lists, ascending: at most `most`, and whether there are more.
    pub(super) fn new_pairs(
        &mut self,
        shape: &Tried,
        known: &[&Known],
        most: usize,
    ) -> Result<(Vec<TrianglePair>, bool), PoseError> {
        self.set(shape.joints.as_deref(), &shape.weights)?;
        let Rules {
            garment_from,
            thresholds: ThresholdArgs { min_depth, gap },
        } = self.rules;
        let (mut pairs, mut is_truncated) = (Vec::new(), false);
        let room = min_depth.map_or(most, |_| most.max(MOST_MEASURED));
        let mut look = |pair: TrianglePair| {
            let is_of_one = garment_from.is_some_and(|from| (pair.triangle_a < from) == (pair.triangle_b < from));
            if is_of_one || known.iter().any(|known| known.contains(&pair)) {
                return ControlFlow::Continue(());
            }
            if pairs.len() == room {
                is_truncated = true;
                return ControlFlow::Break(());
            }
            pairs.push(pair);
            ControlFlow::Continue(())
        };
        match gap {
            None => self.query.visit(&mut self.pose, look),
            Some(gap) => self
                .distances
                .within(&mut self.pose, gap, |found| look(found.triangles))?,
        }
        pairs.sort_unstable();
        if let Some(least) = min_depth {
            let mut body = Body::new(&mut self.pose, &WorldFromModel::IDENTITY);
            pairs.retain(|pair| {
                let corners = body.triangle(pair.triangle_a).zip(body.triangle(pair.triangle_b));
                corners.is_some_and(|(a, b)| depth(&a, &b) >= least)
            });
            is_truncated |= pairs.len() > most;
            pairs.truncate(most);
        }
        Ok((pairs, is_truncated))
    }

    /// A pose in the worst shape of a finding.
    pub(super) fn pose_of(&mut self, finding: &Finding) -> Result<&mut Pose, PoseError> {
        self.set(finding.joints.as_deref(), &finding.weights)?;
        Ok(&mut self.pose)
    }

    fn set(&mut self, joints: Option<&[Affine3A]>, weights: &[f32]) -> Result<(), PoseError> {
        if let Some(joints) = joints {
            self.pose.set_joints(&JointMatrices::new(joints)?)?;
        }
        self.pose.set_weights(weights)?;
        Ok(())
    }

    /// What a shape does that is not known yet.
    pub(super) fn find(&mut self, shape: &Tried, known: &[&Known]) -> Result<NewPairs, PoseError> {
        let (pairs, is_truncated) = self.new_pairs(shape, known, MOST_PAIRS)?;
        Ok(NewPairs {
            regions: regions(&mut self.pose, &pairs),
            pairs,
            is_truncated,
        })
    }
}

/// Does `work` for every index below `count`, on one thread for each of `states`, and passes the results to `sink` in order. For one state, this
/// thread does it: a web page has no others.
pub(super) fn in_order<S: Send, R: Send, E>(
    states: &mut [S],
    count: usize,
    work: impl Fn(&mut S, usize) -> R + Sync,
    mut sink: impl FnMut(usize, R) -> Result<(), E>,
) -> Result<(), E> {
    /// Results are kept until all shapes of a batch are tried.
    const BATCH_PER_THREAD: usize = 16;
    let batch = states.len() * BATCH_PER_THREAD;
    for start in (0..count).step_by(batch.max(1)) {
        let next = AtomicUsize::new(start);
        let end = count.min(start + batch);
        let run = |state: &mut S| {
            let mut done = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                if index >= end {
                    return done;
                }
                done.push((index, work(state, index)));
            }
        };
        let mut results: Vec<(usize, R)> = match states {
            [state] => run(state),
            _ => std::thread::scope(|scope| {
                let threads: Vec<_> = states.iter_mut().map(|state| scope.spawn(|| run(state))).collect();
                let joined = threads.into_iter().flat_map(|thread| match thread.join() {
                    Ok(done) => done,
                    Err(panic) => std::panic::resume_unwind(panic),
                });
                joined.collect()
            }),
        };
        results.sort_unstable_by_key(|(index, _)| *index);
        for (index, result) in results {
            sink(index, result)?;
        }
    }
    Ok(())
}
