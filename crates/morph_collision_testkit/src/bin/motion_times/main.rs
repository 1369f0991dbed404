//! Measures what single pairs of moving features cost, and recorded frames: `motion_times [--quick] PAGE.md`. See `just motion-times`.
//!
//! It reads the recorded motions beside the repository and fills the places `motion-queries` and `motion-frames` of the page. Without
//! the recordings, it prints a reason and leaves the page as it is.

mod features;
mod frames;
mod timing;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use morph_collision_testkit::bench::{self, Page};
use morph_collision_testkit::motion::records::find_records;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (rounds, note, page) = match words.as_slice() {
        [quick, page] if quick == "--quick" => (3, "Rough times: ", page),
        [page] => (15, "", page),
        _ => {
            eprintln!("usage: motion_times [--quick] PAGE.md");
            return ExitCode::from(2);
        }
    };
    match run(rounds, note, PathBuf::from(page)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("motion_times: error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(rounds: usize, note: &str, page: PathBuf) -> Result<(), Box<dyn Error>> {
    let mut page = Page::read(&page)?;
    let (queries, pairs) = match (find_records("ccdq"), find_records("ccdp")) {
        (Ok(queries), Ok(pairs)) => (queries, pairs),
        (Err(missing), _) | (_, Err(missing)) => {
            println!("skipped: {missing}");
            return Ok(());
        }
    };
    if bench::pin().is_none() {
        eprintln!("cannot pin this thread to a core; times will vary more");
    }
    let machine = format!("\n{note}{}, one thread, medians of {rounds} rounds.\n\n", bench::cpu());
    page.replace(
        "motion-queries",
        &(machine.clone() + &features::table(&queries, &pairs, rounds)?),
    )?;
    page.replace("motion-frames", &(machine + &frames::table(&pairs, rounds)?))?;
    page.write()?;
    Ok(())
}
