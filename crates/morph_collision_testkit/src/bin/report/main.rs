//! Rewrites every table and plot of `docs/performance.md` in place:
//! `cargo run --release -p morph_collision_testkit --features report --bin report -- docs/performance.md`.
//!
//! ```text
//! a section: experiments --testkit's bench--> rows --render, plot--> Markdown, SVG, CSV --bench's Page--> the page, docs/plots/
//! ```

mod render;
mod sections;
mod sweeps;

use std::path::PathBuf;
use std::process::ExitCode;

use morph_collision_testkit::bench::{self, Page};

use sections::{Context, SECTIONS, Section};

const USAGE: &str = "usage: report [--quick] [--every N] [--rounds N] [--only PLACE]... PAGE.md";

/// The command line.
struct Args {
    page: PathBuf,
    /// Use every Nth step of the experiments.
    every: usize,
    rounds: usize,
    quick: bool,
    /// The sections to rewrite; all if empty.
    only: Vec<String>,
}

fn main() -> ExitCode {
    let args = match parse(std::env::args().skip(1)) {
        Ok(args) => args,
        Err(error) => {
            eprintln!("{error}\n{USAGE}");
            return ExitCode::FAILURE;
        }
    };
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn parse(mut words: impl Iterator<Item = String>) -> Result<Args, String> {
    let (mut page, mut every, mut rounds, mut quick, mut only) = (None, None, None, false, Vec::new());
    let number = |flag: &str, word: Option<String>| {
        let value = word.and_then(|word| word.parse().ok()).filter(|&n: &usize| n > 0);
        value.ok_or_else(|| format!("{flag} wants a number above 0"))
    };
    while let Some(word) = words.next() {
        match word.as_str() {
            "--quick" => quick = true,
            "--every" => every = Some(number("--every", words.next())?),
            "--rounds" => rounds = Some(number("--rounds", words.next())?),
            "--only" => {
                let name = words.next().unwrap_or_default();
                if !SECTIONS.iter().any(|section| section.name == name) {
                    let names: Vec<_> = SECTIONS.iter().map(|section| section.name).collect();
                    return Err(format!("--only '{name}': expected one of: {}", names.join(", ")));
                }
                only.push(name);
            }
            _ if word.starts_with('-') => return Err(format!("unknown flag {word}")),
            _ => page = Some(PathBuf::from(word)),
        }
    }
    Ok(Args {
        page: page.ok_or("which page?")?,
        every: every.unwrap_or(if quick { 50 } else { 20 }),
        rounds: rounds.unwrap_or(if quick { 1 } else { 5 }),
        quick,
        only,
    })
}

fn run(args: &Args) -> Result<(), Box<dyn std::error::Error>> {
    // Read before anything is measured, so that a wrong path fails at once.
    let mut page = Page::read(&args.page)?;
    page.replace("machine", &render::machine(args.every, args.rounds))?;
    let context = Context {
        every: args.every,
        rounds: args.rounds,
        quick: args.quick,
        plots: args.page.with_file_name("plots"),
    };
    let wanted = |name: &str| args.only.is_empty() || args.only.iter().any(|only| only == name);
    let (on_all_cores, on_one): (Vec<_>, Vec<_>) = SECTIONS
        .iter()
        .filter(|section| wanted(section.name))
        .partition(|section| section.uses_all_cores());
    let mut fill = |sections: &[&Section]| -> Result<(), Box<dyn std::error::Error>> {
        for section in sections {
            let old = page.content(section.name)?.to_owned();
            page.replace(section.name, &(section.make)(&context, &old)?)?;
            page.write()?;
        }
        Ok(())
    };
    fill(&on_all_cores)?;
    if bench::pin().is_none() {
        eprintln!("cannot pin this thread to a core; times will vary more");
    }
    fill(&on_one)
}
