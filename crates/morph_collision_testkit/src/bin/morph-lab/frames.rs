//! `morph-lab frames dolphins-564 all`, also `--method hybrid`: runs all frames of a benchmark scene once to fill caches, and again to count instructions. See
//! `just instructions`. What a method prepares is not counted.
//!
//! Counts are comparable only between machines with the same kernel. The program reads no clock, because valgrind cannot run the stopwatch
//! of the benchmarks.

use clap::{Args, ValueEnum};
use morph_collision::Kernel;
use morph_collision::batch::Wanted;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::bench::{Asked, Entrant, Experiment, Many, ManyQuestions, NotAsked, Questions};
use morph_collision_testkit::rivals::{Method, MethodOptions, PoseError};

use crate::methods;

/// Run all frames of a benchmark scene, to count instructions; without a scene, print the kernel of this machine.
#[derive(Debug, Args)]
pub(crate) struct FramesArgs {
    /// The scene; or `many-rays` or `many-points`, for questions in batches (all) or one by one (first).
    #[arg(requires = "mode")]
    scene: Option<String>,
    /// What to find about each pair of bodies.
    #[arg(value_enum)]
    mode: Option<Mode>,
    /// The method; `many-rays` and `many-points` have only morph.
    #[arg(long, value_name = "NAME", default_value = "morph", value_parser = methods::names())]
    method: String,
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
    if let Some(many) = Many::ALL.into_iter().find(|many| many.name() == scene) {
        return many_questions(many, mode);
    }
    let wanted = match mode {
        Mode::All => Wanted::All,
        Mode::First => Wanted::First,
    };
    let experiment = Experiment::named(scene, 20)?;
    let mut entrants = Entrant::ALL.iter().chain(&Entrant::SLOW);
    let entrant = entrants.find(|entrant| entrant.name == args.method && entrant.supports(&experiment));
    let entrant = entrant.ok_or_else(|| format!("{scene} is not a scene for {}", args.method))?;
    let mut method = entrant.set_up(&experiment, &MethodOptions::default())?.method;
    let mut questions = Questions::default();
    let method = method.as_mut();
    let mut found = 0;
    for frame_of in [one_frame, counted_frame] {
        found = 0;
        for index in 0..experiment.frames.len() {
            questions.prepare(&experiment, index, method, wanted)?;
            found += frame_of(&experiment, index, method, &mut questions, wanted)?;
        }
    }
    println!("{found} pairs or hits");
    Ok(Verdict::Clean)
}

/// Asks many questions at one moment: in batches, or one by one if only the first pairs are wanted.
fn many_questions(many: Many, mode: Mode) -> Result<Verdict, AnyError> {
    let mut questions = ManyQuestions::new(many)?;
    let asked = match mode {
        Mode::All => Asked::Batch(1),
        Mode::First => Asked::OneByOne,
    };
    questions.ask(0, asked)?;
    let (found, _) = counted_frame_of_many(&mut questions, asked)?;
    println!("{found} found");
    Ok(Verdict::Clean)
}

/// Callgrind is told to collect only in here.
#[inline(never)]
fn counted_frame_of_many(questions: &mut ManyQuestions, asked: Asked) -> Result<(usize, f64), NotAsked> {
    questions.ask(1, asked)
}

/// Callgrind is told to collect only in here.
#[inline(never)]
fn counted_frame(
    experiment: &Experiment,
    index: usize,
    method: &mut dyn Method,
    questions: &mut Questions,
    wanted: Wanted,
) -> Result<u64, PoseError> {
    one_frame(experiment, index, method, questions, wanted)
}

/// Returns the number of intersecting pairs, or of rays that hit.
#[inline(never)]
fn one_frame(
    experiment: &Experiment,
    index: usize,
    method: &mut dyn Method,
    questions: &mut Questions,
    wanted: Wanted,
) -> Result<u64, PoseError> {
    experiment.set_bodies(method, index)?;
    Ok(questions.answer(experiment, index, method, wanted).pairs)
}
