//! Makes the tables of `docs/performance.md` again, in place:
//! `cargo run --release -p morph_collision_testkit --bin tables -- docs/performance.md`.
//!
//! ```text
//! experiments --measure (interleaved rounds)--> work and times --render--> Markdown --document--> between the page's markers
//! ```

mod clock;
mod document;
mod experiments;
mod measure;
mod render;
mod sweeps;

use std::path::PathBuf;
use std::process::ExitCode;

use experiments::Experiment;

const USAGE: &str = "usage: tables [--every N] [--rounds N] PAGE.md";

/// What the command line says.
struct Args {
    page: PathBuf,
    /// Every how many steps of the experiments one is taken.
    every: usize,
    rounds: usize,
}

fn main() -> ExitCode {
    let Some(args) = parse(std::env::args().skip(1)) else {
        eprintln!("{USAGE}");
        return ExitCode::FAILURE;
    };
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn parse(mut words: impl Iterator<Item = String>) -> Option<Args> {
    let (mut page, mut every, mut rounds) = (None, 20, 5);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--every" => every = words.next()?.parse().ok().filter(|&n| n > 0)?,
            "--rounds" => rounds = words.next()?.parse().ok().filter(|&n| n > 0)?,
            _ => page = Some(PathBuf::from(word)),
        }
    }
    page.map(|page| Args { page, every, rounds })
}

fn run(args: &Args) -> Result<(), Box<dyn std::error::Error>> {
    // Read before anything is measured, so that a wrong path costs nothing.
    let mut page = document::Page::read(&args.page)?;
    page.replace("machine", &render::machine(args.every, args.rounds))?;
    let experiments = Experiment::all(args.every);
    for (name, sweep) in sweeps::ALL {
        let mut text = String::new();
        for experiment in &experiments {
            eprintln!("{name}: {}", experiment.name);
            let contenders = sweep(experiment);
            let rows = measure::measure(experiment, &contenders, args.rounds)?;
            text += &render::table(experiment, &rows);
        }
        page.replace(name, &text)?;
        page.write()?;
    }
    Ok(())
}
