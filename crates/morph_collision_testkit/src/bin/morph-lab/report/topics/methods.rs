//! Every method on generated meshes.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;

use super::{Measure, Topic, page_of_methods};
use crate::report::candidates;
use crate::report::context::Context;
use crate::report::losses::losses;
use crate::report::page::{Origins, Page};
use crate::report::race::{Source, measure_topic};
use crate::report::record::Record;

pub(super) const NAME: &str = "methods";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page: |store| page_of_methods(store, PAGE, "all pairs / first pairs"),
    losses: |store| Ok(losses(&store.rows::<Record>(NAME)?)),
};

const PAGE: Page = Page {
    name: NAME,
    title: "Every method on generated meshes",
    intro: "The paper's experiments, in which two bodies pass through each other and twelve dolphins swim in a group at three resolutions, and\n\
        *blobs*: two bodies that graze each other, with 40 local targets at weights of both signs, nearly all of them active, as in a face.\n\
        *All pairs* asks for every pair of intersecting triangles, *first pairs* for one per pair of bodies. All methods give the same pairs.\n\
        \n\
        - `bottom-up` (full refit) and `hybrid` have eight-wide trees and the same order of traversal, with at most four triangles in a leaf. The\n  \
          test kit's module `rivals` describes each and names its source.\n\
        - `paper` is the paper's own method with its boxes: one node and one triangle at a time, in plain `f64`.\n\
        - `brute-force` is the oracle in exact integers, for scale.\n\
        - All share our exact test of two triangles. The others compare nodes and leaves one by one in plain loops, ours eight at a time with vector\n  \
          instructions. So the ratios include engineering as well as method.\n",
    command: "just report --only methods",
    data: &[NAME],
    origins: Origins::NONE,
    body: String::new(),
};

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let experiments = Experiment::tuning(context.every).into_iter().map(Source::from);
    measure_topic(context, NAME, experiments, candidates::methods, context.rounds)
}
