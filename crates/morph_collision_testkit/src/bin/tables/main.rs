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
use sweeps::Sweep;

const USAGE: &str = "usage: tables [--every N] [--rounds N] [--only TABLE] PAGE.md";

/// What the command line says.
struct Args {
    page: PathBuf,
    /// Every how many steps of the experiments one is taken.
    every: usize,
    rounds: usize,
    /// The one table to make, if not all.
    only: Option<String>,
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
    let (mut page, mut every, mut rounds, mut only) = (None, 20, 5, None);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--every" => every = words.next()?.parse().ok().filter(|&n| n > 0)?,
            "--rounds" => rounds = words.next()?.parse().ok().filter(|&n| n > 0)?,
            "--only" => {
                let name = words.next()?;
                only = Some(sweeps::ALL.iter().any(|sweep| sweep.name == name).then_some(name)?);
            }
            _ => page = Some(PathBuf::from(word)),
        }
    }
    page.map(|page| Args {
        page,
        every,
        rounds,
        only,
    })
}

fn run(args: &Args) -> Result<(), Box<dyn std::error::Error>> {
    // Read before anything is measured, so that a wrong path costs nothing.
    let mut page = document::Page::read(&args.page)?;
    page.replace("machine", &render::machine(args.every, args.rounds))?;
    let experiments = Experiment::all(args.every);
    let consecutive = Experiment::consecutive();
    let wanted = |sweep: &Sweep| args.only.as_ref().is_none_or(|only| only == sweep.name);
    for sweep in sweeps::ALL.into_iter().filter(wanted) {
        let mut text = String::new();
        for experiment in if sweep.consecutive { &consecutive } else { &experiments } {
            eprintln!("{}: {}", sweep.name, experiment.name);
            let contenders = (sweep.rows)(experiment);
            let rows = measure::measure(experiment, &contenders, args.rounds)?;
            text += &render::table(experiment, &rows);
        }
        page.replace(sweep.name, &text)?;
        page.write()?;
    }
    Ok(())
}
