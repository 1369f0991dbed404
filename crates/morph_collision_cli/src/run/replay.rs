//! The frame loop: weights, broad phase, narrow phase, and a stopwatch around the three.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use morph_collision::{Body, PairQuery, PairStats, Pose, TrianglePair, overlapping_pairs};

use super::Mode;
use super::bodies::{BodyState, Cast};
use crate::error::CliError;

/// What a whole replay found and how long it took.
#[derive(Debug, Default)]
pub(crate) struct Replay {
    /// One entry per frame.
    pub(crate) frames: Vec<FrameCounts>,
    /// Summed over all frames.
    pub(crate) stats: PairStats,
    /// Every hit in ascending order, if they were to be kept.
    pub(crate) hits: Vec<Hit>,
}

/// What one frame found and how long it took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameCounts {
    /// Pairs of bodies that touch.
    pub(crate) body_pairs: u64,
    /// Pairs of triangles that meet; with the modes `first` and `any` one per pair of bodies.
    pub(crate) pairs: u64,
    /// Weights, broad phase and narrow phase.
    pub(crate) time: Duration,
}

/// Two bodies that touch in a frame, `body_a < body_b`, and where; `None` if that was not asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hit {
    pub(crate) frame: usize,
    pub(crate) body_a: u32,
    pub(crate) body_b: u32,
    pub(crate) triangles: Option<TrianglePair>,
}

/// Replays all frames. Hits are kept only if `keep_hits`, since there can be many.
pub(crate) fn replay(cast: &mut Cast, mode: Mode, keep_hits: bool) -> Result<Replay, CliError> {
    let progress = progress_bar(cast.frames.len());
    let mut replay = Replay::default();
    let mut scratch = Scratch::default();
    for (frame, states) in cast.frames.iter().enumerate() {
        let start = Instant::now();
        for (body, (pose, state)) in cast.poses.iter_mut().zip(states).enumerate() {
            pose.set_weights(&state.weights).map_err(|error| CliError::Frame {
                scene: cast.scene.clone(),
                frame,
                body,
                reason: error.into(),
            })?;
        }
        let (mut counts, stats) = scratch.collide(&mut cast.poses, states, mode);
        counts.time = start.elapsed();

        replay.frames.push(counts);
        replay.stats += stats;
        if keep_hits {
            scratch.hits.sort_unstable();
            replay.hits.extend(scratch.hits.iter().map(|hit| Hit { frame, ..*hit }));
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(replay)
}

/// Memory that frames reuse.
#[derive(Default)]
struct Scratch {
    bounds: Vec<Option<morph_collision::Aabb>>,
    candidates: Vec<(u32, u32)>,
    query: PairQuery,
    pairs: Vec<TrianglePair>,
    /// Of the latest frame, unsorted, its number not yet set.
    hits: Vec<Hit>,
}

impl Scratch {
    /// Broad and narrow phase over bodies whose weights are set.
    fn collide(&mut self, poses: &mut [Pose], states: &[BodyState], mode: Mode) -> (FrameCounts, PairStats) {
        self.bounds.clear();
        self.bounds.extend(
            poses
                .iter_mut()
                .zip(states)
                .map(|(pose, state)| Some(pose.world_bounds(&state.world_from_model))),
        );
        self.candidates.clear();
        overlapping_pairs(&self.bounds, &mut self.candidates);

        self.hits.clear();
        let (mut counts, mut stats) = (FrameCounts::default(), PairStats::default());
        for &(body_a, body_b) in &self.candidates {
            // The pair is ascending, so that a lies before the split and b behind it.
            let (a, b) = (body_a as usize, body_b as usize);
            let (before, behind) = poses.split_at_mut(b);
            let (body_of_a, body_of_b) = (
                Body::new(&mut before[a], &states[a].world_from_model),
                Body::new(&mut behind[0], &states[b].world_from_model),
            );
            let before_pair = self.hits.len();
            let hit = |triangles| Hit {
                frame: 0,
                body_a,
                body_b,
                triangles,
            };
            stats += match mode {
                Mode::All => {
                    self.pairs.clear();
                    let stats = self.query.all(body_of_a, body_of_b, &mut self.pairs);
                    self.hits.extend(self.pairs.iter().map(|&pair| hit(Some(pair))));
                    stats
                }
                Mode::First => {
                    let (pair, stats) = self.query.first(body_of_a, body_of_b);
                    self.hits.extend(pair.map(|pair| hit(Some(pair))));
                    stats
                }
                Mode::Any => {
                    let (touching, stats) = self.query.any(body_of_a, body_of_b);
                    self.hits.extend(touching.then(|| hit(None)));
                    stats
                }
            };
            counts.body_pairs += u64::from(self.hits.len() > before_pair);
        }
        counts.pairs = self.hits.len() as u64;
        (counts, stats)
    }
}

/// A live bar on stderr, or nothing where nobody watches.
fn progress_bar(frames: usize) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(frames as u64);
    match ProgressStyle::with_template("frame {pos}/{len} [{bar:40}] {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
