//! Instructions of the scenes, and of build profiles.

use std::error::Error;

use morph_collision_testkit::report::{Store, Table, ratios};

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
        body: of_scenes(&scenes) + &of_profiles(&profiles),
        ..Page::default()
    };
    Ok(page.about(scenes.iter().chain(&profiles).map(Count::origin)))
}

/// The methods beside ours in the table of scenes.
const OTHERS: [&str; 2] = ["hybrid", "bottom-up"];

/// The section about the scenes, if they were counted. Columns are a method and a question.
fn of_scenes(counts: &[Count]) -> String {
    if counts.is_empty() {
        return String::new();
    }
    let mut scenes: Vec<&str> = counts.iter().map(|count| count.row.as_str()).collect();
    scenes.dedup();
    let mut table = Table::new([
        "all pairs / first pairs",
        "ours, millions",
        "over the floor",
        "hybrid",
        "full refit",
    ]);
    for scene in scenes {
        let value = |method: &str, wanted: &str| {
            let column = format!("{method},{wanted}");
            let mut counts = counts.iter();
            Some(counts.find(|count| count.row == scene && count.column == column)?.value)
        };
        let asked = ["all", "first"].into_iter();
        let asked = asked.filter(|wanted| value("morph", wanted).is_some());
        let ours = asked.clone().filter_map(|wanted| value("morph", wanted));
        let ours: Vec<_> = ours.map(|millions| format!("{millions:.2}")).collect();
        let over = |method, other| {
            let over = |wanted| Some(value(method, wanted)? / value(other, wanted)?);
            ratios(asked.clone().map(over))
        };
        let others = OTHERS.map(|method| over(method, "morph"));
        let cells = [scene.to_owned(), ours.join(" / "), over("morph", "rigid-floor")];
        table.row(cells.into_iter().chain(others));
    }
    format!(
        "## Scenes\n\nMillion instructions of 20 frames, for all pairs and for first pairs (for rays, both are the same); over those of the floor, which are the same queries\n\
         of bodies that do not deform, with tight boxes (it casts no rays); and how many times as many the hybrid and the full refit take, which use our code.\n\n{table}"
    )
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
    fn other_methods_are_compared_with_ours_for_each_question() {
        let count = |row: &str, column: &str, value| Count {
            row: row.to_owned(),
            column: column.to_owned(),
            value,
            measured: String::new(),
        };
        let counts = [
            count("hands", "morph,all", 2.0),
            count("hands", "morph,first", 1.0),
            count("hands", "rigid-floor,all", 0.5),
            count("hands", "rigid-floor,first", 0.8),
            count("hands", "hybrid,all", 3.0),
            count("hands", "hybrid,first", 0.5),
            count("rays", "morph,all", 4.0),
            count("rays", "bottom-up,all", 20.0),
        ];
        let section = of_scenes(&counts);
        for row in [
            "| hands | 2.00 / 1.00 | 4.0 / 1.2 | 1.5 / 0.50 | - |",
            "| rays | 4.00 | - | - | 5.0 |",
        ] {
            assert!(section.contains(row), "{section}");
        }
        assert_eq!(of_scenes(&[]), "");
    }

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
