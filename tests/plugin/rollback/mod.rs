//! Rollback: after going back to an earlier frame, runs report what they reported before, bit for bit.
//!
//! - `library`: saves and loads what a game registers, as a rollback library does.
//! - `stage`: an app and what lives in it. `operations`: what the game does. `rules`: its hooks. `banks`: entities whose order stays the same.
//! - `digest`: hashes of everything that the plugin reports; `observed`: of its entity events.
//! - `fixed`: ticks of a fixed schedule. `trees`: trees that are built or gone.

mod banks;
mod digest;
mod fixed;
mod library;
mod observed;
mod operations;
mod rules;
mod stage;
mod trees;

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use self::digest::Counts;
use self::library::Snapshot;
use self::stage::{Report, Stage};
use crate::support::{diagnostics, seeds};

const FRAMES: u32 = 200;
/// How far a rollback goes back.
const MOST: usize = 8;
/// The inputs of all players.
const PLAYERS: u64 = 0;

/// What lives had, to check that the test covers enough.
#[derive(Debug, Default)]
struct Covered {
    rollbacks: usize,
    again: usize,
    held: u64,
    swept: u64,
    refused: u64,
}

/// A life without rollback.
fn straight(seed: u64) -> (Vec<Report>, Counts) {
    let mut stage = Stage::new(seed);
    let reports = (1..=FRAMES).map(|_| stage.run(PLAYERS)).collect();
    (reports, stage.counts)
}

/// The same life with rollbacks: now and then some frames are predicted wrongly, and it goes back to one of the last frames.
fn with_rollbacks(seed: u64, expected: &[Report], covered: &mut Covered) {
    let mut rng = Pcg64Mcg::seed_from_u64(seed ^ 0xf00d);
    let mut stage = Stage::new(seed);
    let mut saved: VecDeque<(u32, Snapshot)> = VecDeque::new();
    saved.push_back((1, Snapshot::save(stage.app.world_mut())));
    while stage.frame <= FRAMES {
        advance(seed, &mut stage, expected, &mut saved);
        let now = diagnostics(&stage.app);
        covered.held += now.held_colliders;
        covered.swept += now.swept_pairs;
        covered.refused += now.skipped_hooks;
        if !rng.random_bool(0.25) {
            continue;
        }
        let last = stage.frame;
        for _ in 0..rng.random_range(0..4) {
            stage.run(PLAYERS + rng.random_range(1..9));
        }
        let back = rng.random_range(1..=saved.len());
        saved.truncate(back);
        let (frame, snapshot) = saved.back().expect("it is not empty");
        snapshot.load(stage.app.world_mut(), rng.random_bool(0.5));
        stage.frame = *frame;
        // Regions of lists that the rollback itself removes end at once.
        observed::take(stage.app.world_mut(), &mut Counts::default());
        let state = digest::state(stage.app.world_mut());
        if let Some(before) = frame.checked_sub(2) {
            let context = format!("seed {seed}: back at the end of frame {}", frame - 1);
            assert_eq!(state, expected[before as usize].state, "{context}");
        }
        covered.rollbacks += 1;
        while stage.frame < last {
            covered.again += 1;
            advance(seed, &mut stage, expected, &mut saved);
        }
    }
}

/// A frame with the right inputs, which is saved.
fn advance(seed: u64, stage: &mut Stage, expected: &[Report], saved: &mut VecDeque<(u32, Snapshot)>) {
    let frame = stage.frame;
    let report = stage.run(PLAYERS);
    assert_eq!(report, expected[frame as usize - 1], "seed {seed}, frame {frame}");
    if saved.len() > MOST {
        saved.pop_front();
    }
    saved.push_back((stage.frame, Snapshot::save(stage.app.world_mut())));
}

#[test]
fn frames_that_are_simulated_again_report_the_same_bits() {
    let seeds = seeds(4);
    let (mut covered, mut all) = (Covered::default(), Counts::default());
    for seed in 0..seeds {
        let (expected, counts) = straight(seed);
        with_rollbacks(seed, &expected, &mut covered);
        all.starts += counts.starts;
        all.impacts += counts.impacts;
        all.body_starts += counts.body_starts;
        all.self_starts += counts.self_starts;
        all.self_ends += counts.self_ends;
        all.observed += counts.observed;
        all.cast_hits += counts.cast_hits;
    }
    println!("{covered:?}, {all:?}");
    let seeds = seeds as usize;
    assert!(
        covered.rollbacks > 40 * seeds && covered.again > 100 * seeds,
        "{covered:?}"
    );
    assert!(
        covered.held > 50 * seeds as u64 && covered.swept > 10 * seeds as u64,
        "{covered:?}"
    );
    assert!(covered.refused > 5 * seeds as u64, "{covered:?}");
    assert!(all.starts > 100 * seeds && all.impacts > 4 * seeds, "{all:?}");
    assert!(all.observed > 50 * seeds && all.cast_hits > 50 * seeds, "{all:?}");
    assert!(all.self_starts > 4 * seeds && all.self_ends > 4 * seeds, "{all:?}");
}
