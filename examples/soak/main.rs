//! A game without a window that plays for hours of its own time. Characters come and go, animations play, bodies fall on a morphing hill, rays
//! and shapes are cast, assets are reloaded, and components are added and removed.
//!
//! While it plays it checks what a player would notice only after hours: memory that grows, contacts that never end, and frames with too much
//! work. All random choices come from a seed, so two runs print the same hash of everything that was reported. Bodies of Rapier are not part of
//! it: without its feature `enhanced-determinism`, which compiles all of Bevy anew, its tables are in a random order, and bodies differ in their
//! last bits. `just soak` compares two runs; `--help` lists the options.
//!
//! - `stage`: the app, its models, and waiting for what is done in the background.
//! - `game`, `actors`, `operations`: what happens in a frame.
//! - `questions`: rays, shapes and points. `digest`: the hash.
//! - `balance`: what started and ended. `work`: work and time of frames. `memory`: memory and entities.
//! - `report`: what is printed at the end.

mod actors;
mod balance;
mod digest;
mod game;
mod memory;
mod operations;
mod questions;
mod report;
mod stage;
mod work;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::outcome::{exit_code, print_report};
use peak_alloc::PeakAlloc;
use thiserror::Error;

use self::balance::Balance;
use self::digest::Digest;
use self::game::{CYCLE, EMPTY, Game};
use self::memory::Memory;
use self::report::Report;
use self::stage::Stage;
use self::work::Work;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Play a game for hours of its own time, and check that nothing leaks.
#[derive(Parser)]
struct Options {
    /// Frames of 1/60 s each: 1,728,000 are eight hours. Rounded up to whole cycles, at whose ends everything is despawned.
    #[arg(long, default_value_t = 36_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    frames: u64,
    /// Random seed for all that happens.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Load models again also while they are on the stage. Bevy then spawns them anew, in an order that depends on when they are loaded, so the hashes of
    /// two runs differ.
    #[arg(long)]
    reload_in_play: bool,
    /// Write a line to standard error after this many frames; 0 for none.
    #[arg(long, default_value_t = 0, value_name = "FRAMES")]
    progress: u64,
    /// The folder of the models.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/assets"), value_name = "DIR")]
    assets: PathBuf,
    /// Print only the result, as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Why a run ended early.
#[derive(Debug, Error)]
pub(crate) enum SoakError {
    #[error(transparent)]
    Example(#[from] ExampleError),
    #[error("frame {frame}: {what}")]
    Fault { frame: u64, what: String },
}

fn main() -> ExitCode {
    exit_code(run(&Options::parse()))
}

fn run(options: &Options) -> Result<(), SoakError> {
    let cycles = options.frames.div_ceil(CYCLE);
    let mut stage = Stage::new(&options.assets)?;
    let mut game = Game::new(options.seed, options.reload_in_play);
    let (mut balance, mut work, mut digest) = (Balance::default(), Work::default(), Digest::default());
    let mut memory = Memory::new(cycles);
    let started = Instant::now();
    for frame in 0..cycles * CYCLE {
        let fault = |what| SoakError::Fault { frame, what };
        game.play(&mut stage, frame % CYCLE)?;
        let before = Instant::now();
        stage.app.update();
        work.add(stage.app.world(), before.elapsed(), frame).map_err(fault)?;
        digest.add_frame(&mut stage, game.question());
        balance.check(stage.app.world_mut(), &mut digest).map_err(fault)?;
        if frame % CYCLE == EMPTY {
            balance.check_nothing(stage.app.world()).map_err(fault)?;
            memory
                .sample(MEMORY.current_usage(), stage.app.world_mut())
                .map_err(fault)?;
        }
        if options.progress > 0 && (frame + 1) % options.progress == 0 {
            let (seconds, bytes) = (started.elapsed().as_secs(), memory.last);
            let archetypes = memory.archetypes;
            eprintln!(
                "frame {}: {seconds} s, hash {digest}, {bytes} bytes, {archetypes} archetypes",
                frame + 1
            );
        }
    }
    let report = Report {
        frames: cycles * CYCLE,
        seed: options.seed,
        seconds: started.elapsed().as_secs_f64(),
        hash: digest.to_string(),
        events: balance.events,
        actions: game.counts,
        memory,
        work: work.report(),
    };
    print_report(&report, options.json);
    Ok(())
}
