//! Runs all frames of a benchmark scene once to fill caches, and again to count instructions: `frames dolphins-564 all`. See
//! `just instructions`.
//!
//! Without arguments it prints the kernel of this machine. Counts are comparable only between machines with the same kernel. The
//! program reads no clock, because valgrind cannot run the stopwatch of the benchmarks.

use std::error::Error;

use morph_collision::Kernel;
use morph_collision_testkit::bench::{Entrant, Experiment, Questions};
use morph_collision_testkit::rivals::{Method, MethodOptions, PoseError, Wanted};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (scene, wanted) = match arguments.as_slice() {
        [] => {
            println!("{}", Kernel::default().name());
            return Ok(());
        }
        [scene, wanted] if wanted == "all" => (scene, Wanted::All),
        [scene, wanted] if wanted == "first" => (scene, Wanted::First),
        _ => return Err("usage: frames [SCENE all|first]".into()),
    };
    let experiment = Experiment::named(scene, 20).map_err(|error| error.to_string())?;
    let mut method = Entrant::ALL[0].set_up(&experiment, &MethodOptions::default())?.method;
    let mut questions = Questions::default();
    pass(&experiment, method.as_mut(), &mut questions, wanted)?;
    println!(
        "{} pairs or hits",
        counted_pass(&experiment, method.as_mut(), &mut questions, wanted)?
    );
    Ok(())
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
        found += questions.ask(experiment, index, method, wanted).pairs;
    }
    Ok(found)
}
