//! `morph-lab frames dolphins-564 all`: runs all frames of a benchmark scene once to fill caches, and again to count instructions. See
//! `just instructions`.
//!
//! Counts are comparable only between machines with the same kernel. The program reads no clock, because valgrind cannot run the stopwatch
//! of the benchmarks.

use clap::{Args, ValueEnum};
use morph_collision::Kernel;
use morph_collision::batch::Wanted;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::bench::{Entrant, Experiment, Questions};
use morph_collision_testkit::rivals::{Method, MethodOptions, PoseError};

/// Run all frames of a benchmark scene, to count instructions; without a scene, print the kernel of this machine.
#[derive(Debug, Args)]
pub(crate) struct FramesArgs {
    /// The scene.
    #[arg(requires = "mode")]
    scene: Option<String>,
    /// What to find about each pair of bodies.
    #[arg(value_enum)]
    mode: Option<Mode>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Mode {
    All,
    First,
}

pub(crate) fn frames(args: &FramesArgs) -> Result<Verdict, AnyError> {
    let (Some(scene), Some(mode)) = (&args.scene, args.mode) else {
        println!("{}", Kernel::default().name());
        return Ok(Verdict::Clean);
    };
    let wanted = match mode {
        Mode::All => Wanted::All,
        Mode::First => Wanted::First,
    };
    let experiment = Experiment::named(scene, 20)?;
    let mut method = Entrant::ALL[0].set_up(&experiment, &MethodOptions::default())?.method;
    let mut questions = Questions::default();
    pass(&experiment, method.as_mut(), &mut questions, wanted)?;
    println!(
        "{} pairs or hits",
        counted_pass(&experiment, method.as_mut(), &mut questions, wanted)?
    );
    Ok(Verdict::Clean)
}

/// Callgrind is told to collect only in here.
#[inline(never)]
fn counted_pass(
    experiment: &Experiment,
    method: &mut dyn Method,
    questions: &mut Questions,
    wanted: Wanted,
) -> Result<u64, PoseError> {
    pass(experiment, method, questions, wanted)
}

/// Runs all frames. Returns the number of intersecting pairs, or of rays that hit.
#[inline(never)]
fn pass(
    experiment: &Experiment,
    method: &mut dyn Method,
    questions: &mut Questions,
    wanted: Wanted,
) -> Result<u64, PoseError> {
    let mut found = 0;
    for index in 0..experiment.frames.len() {
        experiment.set_bodies(&mut *method, index)?;
        found += questions.answer(experiment, index, method, wanted).pairs;
    }
    Ok(found)
}
