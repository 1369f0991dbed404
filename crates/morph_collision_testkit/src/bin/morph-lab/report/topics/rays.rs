//! Rays at a head and at a skinned character, with every method that casts them.

use std::error::Error;

use morph_collision_testkit::bench::Experiment;

use super::EveryMethod;
use crate::report::race::Source;

pub(super) struct Rays;

impl EveryMethod for Rays {
    const NAME: &'static str = "rays";
    const TITLE: &'static str = "Rays";
    const INTRO: &'static str = "The closest hit of one ray or of a hundred rays in a frame, on a talking head and on a skinned character that walks and talks. New weights\n\
        and new joints arrive in every frame.\n\
        \n\
        - Most rivals place all vertices, refit, and cast. They pay for that once, however many rays there are. Ours blends the boxes that each ray is\n  \
          the first to visit. `hybrid` and `bottom-up` cast with our walk and our exact test.\n\
        - `joint-boxes` fits boxes to the posed vertices only where a ray visits.\n\
        - The other rivals test triangles in `f64` without a guarantee at edges; our test is exact.\n\
        - `bottom-up` has tight boxes in our tree, so its node tests are the least that a ray needs. Parry's node tests are not counted.\n";
    const QUESTIONS: &'static str = "one ray / a hundred rays";

    fn sources(every: usize) -> Result<Vec<Source>, Box<dyn Error>> {
        let mut sources = Vec::new();
        for (name, _) in Experiment::with_rays() {
            // One and a hundred rays are two questions about the same scene.
            let scene = name.rsplit_once('-').map_or(name, |(scene, _)| scene);
            sources.push(Source::named(name, every)?.renamed(scene.to_owned(), |experiment| {
                experiment.title = experiment.title.replace("a ray", "rays");
            }));
        }
        Ok(sources)
    }
}
