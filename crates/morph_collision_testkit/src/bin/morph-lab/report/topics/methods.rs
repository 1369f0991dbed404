//! Every method on generated meshes.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;

use super::EveryMethod;
use crate::report::race::Source;

pub(super) struct GeneratedMeshes;

impl EveryMethod for GeneratedMeshes {
    const NAME: &'static str = "methods";
    const TITLE: &'static str = "Every method on generated meshes";
    const INTRO: &'static str = "The paper's experiments, in which two bodies pass through each other and twelve dolphins swim in a group at three resolutions, and\n\
        *blobs*: two bodies that graze each other, with 40 local targets at weights of both signs, nearly all of them active, as in a face.\n\
        *All pairs* asks for every pair of intersecting triangles, *first pairs* for one per pair of bodies. All methods give the same pairs.\n\
        \n\
        - `bottom-up` (full refit) and `hybrid` have eight-wide trees and the same order of traversal, with at most four triangles in a leaf. The\n  \
          test kit's module `rivals` describes each and names its source.\n\
        - `paper` is the paper's own method with its boxes: one node and one triangle at a time, in plain `f64`.\n\
        - `brute-force` is the oracle in exact integers, for scale.\n\
        - All share our exact test of two triangles. The others compare nodes and leaves one by one in plain loops, ours eight at a time with vector\n  \
          instructions. So the ratios include engineering as well as method.\n";

    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>> {
        Ok(Experiment::tuning(every).into_iter().map(Source::from).collect())
    }
}
