//! The frame loop: weights, broad phase, narrow phase, and a stopwatch around the three.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use morph_collision::{QueryStats, TrianglePair};
use morph_collision_testkit::rivals::{BroadPhase, Method, Wanted};

use super::Mode;
use super::bodies::Cast;
use crate::error::CliError;

/// What a whole replay found and how long it took.
#[derive(Debug, Default)]
pub(crate) struct Replay {
    /// One entry per frame.
    pub(crate) frames: Vec<FrameCounts>,
    /// Summed over all frames.
    pub(crate) stats: QueryStats,
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

/// Two bodies that touch in a frame, `body_a < body_b`, and a pair of triangles that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Hit {
    pub(crate) frame: usize,
    pub(crate) body_a: u32,
    pub(crate) body_b: u32,
    pub(crate) pair: TrianglePair,
}

/// Replays all frames. Hits are kept only if `keep_hits`, since there can be many.
pub(crate) fn replay(cast: &mut Cast, mode: Mode, keep_hits: bool) -> Result<Replay, CliError> {
    let progress = progress_bar(cast.frames.len());
    let mut replay = Replay::default();
    let mut scratch = Scratch::default();
    let before = cast.method.work();
    for (frame, states) in cast.frames.iter().enumerate() {
        let start = Instant::now();
        for (body, state) in states.iter().enumerate() {
            let posed = cast.method.set_body(body, &state.weights, &state.world_from_model);
            posed.map_err(|reason| CliError::Frame {
                scene: cast.scene.clone(),
                frame,
                body,
                reason,
            })?;
        }
        let mut counts = scratch.collide(cast.method.as_mut(), cast.bodies, mode.wanted());
        counts.time = start.elapsed();

        replay.frames.push(counts);
        if keep_hits {
            scratch.hits.sort_unstable();
            replay.hits.extend(scratch.hits.iter().map(|hit| Hit { frame, ..*hit }));
        }
        progress.inc(1);
    }
    replay.stats = cast.method.work() - before;
    progress.finish_and_clear();
    Ok(replay)
}

/// Memory that frames reuse.
#[derive(Default)]
struct Scratch {
    broad_phase: BroadPhase,
    pairs: Vec<TrianglePair>,
    /// Of the latest frame, unsorted, its number not yet set.
    hits: Vec<Hit>,
}

impl Scratch {
    /// Broad and narrow phase over bodies whose weights and places are set.
    fn collide(&mut self, method: &mut dyn Method, bodies: usize, wanted: Wanted) -> FrameCounts {
        self.hits.clear();
        let mut counts = FrameCounts::default();
        for &(body_a, body_b) in self.broad_phase.pairs(method, bodies) {
            self.pairs.clear();
            method.collide(body_a as usize, body_b as usize, wanted, &mut self.pairs);
            counts.body_pairs += u64::from(!self.pairs.is_empty());
            self.hits.extend(self.pairs.iter().map(|&pair| Hit {
                frame: 0,
                body_a,
                body_b,
                pair,
            }));
        }
        counts.pairs = self.hits.len() as u64;
        counts
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
