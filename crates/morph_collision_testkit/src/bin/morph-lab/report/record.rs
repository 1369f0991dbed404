//! A method's time and work in a scene, as it is stored.

use morph_collision_testkit::bench::{Experiment, Row};
use morph_collision_testkit::report::short;
use serde::{Deserialize, Serialize};

/// All pairs of triangles are wanted.
pub(crate) const ALL: &str = "all";
/// One pair of triangles is wanted for each pair of bodies.
pub(crate) const FIRST: &str = "first";

/// A measured row. Numbers are those of a frame on average.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// A short name, which is the same in all topics.
    pub(crate) scene: String,
    pub(crate) title: String,
    /// What grows in a series of scenes of the same name, for example the number of triangles.
    pub(crate) size: Option<usize>,
    /// The question: [`ALL`], [`FIRST`], or a number of rays.
    pub(crate) wanted: String,
    pub(crate) method: String,
    pub(crate) frames: usize,
    /// Pairs of triangles, or rays that hit, if they were counted.
    pub(crate) found: Option<f64>,
    pub(crate) volumes: f64,
    pub(crate) vertices: f64,
    pub(crate) node_tests: f64,
    pub(crate) triangle_tests: f64,
    pub(crate) microseconds: f64,
    /// Time over that of the first method that was asked the same.
    pub(crate) ratio: f64,
    /// Day, commit, machine, and how often.
    pub(crate) measured: String,
}

impl Record {
    /// Where it is from, and what it is about.
    pub(crate) fn origin(&self) -> (&str, &str) {
        (&self.measured, short_title(&self.title))
    }

    /// A row of a benchmark.
    pub(crate) fn new(experiment: &Experiment, wanted: &str, row: &Row, measured: String) -> Self {
        let frames = experiment.frames.len();
        let each = |count: u64| short(count as f64 / frames.max(1) as f64);
        Self {
            scene: experiment.name.clone(),
            title: experiment.title.clone(),
            size: None,
            wanted: wanted.to_owned(),
            method: row.name.clone(),
            frames,
            found: Some(each(row.pairs())),
            volumes: each(row.work.nodes_blended),
            vertices: each(row.work.vertices_blended),
            node_tests: each(row.work.node_tests),
            triangle_tests: each(row.work.triangle_tests),
            microseconds: short(row.time * 1e6),
            ratio: short(row.ratio),
            measured,
        }
    }
}

/// A title without numbers of targets and joints.
pub(crate) fn short_title(title: &str) -> &str {
    title.split(" with ").next().unwrap_or(title)
}

/// The rows of a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a>(&'a [Record]);

/// Rows grouped by scenes, in the order of the rows.
pub(crate) fn scenes(rows: &[Record]) -> impl Iterator<Item = Scene<'_>> + Clone {
    rows.chunk_by(|a, b| (&a.scene, a.size) == (&b.scene, b.size))
        .map(Scene)
}

/// A scene by name.
pub(crate) fn scene<'a>(rows: &'a [Record], name: &str) -> Option<Scene<'a>> {
    scenes(rows).find(|scene| scene.name() == name)
}

impl<'a> Scene<'a> {
    pub(crate) fn name(self) -> &'a str {
        &self.0[0].scene
    }

    pub(crate) fn title(self) -> &'a str {
        &self.0[0].title
    }

    pub(crate) fn size(self) -> Option<usize> {
        self.0[0].size
    }

    /// The questions.
    pub(crate) fn wanted(self) -> Vec<&'a str> {
        let mut wanted: Vec<&str> = Vec::new();
        for row in self.0 {
            if !wanted.contains(&row.wanted.as_str()) {
                wanted.push(&row.wanted);
            }
        }
        wanted
    }

    /// The methods that were asked a question, the one that the others are compared with first.
    pub(crate) fn asked(self, wanted: &str) -> impl Iterator<Item = &'a Record> + Clone {
        self.0.iter().filter(move |row| row.wanted == wanted)
    }

    pub(crate) fn row(self, method: &str, wanted: &str) -> Option<&'a Record> {
        self.asked(wanted).find(|row| row.method == method)
    }

    /// A method's time as a ratio to that of the first method.
    pub(crate) fn ratio(self, method: &str, wanted: &str) -> Option<f64> {
        Some(self.row(method, wanted)?.ratio)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Rows of a scene: methods with their ratios for all and for first pairs.
    pub(crate) fn scene_of(name: &str, ratios: &[(&str, f64, f64)]) -> Vec<Record> {
        let row = |wanted: &str, method: &str, ratio: f64| Record {
            scene: name.to_owned(),
            title: format!("The {name}"),
            wanted: wanted.to_owned(),
            method: method.to_owned(),
            frames: 20,
            microseconds: 10.0 * ratio,
            ratio,
            ..Record::default()
        };
        let all = ratios.iter().map(|&(method, all, _)| row(ALL, method, all));
        let first = ratios.iter().map(|&(method, _, first)| row(FIRST, method, first));
        all.chain(first).collect()
    }

    #[test]
    fn rows_are_found_by_scene_question_and_method() {
        let mut rows = scene_of(
            "dolphins",
            &[("morph", 1.0, 1.0), ("hybrid", 3.0, 2.0), ("bottom-up", 9.0, 1.5)],
        );
        rows.extend(scene_of("heads", &[("morph", 1.0, 1.0)]));
        assert_eq!(
            scenes(&rows).map(Scene::name).collect::<Vec<_>>(),
            ["dolphins", "heads"]
        );
        let dolphins = scene(&rows, "dolphins").expect("it is there");
        assert_eq!(dolphins.wanted(), [ALL, FIRST]);
        assert_eq!(dolphins.asked(FIRST).count(), 3);
        assert_eq!(dolphins.ratio("hybrid", ALL), Some(3.0));
        assert_eq!(dolphins.ratio("paper", ALL), None);
        assert!(scene(&rows, "horses").is_none());
    }

    #[test]
    fn scenes_of_a_series_differ_by_size() {
        let mut rows = scene_of("targets", &[("morph", 1.0, 1.0)]);
        let mut larger = rows.clone();
        larger.iter_mut().for_each(|row| row.size = Some(8));
        rows.extend(larger);
        assert_eq!(scenes(&rows).map(Scene::size).collect::<Vec<_>>(), [None, Some(8)]);
    }
}
