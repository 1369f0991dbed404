//! The effect of the processor's vector instructions: the same queries with each instruction set.

use std::error::Error;
use std::fmt::Write;

use morph_collision::Kernel;
use morph_collision_testkit::bench::{Experiment, Stopwatch, median};
use morph_collision_testkit::rivals::Wanted;

use super::Context;
use super::threads::Run;

/// Makes the section.
pub(crate) fn kernels(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let kernels = Kernel::available();
    let mut text = String::from("\n| time over the first's | ");
    for kernel in kernels {
        write!(text, "{} | ", kernel.name())?;
    }
    writeln!(text, "\n|---|{}", "--:|".repeat(kernels.len()))?;
    for experiment in Experiment::paper(context.every) {
        for wanted in [Wanted::All, Wanted::First] {
            eprintln!("kernels: {}", experiment.title);
            let mut runs = kernels
                .iter()
                .map(|&kernel| Run::with_kernel(&experiment, kernel))
                .collect::<Result<Vec<_>, _>>()?;
            let mut times = vec![Vec::new(); kernels.len()];
            // Round 0 fills caches.
            for round in 0..=context.rounds {
                for (run, times) in runs.iter_mut().zip(&mut times) {
                    let start = Stopwatch::start();
                    run.pass(&experiment, wanted, 1);
                    if round > 0 {
                        times.push(start.elapsed().as_secs_f64());
                    }
                }
            }
            let mode = if wanted == Wanted::All { "all" } else { "first" };
            write!(text, "| {}, {mode} | ", experiment.title)?;
            for own in &times {
                let ratio = median(own.iter().zip(&times[0]).map(|(own, first)| own / first));
                write!(text, "{ratio:.2} | ")?;
            }
            writeln!(text)?;
        }
    }
    Ok(text)
}
