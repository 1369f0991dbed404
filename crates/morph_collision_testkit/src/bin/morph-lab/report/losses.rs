//! Where another method is faster.

use morph_collision_testkit::report::{Table, ratio};

use crate::report::record::Record;

/// Everything that is not ours.
const ALL_RIVALS: [&str; 9] = [
    "hybrid",
    "bottom-up",
    "hybrid-scalar",
    "hybrid, binary",
    "bottom-up-scalar",
    "parry-trimesh",
    "paper",
    "joint-boxes",
    "brute-force",
];

/// A comparison that ours loses.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loss {
    scene: String,
    wanted: String,
    method: String,
    times: String,
}

impl Loss {
    /// `times` is its time over ours.
    pub(crate) fn new(
        scene: impl Into<String>,
        wanted: &str,
        method: impl Into<String>,
        times: impl Into<String>,
    ) -> Self {
        Self {
            scene: scene.into(),
            wanted: wanted.to_owned(),
            method: method.into(),
            times: times.into(),
        }
    }
}

/// All rows in which a rival is faster than ours.
pub(crate) fn losses(rows: &[Record]) -> Vec<Loss> {
    let lost = |row: &&Record| row.ratio < 1.0 && ALL_RIVALS.contains(&row.method.as_str());
    rows.iter()
        .filter(lost)
        .map(|row| {
            let size = row.size.map_or(String::new(), |size| format!(": {size}"));
            Loss::new(
                format!("{}{size}", row.title),
                &row.wanted,
                &row.method,
                ratio(row.ratio),
            )
        })
        .collect()
}

/// A table of losses, or a sentence if there are none.
pub(crate) fn losses_table(losses: &[Loss]) -> String {
    if losses.is_empty() {
        return "Nowhere in these measurements.\n".to_owned();
    }
    let mut table = Table::new(["", "wanted", "faster", "its time over ours"]);
    for loss in losses {
        table.row([&loss.scene, &loss.wanted, &loss.method, &loss.times]);
    }
    table.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::comparison::tests::heads;
    use crate::report::record::FIRST;

    #[test]
    fn only_rivals_that_are_faster_are_losses() {
        assert_eq!(losses(&heads()), [Loss::new("The heads", FIRST, "hybrid", "0.90")]);
        let mut rows = heads();
        rows.iter_mut().for_each(|row| row.size = Some(64));
        assert!(losses_table(&losses(&rows)).contains("| The heads: 64 | first | hybrid | 0.90 |"));
        assert_eq!(losses_table(&[]), "Nowhere in these measurements.\n");
    }
}
