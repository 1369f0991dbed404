//! Instructions of the scenes, and of build profiles.

use std::error::Error;

use morph_collision_testkit::report::Store;

use super::{Measure, Topic, no_losses};
use crate::report::counts::{self, Count};
use crate::report::page::Page;

pub(super) const TOPIC: Topic = Topic {
    name: "instructions",
    measure: Measure::Computed,
    page,
    losses: no_losses,
};

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let (scenes, profiles): (Vec<Count>, Vec<Count>) = (store.rows(counts::SCENES)?, store.rows(counts::PROFILES)?);
    let page = Page {
        name: TOPIC.name,
        title: "Instructions",
        intro: "The number of instructions does not depend on what else the machine does, but on its vector instructions. It is counted by callgrind\n\
            (valgrind).\n",
        command: "just instructions-report",
        data: &[counts::SCENES, counts::PROFILES],
        body: format!(
            "## Scenes\n\nMillion instructions of 20 frames, for all pairs and for first pairs (for rays, both are the same):\n\n{}{}",
            counts::table(&scenes, "scene"),
            of_profiles(&profiles),
        ),
        ..Page::default()
    };
    Ok(page.about(scenes.iter().chain(&profiles).map(Count::origin)))
}

/// The section about build profiles, if they were measured.
fn of_profiles(profiles: &[Count]) -> String {
    if profiles.is_empty() {
        return String::new();
    }
    format!(
        "\n## Build profile\n\nThe effect of whole-program optimisation on a game, as a ratio to cargo's default release profile, which this workspace uses except\n\
         for `debug = false`. Kernels are inlined within the crate in any case. *Size* is that of the measured program.\n\n{}",
        counts::table(&relative(profiles), "profile"),
    )
}

/// Counts over those of the first row.
fn relative(counts: &[Count]) -> Vec<Count> {
    let base = |column: &str| {
        counts
            .iter()
            .find(|count| count.column == column)
            .map_or(1.0, |count| count.value)
    };
    let over = |count: &Count| Count {
        value: (1e3 * count.value / base(&count.column)).round() / 1e3,
        ..count.clone()
    };
    counts.iter().map(over).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_are_compared_with_the_first() {
        let count = |row: &str, value| Count {
            row: row.to_owned(),
            column: "size".to_owned(),
            value,
            measured: String::new(),
        };
        let values = relative(&[count("default", 3.0), count("fat", 1.5)])
            .into_iter()
            .map(|count| count.value);
        assert_eq!(values.collect::<Vec<_>>(), [1.0, 0.5]);
    }
}
