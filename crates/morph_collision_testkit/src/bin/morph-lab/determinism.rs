//! `morph-lab determinism`: the determinism test for release builds and other processors.

use morph_collision::Kernel;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::determinism::{answer_all, differences};

use crate::verdict;

/// The numbers of threads to run the queries on. WebAssembly has only one thread.
const THREADS: &[usize] = if cfg!(target_family = "wasm") { &[1] } else { &[1, 2, 8] };

pub(crate) fn determinism() -> Result<Verdict, AnyError> {
    let lines = answer_all(THREADS)?;
    let kernels: Vec<&str> = Kernel::available().iter().map(|kernel| kernel.name()).collect();
    println!("{} scenes, kernels: {}", lines.len(), kernels.join(", "));
    let differences = differences(&lines);
    for difference in &differences {
        eprintln!("error: {difference}");
    }
    Ok(verdict(differences.is_empty()))
}
