//! How many triangles a leaf has.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::report::Store;

use super::Topic;
use crate::report::candidates;
use crate::report::comparison::every_method;
use crate::report::context::Context;
use crate::report::details::{self, details};
use crate::report::page::Page;
use crate::report::race::{Source, measure_topic};
use crate::report::record::Record;

const NAME: &str = "leaves";

pub(super) const TOPIC: Topic = Topic::on_one_core(NAME, measure, page);

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let experiments = Experiment::tuning(context.every).into_iter().map(Source::from);
    measure_topic(context, NAME, experiments, candidates::leaves, context.rounds)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(NAME)?;
    let table = every_method(&rows, "all pairs / first pairs");
    let page = Page {
        name: NAME,
        title: "Triangles in a leaf",
        intro: "`BuildOptions::default()` has at most eight triangles in a leaf, which fill the patches that are blended, placed and compared side by side.\n\
            The other rows differ only in that number. The default is measured twice; the distance of the second measurement from 1 is the noise.\n\
            [tried.md](../tried.md) lists former build options, and why they were removed.\n",
        body: format!(
            "Times as ratios to the default:\n\n{table}\n## Work and time\n\n{}{}",
            details::HOW_TO_READ,
            details(&rows)
        ),
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}
