//! Skinned characters with every method.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;

use super::EveryMethod;
use crate::report::race::Source;

pub(super) struct Skinned;

impl EveryMethod for Skinned {
    const NAME: &'static str = "skinned";
    const TITLE: &'static str = "Skinned characters";
    const INTRO: &'static str = "Characters of `mh_character.glb` walk and talk. New joints and new weights arrive in every frame: two whose hands touch, two deep inside each\n\
        other, and twelve in a crowd. [Frame to frame](frame_to_frame.md) has the same scenes in consecutive frames, with and without a remembered\n\
        pair.\n\
        \n\
        - `bottom-up`, `hybrid` and Parry's place every vertex by its joints in every frame, and then refit. The first two use our kernels and our tree,\n  \
          and their scalar forms plain loops.\n\
        - `joint-boxes` (boxes per joint) has a tree over the mesh at rest, whose nodes know which joints move them. Only where a query visits, it\n  \
          computes boxes from a box per joint, and skins vertices.\n\
        - What remains in ours: vertices and boxes of a part of a character are computed together when a query first looks at it, also those that\n  \
          the query does not need ([skinning.md](../skinning.md)).\n";

    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>> {
        let scenes = Experiment::walkers().map(|(name, _)| Source::named(name, every));
        Ok(scenes.collect::<Result<_, _>>()?)
    }
}
