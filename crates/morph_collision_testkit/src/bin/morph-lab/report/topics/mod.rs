//! The topics: each measures its rows and makes its page from them.

mod batches;
mod faces;
mod frame_to_frame;
mod instructions;
mod leaves;
mod many_questions;
mod methods;
mod motion;
mod paper;
mod rays;
mod scale;
mod self_collisions;
mod skinned;
mod threads;
mod worst_cases;

use std::error::Error;

use morph_collision_testkit::report::Store;

use crate::report::candidates;
use crate::report::comparison::{self, limits, rivals};
use crate::report::context::Context;
use crate::report::details::{self, details};
use crate::report::losses::{Loss, losses, losses_table};
use crate::report::page::Page;
use crate::report::race::{Source, measure_topic};
use crate::report::record::{Record, scenes};

/// Measures and stores rows.
type Measurement = fn(&Context) -> Result<(), Box<dyn Error>>;
/// Makes something of stored rows.
type FromRows<T> = fn(&Store) -> Result<T, Box<dyn Error>>;

/// How the rows of a topic are made.
pub(crate) enum Measure {
    /// On one core, to which the thread is pinned.
    OneCore(Measurement),
    AllCores(Measurement),
    /// It has none of its own.
    Computed,
}

/// A topic with a page of its own.
pub(crate) struct Topic {
    pub(crate) name: &'static str,
    pub(crate) measure: Measure,
    pub(crate) page: FromRows<Page>,
    /// Where another method is faster, for topics that compare methods.
    pub(crate) losses: FromRows<Vec<Loss>>,
}

impl Topic {
    /// A topic that compares no methods.
    const fn on_one_core(name: &'static str, measure: Measurement, page: FromRows<Page>) -> Self {
        Self {
            name,
            measure: Measure::OneCore(measure),
            page,
            losses: no_losses,
        }
    }
}

/// All topics, in the order in which they are measured.
pub(crate) const TOPICS: [Topic; 14] = [
    of_every_method::<methods::GeneratedMeshes>(),
    of_every_method::<faces::Faces>(),
    of_every_method::<skinned::Skinned>(),
    of_every_method::<rays::Rays>(),
    many_questions::TOPIC,
    frame_to_frame::TOPIC,
    paper::TOPIC,
    scale::TOPIC,
    threads::TOPIC,
    leaves::TOPIC,
    motion::TOPIC,
    self_collisions::TOPIC,
    worst_cases::TOPIC,
    instructions::TOPIC,
];

/// The names of the topics that are measured.
pub(crate) fn measured_names() -> Vec<&'static str> {
    let measured = |topic: &&Topic| !matches!(topic.measure, Measure::Computed);
    TOPICS.iter().filter(measured).map(|topic| topic.name).collect()
}

/// The rows of all methods that compare pairs of bodies.
pub(crate) fn of_bodies(store: &Store) -> Result<Vec<Record>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for name in [
        methods::GeneratedMeshes::NAME,
        faces::Faces::NAME,
        skinned::Skinned::NAME,
    ] {
        rows.extend(store.rows::<Record>(name)?);
    }
    Ok(rows)
}

/// The rows of all methods that cast rays.
pub(crate) fn of_rays(store: &Store) -> Result<Vec<Record>, Box<dyn Error>> {
    store.rows(rays::Rays::NAME)
}

fn no_losses(_: &Store) -> Result<Vec<Loss>, Box<dyn Error>> {
    Ok(Vec::new())
}

/// A topic that runs every method in some scenes.
trait EveryMethod {
    const NAME: &'static str;
    const TITLE: &'static str;
    /// What is measured, and how to read it.
    const INTRO: &'static str;
    /// What the methods are asked.
    const QUESTIONS: &'static str = "all pairs / first pairs";

    /// The scenes, of which every Nth step is used.
    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>>;
}

const fn of_every_method<T: EveryMethod>() -> Topic {
    Topic {
        name: T::NAME,
        measure: Measure::OneCore(|context| {
            let sources = T::sources(context.every)?;
            measure_topic(context, T::NAME, sources, candidates::methods, context.rounds)
        }),
        page: page_of_every_method::<T>,
        losses: |store| Ok(losses(&store.rows::<Record>(T::NAME)?)),
    }
}

fn page_of_every_method<T: EveryMethod>(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(T::NAME)?;
    let mut body = format!("{}\n{}", comparison::HOW_TO_READ, rivals(scenes(&rows), T::QUESTIONS));
    if rows.iter().any(|row| row.method == "rigid-floor") {
        body += &format!(
            "\n## The lower limit, the method and the engineering\n\n{}",
            limits(scenes(&rows))
        );
    }
    body += &format!(
        "\n## Where another method is faster\n\n{}\n## Work and time of every method\n\n{}{}",
        losses_table(&losses(&rows)),
        details::HOW_TO_READ,
        details(&rows)
    );
    let page = Page {
        name: T::NAME,
        title: T::TITLE,
        intro: T::INTRO,
        body,
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}
