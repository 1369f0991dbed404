//! What remembering a pair of leaves from frame to frame saves.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;
use morph_collision_testkit::report::{NOTHING, Store, Table, ratios};

use super::{Measure, Topic};
use crate::report::candidates::{self, WITNESS};
use crate::report::comparison::{AS_USUALLY_WRITTEN, fastest};
use crate::report::context::Context;
use crate::report::details::{self, details};
use crate::report::losses::{losses, losses_table};
use crate::report::page::Page;
use crate::report::race::{Source, measure_topic};
use crate::report::record::{ALL, FIRST, Record, scenes};

const NAME: &str = "frame_to_frame";

/// A scene of this page that shows a scene of another page at 60 frames a second.
fn at_60(scene: &str) -> String {
    format!("{scene}-at-60")
}

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page,
    losses: |store| Ok(losses(&store.rows::<Record>(NAME)?)),
};

/// Frames for every two steps of the scripts, which have 60 steps a second.
const RATES: [usize; 3] = [1, 2, 8];

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let steps = if context.quick { 60 } else { 100 };
    let mut sources: Vec<Source> = Vec::new();
    for rate in RATES {
        for experiment in Experiment::consecutive(steps, rate) {
            let name = format!("{}-at-{}", experiment.name, 30 * rate);
            sources.push(Source::from(experiment).renamed(name, |_| ()));
        }
    }
    for (name, _) in Experiment::walkers() {
        sources.push(Source::named(name, 1)?.renamed(at_60(name), |experiment| {
            experiment.title += ", 60 frames a second";
        }));
    }
    let candidates = |experiment: &Experiment| {
        if experiment.name.ends_with(&at_60("")) {
            candidates::witness_and_rivals(experiment)
        } else {
            candidates::witness(experiment)
        }
    };
    measure_topic(context, NAME, sources, candidates, context.rounds.min(3))
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows: Vec<Record> = store.rows(NAME)?;
    let mut table = Table::new([
        "",
        "first pairs, with the remembered pair",
        "hybrid over that: all / first",
        "full refit",
        AS_USUALLY_WRITTEN,
        "Parry, refitted",
    ]);
    for scene in scenes(&rows) {
        let remembered = scene.ratio(WITNESS, FIRST);
        let over = |methods: &[&str]| {
            ratios([ALL, FIRST].map(|wanted| Some(fastest(scene, methods, wanted)? / scene.ratio(WITNESS, wanted)?)))
        };
        table.row([
            scene.title().to_owned(),
            remembered.map_or(NOTHING.to_owned(), |ratio| format!("{ratio:.2}")),
            over(&["hybrid"]),
            over(&["bottom-up"]),
            over(&["hybrid-scalar", "bottom-up-scalar"]),
            over(&["parry-trimesh"]),
        ]);
    }
    let body = format!(
        "The first column is a ratio to first pairs without a remembered pair. The others are the times of other methods over ours with one.\n\n{table}\n\
         ## Where another method is faster\n\n{}\n\
         ## Work and time\n\n{}{}",
        losses_table(&losses(&rows)),
        details::HOW_TO_READ,
        details(&rows)
    );
    let page = Page {
        name: NAME,
        title: "From frame to frame",
        intro: "`PairMemory` remembers the two leaves in which the last query found an intersection, and tries them first. It serves first pairs; all pairs do\n\
            not use it. The plugin keeps one for every pair of colliders that touched in the last run, if only one pair of triangles is wanted.\n\
            \n\
            Unlike on the other pages, the frames are consecutive: the first 100 of the paper's 400 steps of the pass-through (contact from step 41\n\
            on), of the dolphins, and of two neighbours, and all 400 steps of the skinned characters. The neighbours breathe and turn slowly, a little\n\
            apart, but their boxes overlap. The scripts are written for 60 steps a second; the same motion is also measured at 30 and at 240.\n",
        body,
        ..Page::default()
    };
    Ok(page.about(rows.iter().map(Record::origin)))
}
