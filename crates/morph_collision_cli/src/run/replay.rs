//! The frame loop: sets weights, runs broad and narrow phase, and times the three.

use std::time::{Duration, Instant};

use morph_collision::batch::Wanted;
use morph_collision::{Aabb, QueryStats, TrianglePair, overlapping_pairs};

use super::{Mode, PairFinder};
use crate::cast::{Cast, Shape};
use crate::error::CliError;
use crate::messages::progress::Steps;

/// What a whole replay found and how long it took.
#[derive(Debug, Default)]
pub(crate) struct Replay {
    /// One entry per frame.
    pub(crate) frames: Vec<FrameCounts>,
    /// Summed over all frames.
    pub(crate) stats: QueryStats,
    /// Every hit in ascending order, if hits are kept.
    pub(crate) hits: Vec<Hit>,
}

/// What one frame found and how long it took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameCounts {
    /// Pairs of bodies that touch.
    pub(crate) body_pairs: u64,
    /// Pairs of triangles that intersect; with the modes `first` and `any` one per pair of bodies.
    pub(crate) pairs: u64,
    /// Time for weights, joints, broad phase and narrow phase, without sampling clips.
    pub(crate) time: Duration,
}

/// Two bodies that touch in a frame, `body_a < body_b`, and a pair of their triangles that intersect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hit {
    pub(crate) frame: usize,
    pub(crate) body_a: u32,
    pub(crate) body_b: u32,
    pub(crate) pair: TrianglePair,
}

/// Replays all frames. Hits are kept only if `keep_hits`, because there can be many.
pub(crate) fn replay(
    cast: &mut Cast<impl PairFinder>,
    mode: Mode,
    keep_hits: bool,
    progress: &Steps,
) -> Result<Replay, CliError> {
    let mut replay = Replay::default();
    let mut scratch = Buffers::default();
    let before = cast.method.work();
    for frame in 0..cast.frames.len() {
        let shapes = shapes(cast, frame);
        let start = Instant::now();
        pose(cast, frame, &shapes)?;
        let mut counts = scratch.collide(cast, frame, mode, replay.hits.len())?;
        counts.time = start.elapsed();

        replay.frames.push(counts);
        if keep_hits {
            scratch.hits.sort_unstable();
            replay.hits.extend(scratch.hits.iter().map(|hit| Hit { frame, ..*hit }));
        }
        progress.step();
    }
    replay.stats = cast.method.work() - before;
    Ok(replay)
}

/// The hits of one frame in ascending order. This counts as work like any other frame.
///
/// `kept` is the number of hits already in memory.
pub(crate) fn hits_of_frame(
    cast: &mut Cast<impl PairFinder>,
    mode: Mode,
    frame: usize,
    kept: usize,
) -> Result<Vec<Hit>, CliError> {
    let mut scratch = Buffers::default();
    let shapes = shapes(cast, frame);
    pose(cast, frame, &shapes)?;
    scratch.collide(cast, frame, mode, kept)?;
    scratch.hits.sort_unstable();
    scratch.hits.iter_mut().for_each(|hit| hit.frame = frame);
    Ok(scratch.hits)
}

/// The shapes of all bodies in a frame.
fn shapes(cast: &Cast<impl PairFinder>, frame: usize) -> Vec<Shape> {
    (0..cast.bodies).map(|body| cast.shape(frame, body)).collect()
}

/// Sets the weights, joints and placements of all bodies for a frame.
fn pose(cast: &mut Cast<impl PairFinder>, frame: usize, shapes: &[Shape]) -> Result<(), CliError> {
    for (body, shape) in shapes.iter().enumerate() {
        let set = cast.method.set(body, shape);
        set.map_err(|reason| cast.refused(frame, body, reason))?;
    }
    Ok(())
}

/// Memory reused from frame to frame.
#[derive(Default)]
struct Buffers {
    bounds: Vec<Option<Aabb>>,
    candidates: Vec<(u32, u32)>,
    pairs: Vec<TrianglePair>,
    /// Hits of the latest frame, unsorted, with the frame number not yet set.
    hits: Vec<Hit>,
}

impl Buffers {
    /// Broad and narrow phase over bodies whose weights and placements are set.
    ///
    /// Two bodies that collapse to the same point touch in every pair of their triangles. The search therefore fails with an
    /// error as soon as the memory limit has no room for more hits beside the `kept` ones.
    fn collide(
        &mut self,
        cast: &mut Cast<impl PairFinder>,
        frame: usize,
        mode: Mode,
        kept: usize,
    ) -> Result<FrameCounts, CliError> {
        let method = &mut cast.method;
        self.bounds.clear();
        self.bounds
            .extend((0..cast.bodies).map(|body| Some(method.world_bounds(body))));
        self.candidates.clear();
        overlapping_pairs(&self.bounds, &mut self.candidates);
        let room = cast.most_pairs.saturating_sub(kept);
        self.hits.clear();
        let mut counts = FrameCounts::default();
        for &(body_a, body_b) in &self.candidates {
            self.pairs.clear();
            let left = room.saturating_sub(self.hits.len());
            let wanted = match mode {
                Mode::All => Wanted::UpTo(left.saturating_add(1)),
                Mode::First | Mode::Any | Mode::Contacts | Mode::Distance => Wanted::First,
            };
            method.find(body_a as usize, body_b as usize, wanted, &mut self.pairs);
            if self.pairs.len() > left {
                return Err(CliError::TooManyPairs {
                    scene: cast.scene.clone(),
                    frame,
                    body_a,
                    body_b,
                    most: cast.most_pairs,
                });
            }
            counts.body_pairs += u64::from(!self.pairs.is_empty());
            self.hits.extend(self.pairs.iter().map(|&pair| Hit {
                frame: 0,
                body_a,
                body_b,
                pair,
            }));
        }
        counts.pairs = self.hits.len() as u64;
        Ok(counts)
    }
}
