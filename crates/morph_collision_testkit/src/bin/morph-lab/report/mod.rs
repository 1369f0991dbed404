//! `morph-lab report docs`: measures everything on the pages of `docs/measurements`, and writes them.
//!
//! ```text
//! a topic: experiments --testkit's bench--> rows --> data/TOPIC.csv --> TOPIC.md, plots/*.svg
//!                                                    of all topics  --> tables of performance.md and README.md
//! ```
//!
//! Pages are made of nothing but the rows, so every number and every conclusion on them is as old as its row, and each row says when,
//! where and from which commit it is.

mod candidates;
mod comparison;
mod context;
mod counts;
mod details;
mod losses;
mod overview;
mod page;
mod race;
mod record;
mod topics;

use std::error::Error;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use morph_collision_cli::shared::{AnyError, Verdict};
use morph_collision_testkit::machine;
use morph_collision_testkit::report::Store;

use context::Context;
use topics::{Measure, TOPICS, Topic};

/// Measure everything on the pages of docs/measurements, and write them.
#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// The folder with performance.md and measurements/, in the root of the repository.
    docs: PathBuf,
    /// Measure only this topic; can be repeated.
    #[arg(long, value_name = "TOPIC", value_parser = PossibleValuesParser::new(topics::measured_names()))]
    only: Vec<String>,
    /// Measure nothing, only write the pages from the data again.
    #[arg(long, conflicts_with_all = ["only", "counts"])]
    render: bool,
    /// Measure nothing, but read counts from standard input, one `ROW COLUMN NUMBER` per line.
    #[arg(long, value_name = "DATA", value_parser = PossibleValuesParser::new(counts::DATA), conflicts_with = "only")]
    counts: Option<String>,
    /// Measure rough numbers: few steps, one round.
    #[arg(long)]
    quick: bool,
    /// Use every Nth step of the experiments.
    #[arg(long, value_name = "N")]
    every: Option<NonZeroUsize>,
    /// Number of rounds.
    #[arg(long, value_name = "N")]
    rounds: Option<NonZeroUsize>,
}

/// Measures and writes.
pub(crate) fn report(args: &ReportArgs) -> Result<Verdict, AnyError> {
    run(args).map_err(|error| error.to_string())?;
    Ok(Verdict::Clean)
}

fn run(args: &ReportArgs) -> Result<(), Box<dyn Error>> {
    let (every, rounds) = if args.quick { (50, 1) } else { (20, 5) };
    let context = Context {
        every: args.every.map_or(every, NonZeroUsize::get),
        rounds: args.rounds.map_or(rounds, NonZeroUsize::get),
        quick: args.quick,
        origin: morph_collision_testkit::report::origin(&args.docs)?,
        store: Store::below(&args.docs.join("measurements")),
    };
    // Written before anything is measured, too, so that a wrong folder fails at once.
    overview::write(&args.docs, &context.store)?;
    if let Some(data) = &args.counts {
        counts::take(&context, data, std::io::stdin().lock())?;
    } else if !args.render {
        let wanted = |topic: &&Topic| args.only.is_empty() || args.only.iter().any(|only| only == topic.name);
        measure(&context, TOPICS.iter().filter(wanted).collect(), &args.docs)?;
    }
    overview::write(&args.docs, &context.store)
}

/// Measures topics, first those that use several cores, because the others are pinned to one.
fn measure(context: &Context, topics: Vec<&Topic>, docs: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let pinned = |topic: &Topic| matches!(topic.measure, Measure::OneCore(_));
    let (on_one, on_all): (Vec<_>, Vec<_>) = topics.into_iter().partition(|topic| pinned(topic));
    for topic in on_all {
        if let Measure::AllCores(measure) = topic.measure {
            measure(context)?;
            overview::write(docs, &context.store)?;
        }
    }
    if !on_one.is_empty() && machine::pin().is_none() {
        eprintln!("cannot pin this thread to a core; times will vary more");
    }
    for topic in on_one {
        if let Measure::OneCore(measure) = topic.measure {
            measure(context)?;
            overview::write(docs, &context.store)?;
        }
    }
    Ok(())
}
