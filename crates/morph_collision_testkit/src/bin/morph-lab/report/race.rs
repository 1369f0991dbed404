//! Runs candidates against each other in experiments, and stores their rows.

use std::error::Error;

use morph_collision::batch::Wanted;
use morph_collision_testkit::bench::{Experiment, NoExperiment, Plan, Row, disagreement, measure};

use crate::report::candidates::Candidate;
use crate::report::context::Context;
use crate::report::record::{ALL, FIRST, Record};

/// An experiment, or the one whose model is missing.
pub(crate) enum Source {
    Complete(Box<Experiment>),
    Missing { scene: String, reason: String },
}

impl From<Experiment> for Source {
    fn from(experiment: Experiment) -> Self {
        Self::Complete(Box::new(experiment))
    }
}

impl Source {
    /// An experiment by name.
    pub(crate) fn named(name: &str, every: usize) -> Result<Self, NoExperiment> {
        match Experiment::named(name, every) {
            Ok(experiment) => Ok(experiment.into()),
            Err(missing @ NoExperiment::Missing { .. }) => Ok(Self::Missing {
                scene: name.to_owned(),
                reason: missing.to_string(),
            }),
            Err(error) => Err(error),
        }
    }

    /// Changes the experiment, and the name of the scene.
    pub(crate) fn renamed(mut self, name: String, change: impl FnOnce(&mut Experiment)) -> Self {
        match &mut self {
            Self::Complete(experiment) => {
                change(experiment);
                experiment.name = name;
            }
            Self::Missing { scene, .. } => *scene = name,
        }
        self
    }
}

/// Runs candidates in all scenes and stores a topic's rows. Rows of scenes whose models are missing stay as they are.
pub(crate) fn measure_topic(
    context: &Context,
    topic: &str,
    sources: impl IntoIterator<Item = Source>,
    candidates: impl Fn(&Experiment) -> Vec<Candidate>,
    rounds: usize,
) -> Result<(), Box<dyn Error>> {
    let old: Vec<Record> = context.store.rows(topic)?;
    let mut rows = Vec::new();
    for source in sources {
        match source {
            Source::Complete(experiment) => {
                eprintln!("{topic}: {}", experiment.title);
                rows.extend(records(context, &experiment, &candidates(&experiment), rounds)?);
            }
            Source::Missing { scene, reason } => {
                eprintln!("{topic}: {reason}; its rows stay as they are");
                let is_new = rows.iter().all(|row: &Record| row.scene != scene);
                rows.extend(old.iter().filter(|row| is_new && row.scene == scene).cloned());
            }
        }
    }
    context.store.write(topic, &rows)
}

/// The rows of candidates in an experiment: for all and for first pairs, or for rays.
pub(crate) fn records(
    context: &Context,
    experiment: &Experiment,
    candidates: &[Candidate],
    rounds: usize,
) -> Result<Vec<Record>, Box<dyn Error>> {
    let questions = match experiment.rays.first().map(Vec::len) {
        None => vec![(ALL.to_owned(), Wanted::All), (FIRST.to_owned(), Wanted::First)],
        Some(1) => vec![("1 ray".to_owned(), Wanted::All)],
        Some(rays) => vec![(format!("{rays} rays"), Wanted::All)],
    };
    let every = experiment
        .steps
        .get(1)
        .map_or(context.every, |step| step - experiment.steps[0]);
    let mut records = Vec::new();
    for (question, wanted) in questions {
        let rows = race(experiment, candidates, wanted, rounds)?;
        let record = |row| Record::new(experiment, &question, row, context.timed(every, rounds));
        records.extend(rows.iter().map(record));
    }
    Ok(records)
}

/// Measures candidates, and checks that they agree.
pub(crate) fn race(
    experiment: &Experiment,
    candidates: &[Candidate],
    wanted: Wanted,
    rounds: usize,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let contenders = candidates.iter().map(|candidate| candidate.set_up(experiment));
    let plan = Plan {
        wanted,
        rounds,
        split_rounds: 0,
    };
    let rows = measure(experiment, contenders.collect::<Result<_, _>>()?, plan, || ())?;
    match disagreement(experiment, &rows, wanted) {
        None => Ok(rows),
        Some(wrong) => Err(wrong.into()),
    }
}
