//! The determinism test as a program, for release builds and other processors. Unlike the test, it needs none of the dependencies
//! of other tests and benchmarks.

use std::process::ExitCode;

use morph_collision::Kernel;
use morph_collision_testkit::determinism::{answer_all, differences};

/// The numbers of threads to run the queries on. WebAssembly has only one thread.
const THREADS: &[usize] = if cfg!(target_family = "wasm") { &[1] } else { &[1, 2, 8] };

fn main() -> ExitCode {
    let differences = match answer_all(THREADS) {
        Ok(lines) => {
            let kernels: Vec<&str> = Kernel::available().iter().map(|kernel| kernel.name()).collect();
            println!("{} scenes, kernels: {}", lines.len(), kernels.join(", "));
            differences(&lines)
        }
        Err(error) => vec![error],
    };
    for difference in &differences {
        eprintln!("error: {difference}");
    }
    if differences.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
