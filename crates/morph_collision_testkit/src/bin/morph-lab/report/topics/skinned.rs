//! Skinned characters with every method.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;

use super::{Measure, Topic, page_of_methods};
use crate::report::candidates;
use crate::report::context::Context;
use crate::report::losses::losses;
use crate::report::page::{Origins, Page};
use crate::report::race::{Source, measure_topic};
use crate::report::record::Record;

pub(super) const NAME: &str = "skinned";

pub(super) const TOPIC: Topic = Topic {
    name: NAME,
    measure: Measure::OneCore(measure),
    page: |store| page_of_methods(store, PAGE, "all pairs / first pairs"),
    losses: |store| Ok(losses(&store.rows::<Record>(NAME)?)),
};

const PAGE: Page = Page {
    name: NAME,
    title: "Skinned characters",
    intro: "Characters of `mh_character.glb` walk and talk. New joints and new weights arrive in every frame: two whose hands touch, two deep inside each\n\
        other, and twelve in a crowd. [Frame to frame](frame_to_frame.md) has the same scenes in consecutive frames, with and without a remembered\n\
        pair.\n\
        \n\
        - `bottom-up`, `hybrid` and Parry's place every vertex by its joints in every frame, and then refit.\n\
        - `joint-boxes` (boxes per joint) has a tree over the mesh at rest, whose nodes know which joints move them. Only where a query visits, it\n  \
          computes boxes from a box per joint, and skins vertices.\n\
        - Two costs remain in ours: the bounds of a character whose joints have all moved, because dozens of joints meet in the root's children, and\n  \
          boxes that are looser than fitted ones because they hold for all weights of joints ([skinning.md](../skinning.md)).\n",
    command: "just report --only skinned",
    data: &[NAME],
    origins: Origins::NONE,
    body: String::new(),
};

fn measure(context: &Context) -> Result<(), Box<dyn Error>> {
    let scenes = Experiment::walkers().map(|(name, _)| Source::named(name, context.every));
    measure_topic(
        context,
        NAME,
        scenes.collect::<Result<Vec<_>, _>>()?,
        candidates::methods,
        context.rounds,
    )
}
