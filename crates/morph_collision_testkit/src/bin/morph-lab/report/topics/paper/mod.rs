//! The paper's experiments and numbers: Fig. 5, Fig. 8 and Sect. 5.

mod claims;
mod resolution;
mod steps;

use std::error::Error;

use morph_collision_testkit::report::Store;
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, PaperOptions};

use super::{Measure, Topic};
use crate::report::candidates::{Candidate, morph, rival};
use crate::report::context::Context;
use crate::report::losses::losses;
use crate::report::page::Page;
use crate::report::record::Record;

const NAME: &str = "paper";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: |store| Ok(losses(&store.rows::<Record>(NAME)?)),
};

const BINARY: &str = "hybrid, binary";

fn ours() -> Candidate {
    morph("morph", MethodOptions::default())
}

fn theirs() -> Candidate {
    rival("paper", MethodKind::Paper(PaperOptions::BOXES))
}

fn methods() -> Vec<Candidate> {
    let mut binary = rival(BINARY, MethodKind::HybridScalar);
    binary.options.arity = 2;
    let hybrids = [MethodKind::Hybrid, MethodKind::HybridScalar].map(|kind| rival(kind.to_string(), kind));
    [ours(), theirs()].into_iter().chain(hybrids).chain([binary]).collect()
}

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let mut rows = steps::measure(context)?;
    rows.extend(resolution::measure(context)?);
    rows.extend(claims::measure(context)?);
    context.store.write(NAME, &rows)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(NAME)?;
    let body = format!(
        "## Every step of the pass-through (Fig. 5)\n\n{}\n## Resolution (Fig. 8)\n\n{}\n## Other numbers\n\n{}",
        steps::show(store, &rows)?,
        resolution::show(store, &rows)?,
        claims::show(&rows),
    );
    let page = Page {
        name: NAME,
        title: "The paper's experiments",
        intro: "The measurements of [the paper](../references.md), repeated: its Fig. 5 (every step), its Fig. 8 (resolution), and the numbers in its text.\n\
            The paper's processor ran at 1333 MHz and its hybrid was another program, so only ratios can be compared.\n\
            `hybrid` is the hybrid with our code. `hybrid-scalar` and *hybrid, binary*, which has two children per node, are in plain code like `paper`.\n",
        data: &[NAME, steps::DATA],
        body,
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}
