//! Conclusions from rows: how much longer other methods take, and what the lower limit is.

use morph_collision_testkit::report::{Table, ratios};

use crate::report::record::{Record, Scene, scenes, short_title};

/// A title, and the methods of which the fastest is shown.
type Rival = (&'static str, &'static [&'static str]);

const RIVALS: [Rival; 6] = [
    ("hybrid", &["hybrid"]),
    ("full refit", &["bottom-up"]),
    (AS_USUALLY_WRITTEN, &["hybrid-scalar", "bottom-up-scalar"]),
    ("Parry, refitted", &["parry-trimesh"]),
    ("the paper's method", &["paper"]),
    ("boxes per joint", &["joint-boxes"]),
];

/// The title of the scalar forms of the hybrid and the full refit.
pub(crate) const AS_USUALLY_WRITTEN: &str = "as usually written";

/// How to read [`rivals`].
pub(crate) const HOW_TO_READ: &str = "How long the other methods take, as a multiple of our time; below 1 they are faster. \"-\" means that a method does not do this.\n\
    *Hybrid* and *full refit* (`bottom-up`) use our code: our kernels, trees, walks and tests of triangles. So their numbers compare methods only.\n\
    *As usually written* is the faster of both in plain code, one vertex, box and triangle at a time; its numbers include engineering.\n";

/// For each scene, the time of the rivals over ours.
pub(crate) fn rivals<'a>(scenes: impl Iterator<Item = Scene<'a>>, head: &str) -> Table {
    times_over_ours(scenes, head, &RIVALS)
}

/// The same for those rivals that refit a tree.
pub(crate) fn refitting_rivals<'a>(scenes: impl Iterator<Item = Scene<'a>>, head: &str) -> Table {
    times_over_ours(scenes, head, &RIVALS[..4])
}

fn times_over_ours<'a>(scenes: impl Iterator<Item = Scene<'a>>, head: &str, rivals: &[Rival]) -> Table {
    let mut table = Table::new([head].into_iter().chain(rivals.iter().map(|(name, _)| *name)));
    for scene in scenes {
        let wanted = scene.wanted();
        let cell = |methods| ratios(wanted.iter().map(|wanted| fastest(scene, methods, wanted)));
        let cells = rivals.iter().map(|(_, methods)| cell(methods));
        table.row([short_title(scene.title()).to_owned()].into_iter().chain(cells));
    }
    table.without_empty_columns()
}

/// The smallest ratio of some methods.
pub(crate) fn fastest(scene: Scene<'_>, methods: &[&str], wanted: &str) -> Option<f64> {
    let ratios = methods.iter().filter_map(|method| scene.ratio(method, wanted));
    ratios.min_by(f64::total_cmp)
}

/// For each scene, the ratio of every method.
pub(crate) fn every_method(rows: &[Record], head: &str) -> Table {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let mut table = Table::new([head].into_iter().chain(methods.iter().copied()));
    for scene in scenes(rows) {
        let cell = |method| ratios(scene.wanted().iter().map(|wanted| scene.ratio(method, wanted)));
        let cells = methods.iter().map(|method| cell(method));
        table.row([scene.title().to_owned()].into_iter().chain(cells));
    }
    table
}

/// For each scene, how far ours is from the lower limit, and what engineering gains for the full refit.
pub(crate) fn limits<'a>(scenes: impl Iterator<Item = Scene<'a>>) -> String {
    let mut table = Table::new([
        "all pairs / first pairs",
        "lower limit's time",
        "its triangle tests",
        "full refit, over it as usually written",
    ]);
    for scene in scenes {
        let wanted = scene.wanted();
        let cell = |of: &dyn Fn(&'a str) -> Option<f64>| ratios(wanted.iter().map(|wanted| of(wanted)));
        let tests = |method, wanted: &'a str| Some(scene.row(method, wanted)?.triangle_tests);
        table.row([
            scene.title().to_owned(),
            cell(&|wanted| scene.ratio("rigid-floor", wanted)),
            cell(&|wanted| Some(tests("rigid-floor", wanted)? / tests("morph", wanted)?)),
            cell(&|wanted| Some(scene.ratio("bottom-up", wanted)? / scene.ratio("bottom-up-scalar", wanted)?)),
        ]);
    }
    format!(
        "All numbers are ratios to ours, except the last column.\n\n\
         - The *lower limit* is our own tree over shapes that are frozen or posed beforehand (`rigid-floor`): nothing is blended, and all boxes are\n  \
           tight. The rest of our time is blending, and tests that tight boxes would have saved. So is the rest of our triangle tests.\n\
         - *Full refit, over it as usually written*: `bottom-up` and `bottom-up-scalar` do the same work. Below 1, our code does it faster: the gain of\n  \
           the engineering. The gain of the method is the column *full refit* above.\n\n{table}"
    )
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::report::record::tests::scene_of;

    pub(crate) fn heads() -> Vec<Record> {
        scene_of(
            "heads",
            &[
                ("morph", 1.0, 1.0),
                ("bottom-up", 2.0, 8.0),
                ("rigid-floor", 0.5, 0.25),
                ("bottom-up-scalar", 4.0, 16.0),
                ("hybrid", 3.0, 0.9),
                ("hybrid-scalar", 3.5, 17.0),
                ("parry-trimesh", 7.0, 30.0),
            ],
        )
    }

    #[test]
    fn columns_without_rivals_are_left_out() {
        let table = rivals(scenes(&heads()), "all / first").to_string();
        assert_eq!(
            table,
            "| all / first | hybrid | full refit | as usually written | Parry, refitted |\n|---|--:|--:|--:|--:|\n\
             | The heads | 3.0 / 0.90 | 2.0 / 8.0 | 3.5 / 16 | 7.0 / 30 |\n"
        );
    }

    #[test]
    fn every_method_has_a_column() {
        let mut rows = scene_of("a", &[("x", 1.0, 1.0), ("y", 2.0, 3.0)]);
        rows.extend(scene_of("b", &[("x", 1.0, 1.0)]));
        let table = every_method(&rows, "all / first").to_string();
        assert!(
            table.ends_with("| The a | 1.0 / 1.0 | 2.0 / 3.0 |\n| The b | 1.0 / 1.0 | - |\n"),
            "{table}"
        );
    }

    #[test]
    fn the_limits_compare_methods_with_the_right_base() {
        let mut rows = heads();
        for row in &mut rows {
            row.triangle_tests = if row.method == "rigid-floor" { 30.0 } else { 60.0 };
        }
        let limits = limits(scenes(&rows));
        assert!(
            limits.contains("| The heads | 0.50 / 0.25 | 0.50 / 0.50 | 0.50 / 0.50 |"),
            "{limits}"
        );
    }
}
