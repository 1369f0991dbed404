//! Runs all frames of a benchmark's scene a number of times, to count instructions: `frames dolphins-564 all 3`, see `just instructions`.
//!
//! With 0 passes it only sets the scene up. It reads no clock, as valgrind cannot run the stopwatch of the benchmarks.

use std::error::Error;

use morph_collision_testkit::bench::{Entrant, Experiment};
use morph_collision_testkit::rivals::{BroadPhase, MethodOptions, Wanted};

fn main() -> Result<(), Box<dyn Error>> {
    let usage = "usage: frames SCENE all|first PASSES";
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, wanted, passes] = arguments.as_slice() else {
        return Err(usage.into());
    };
    let wanted = match wanted.as_str() {
        "all" => Wanted::All,
        "first" => Wanted::First,
        _ => return Err(usage.into()),
    };
    let passes: usize = passes.parse()?;
    let experiment = Experiment::named(scene, 20).map_err(|error| error.to_string())?;
    let mut method = Entrant::ALL[0].set_up(&experiment, &MethodOptions::default())?.method;
    let (mut broad_phase, mut pairs) = (BroadPhase::default(), Vec::new());
    let mut found = 0;
    for frame in experiment.frames.iter().cycle().take(passes * experiment.frames.len()) {
        for (body, (weights, place)) in frame.iter().enumerate() {
            method.set_body(body, weights, place)?;
        }
        for &(a, b) in broad_phase.pairs(method.as_mut(), frame.len()) {
            pairs.clear();
            method.collide(a as usize, b as usize, wanted, &mut pairs);
            found += pairs.len();
        }
    }
    println!("{found} pairs");
    Ok(())
}
