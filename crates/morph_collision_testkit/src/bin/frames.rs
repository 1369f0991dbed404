//! Runs all frames of a benchmark's scene once to fill caches, and again to count instructions: `frames dolphins-564 all`, see
//! `just instructions`.
//!
//! `frames` alone names the kernel that this machine gets: counts can be compared only where it is the same. The program reads no
//! clock, as valgrind cannot run the stopwatch of the benchmarks.

use std::error::Error;

use morph_collision::Kernel;
use morph_collision_testkit::bench::{Entrant, Experiment};
use morph_collision_testkit::rivals::{BroadPhase, Method, MethodOptions, PoseError, Wanted};

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
    let mut broad_phase = BroadPhase::default();
    pass(&experiment, method.as_mut(), &mut broad_phase, wanted)?;
    println!(
        "{} pairs",
        counted_pass(&experiment, method.as_mut(), &mut broad_phase, wanted)?
    );
    Ok(())
}

/// Callgrind is told to collect in here only.
#[inline(never)]
fn counted_pass(
    experiment: &Experiment,
    method: &mut dyn Method,
    broad_phase: &mut BroadPhase,
    wanted: Wanted,
) -> Result<usize, PoseError> {
    pass(experiment, method, broad_phase, wanted)
}

/// Runs all frames; returns the number of intersecting pairs.
#[inline(never)]
fn pass(
    experiment: &Experiment,
    method: &mut dyn Method,
    broad_phase: &mut BroadPhase,
    wanted: Wanted,
) -> Result<usize, PoseError> {
    let (mut pairs, mut found) = (Vec::new(), 0);
    for (index, frame) in experiment.frames.iter().enumerate() {
        experiment.set_bodies(&mut *method, index)?;
        for &(a, b) in broad_phase.pairs(method, frame.len()) {
            pairs.clear();
            method.collide(a as usize, b as usize, wanted, &mut pairs);
            found += pairs.len();
        }
    }
    Ok(found)
}
