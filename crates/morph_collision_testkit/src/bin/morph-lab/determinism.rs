//! `morph-lab determinism`: the determinism test for release builds and other processors.

use clap::Args;
use morph_collision::Kernel;
use morph_collision_cli::shared::{AnyError, Verdict, count};
use morph_collision_testkit::determinism::{answer_all, differences, scenes};

use crate::verdict;

/// Compare the bits of answers with those that every machine must give.
#[derive(Debug, Args)]
pub(crate) struct DeterminismArgs {
    /// The numbers of threads to ask on, such as `1,2`. WebAssembly has only one thread.
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = THREADS.to_vec(),
        value_parser = clap::value_parser!(u8).range(1..=64))]
    threads: Vec<u8>,
}

const THREADS: &[u8] = if cfg!(target_family = "wasm") { &[1] } else { &[1, 2, 8] };

pub(crate) fn determinism(args: &DeterminismArgs) -> Result<Verdict, AnyError> {
    let steps = count("scene", scenes().len() as u64);
    let threads: Vec<usize> = args.threads.iter().copied().map(usize::from).collect();
    let lines = answer_all(&threads, || steps.step())?;
    let kernels: Vec<&str> = Kernel::available().iter().map(|kernel| kernel.name()).collect();
    println!("{} scenes, kernels: {}", lines.len(), kernels.join(", "));
    let differences = differences(&lines);
    for difference in &differences {
        eprintln!("error: {difference}");
    }
    Ok(verdict(differences.is_empty()))
}
