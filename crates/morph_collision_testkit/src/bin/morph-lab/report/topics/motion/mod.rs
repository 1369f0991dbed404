//! What queries about motion cost: instructions, single pairs of features, and recorded frames.

mod features;
mod frames;
mod timing;

use std::error::Error;

use morph_collision_testkit::motion::records::find_records;
use morph_collision_testkit::report::Store;

use super::Topic;
use crate::report::context::Context;
use crate::report::counts::{self, Count};
use crate::report::page::Page;
use features::Queried;
use frames::Recorded;

const NAME: &str = "motion";
const QUERIES: &str = "motion_queries";
const FRAMES: &str = "motion_frames";

pub(super) const TOPIC: Topic = Topic::on_one_core(NAME, measure, page);

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let (queries, pairs) = match (find_records("ccdq"), find_records("ccdp")) {
        (Ok(queries), Ok(pairs)) => (queries, pairs),
        (Err(missing), _) | (_, Err(missing)) => {
            eprintln!("{NAME}: {missing}; its rows stay as they are");
            return Ok(());
        }
    };
    let Context {
        rounds, origin, store, ..
    } = context;
    store.write(QUERIES, &features::measure(&queries, &pairs, *rounds, origin)?)?;
    store.write(FRAMES, &frames::measure(&pairs, *rounds, origin)?)
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let counts: Vec<Count> = store.rows(counts::MOTION)?;
    let (queried, recorded): (Vec<Queried>, Vec<Recorded>) = (store.rows(QUERIES)?, store.rows(FRAMES)?);
    let page = Page {
        name: NAME,
        title: "Motion",
        intro: "What queries about a motion cost (`motion::MotionQuery`).\n",
        command: "just instructions-report; just report --only motion",
        data: &[counts::MOTION, QUERIES, FRAMES],
        body: format!(
            "## Next to a discrete query\n\n\
             Thousand instructions per step, weights and transforms included. Two dolphins of 9024 triangles change their shapes in every step. The second one\n\
             moves by a share of its length in each of 40 steps: five lengths away (*apart*), close *beside* the first one, or *through* it.\n\n\
             - *discrete* is `PairQuery::any` at the end of each step; *motion* and *first* are `MotionQuery::any` and `first` (tolerance 1e-3).\n\
             - *touch* columns count the steps in which the bodies touch, for a discrete query and for the motion. A body that passes through another within\n  \
               a step is found at any speed; the discrete query sees it only if a step happens to end inside.\n\
             - A query about a motion needs the bounds of two poses instead of one.\n\
             - `first` visits nodes in the order of time. In a step in which two bodies pass all the way through each other, very many pairs of features touch at\n  \
               nearly the same time. They are compared for a while; then the tolerance decides which of them count as first.\n\n\
             {}\n\
             ## Pairs of features\n\n\
             Recorded motions of a vertex and a face, or of two edges, most of them from frames of simulations in which their boxes overlap. *Whether* asks if\n\
             they touch on the way, *when* also asks for the time (tolerance 1e-6). Queries are grouped by the stage that decides them. Each row repeats only\n\
             its own queries, so a processor predicts its branches better than in a game. `just motions` compares all answers with the recorded ones.\n\n\
             {}\n\
             ## Recorded frames\n\n\
             Models with one target, each against itself, from one recorded frame of a simulation to the next. A test compares the contacts with the recording.\n\
             *Walk* is `MotionQuery::all_within` with new poses, which finds its pairs itself. *List* tests the pairs that the recording lists, one after the\n\
             other, and does not include finding them: they are mostly what was left by the boxes of another program. A list may have contacts that vanish when\n\
             positions are rounded to the `f32` of a model. *Exactly* counts the pairs that the filter leaves to exact arithmetic.\n\n{}",
            counts::table(&counts, "lengths in a step"),
            features::table(&queried),
            frames::table(&recorded),
        ),
        ..Page::default()
    };
    let queried = queried.iter().map(|row| (row.measured.as_str(), "pairs of features"));
    let recorded = recorded.iter().map(|row| (row.measured.as_str(), row.frames.as_str()));
    Ok(page.about(counts.iter().map(Count::origin).chain(queried).chain(recorded)))
}
