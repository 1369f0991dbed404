//! The work and the time of every method in a scene.

use morph_collision_testkit::report::{NOTHING, Table};

use crate::report::record::{Record, Scene, scenes};

/// How to read [`details`].
pub(crate) const HOW_TO_READ: &str = "Counts are per frame, over all bodies: volumes blended (or refitted, or built), vertices blended, boxes tested against boxes,\n\
    pairs of triangles passed to the exact test. They are the same on every machine. Times are ratios to that of the first row.\n";

/// A table for each scene: the work and the time of every method.
pub(crate) fn details(rows: &[Record]) -> String {
    scenes(rows).map(details_of).collect()
}

fn details_of(scene: Scene<'_>) -> String {
    let wanted = scene.wanted();
    let mut head = vec![String::new()];
    for wanted in &wanted {
        head.push(format!("{wanted}: volumes"));
        head.extend(["vertices", "node tests", "triangle tests", "time"].map(str::to_owned));
    }
    let mut table = Table::new(head);
    let mut times = Vec::new();
    for wanted in &wanted {
        if let Some(base) = scene.asked(wanted).next() {
            let found = base.found.map_or(String::new(), |found| format!(" ({found} found)"));
            times.push(format!("{:.1} us for {wanted}{found}", base.microseconds));
        }
    }
    let mut frames = 0;
    for row in wanted.first().into_iter().flat_map(|wanted| scene.asked(wanted)) {
        let mut cells = vec![row.method.clone()];
        for wanted in &wanted {
            let Some(row) = scene.row(&row.method, wanted) else {
                cells.extend([NOTHING; 5].map(str::to_owned));
                continue;
            };
            let counts = [row.volumes, row.vertices, row.node_tests, row.triangle_tests];
            cells.extend(counts.map(|count| format!("{count:.0}")));
            cells.push(format!("{:.2}", row.ratio));
        }
        frames = row.frames;
        table.row(cells);
    }
    format!(
        "\n**{}.**\n{frames} frames; time 1 is {}.\n\n{table}",
        scene.title(),
        times.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::comparison::tests::heads;

    #[test]
    fn details_have_a_row_for_each_method_and_columns_for_each_question() {
        let mut rows = heads();
        rows[0].found = Some(12.5);
        let details = details(&rows);
        let caption = "**The heads.**\n20 frames; time 1 is 10.0 us for all (12.5 found), 10.0 us for first.";
        assert!(details.contains(caption), "{details}");
        assert!(
            details.contains("| hybrid | 0 | 0 | 0 | 0 | 3.00 | 0 | 0 | 0 | 0 | 0.90 |"),
            "{details}"
        );
    }
}
