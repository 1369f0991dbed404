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
        - `bottom-up` (full refit) and `hybrid` pose all vertices with our kernels, fit boxes to them in our tree, and then use our walk. The test\n  \
          kit's module `rivals` describes each and names its source.\n\
        - `bottom-up-scalar` and `hybrid-scalar` are the same as usually written: eight-wide trees and the same order of traversal, with at most four\n  \
          triangles in a leaf, in plain loops.\n\
        - `paper` is the paper's own method with its boxes: one node and one triangle at a time, in plain `f64`.\n\
        - `brute-force` is the oracle in exact integers, for scale.\n\
        - All share our exact test of two triangles. Ours, `bottom-up`, `hybrid` and `rigid-floor` compare nodes and leaves eight at a time with vector\n  \
          instructions, the others one by one in plain loops. So the ratios of the others include engineering as well as method.\n";

    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>> {
        Ok(Experiment::tuning(every).into_iter().map(Source::from).collect())
    }
}
