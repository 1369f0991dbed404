//! What was aimed for, what was reached, and what the lower limit would reach.

mod series;

use std::error::Error;

use super::{Measure, Topic, frame_to_frame, methods, no_losses, rays, skinned};
use crate::candidates::WITNESS;
use crate::comparison::{BAKE_AND_REFIT, HYBRID, PARRY};
use crate::page::Page;
use crate::record::{ALL, FIRST, Record, Scene, scene};
use crate::store::Store;
use crate::table::{NOTHING, Table, ratios};

pub(super) const TOPIC: Topic = Topic {
    name: "goals",
    measure: Measure::Computed,
    page,
    losses: no_losses,
};

/// How many times as long as ours the best of some methods should take, for all and for first pairs. Without numbers it is only
/// shown.
struct Goal {
    scene: &'static str,
    title: &'static str,
    rivals: &'static [&'static str],
    times: Option<[f64; 2]>,
}

const fn goal(scene: &'static str, title: &'static str, rivals: &'static [&'static str], times: [f64; 2]) -> Goal {
    Goal {
        scene,
        title,
        rivals,
        times: Some(times),
    }
}

const fn shown(scene: &'static str, title: &'static str, rivals: &'static [&'static str]) -> Goal {
    Goal {
        scene,
        title,
        rivals,
        times: None,
    }
}

const SMALL: &str = "dolphins-564";
const LARGE: &str = "dolphins-36096";
const PASS_THROUGH: &str = "pass-through-20480";

/// Five times for all pairs, twenty times for first pairs.
const OF_CHARACTERS: [f64; 2] = [5.0, 20.0];
/// For one ray at a character.
const OF_A_RAY: f64 = 50.0;

const GOALS: [Goal; 12] = [
    goal(PASS_THROUGH, "pass-through, hybrid", HYBRID, [20.0, 100.0]),
    goal(SMALL, "dolphins of 564 triangles, hybrid", HYBRID, [20.0, 20.0]),
    goal(LARGE, "dolphins of 36096 triangles, hybrid", HYBRID, [30.0, 150.0]),
    goal(PASS_THROUGH, "pass-through, Parry", PARRY, [10.0, 400.0]),
    goal(SMALL, "dolphins of 564 triangles, Parry", PARRY, [15.0, 25.0]),
    goal(LARGE, "dolphins of 36096 triangles, Parry", PARRY, [100.0, 1000.0]),
    goal(
        "walkers-hands",
        "walkers, hands touching, bake and refit",
        BAKE_AND_REFIT,
        OF_CHARACTERS,
    ),
    shown("walkers-hands", "the same, hybrid", HYBRID),
    goal(
        "walkers-deep",
        "walkers, deep in each other, bake and refit",
        BAKE_AND_REFIT,
        OF_CHARACTERS,
    ),
    shown("walkers-deep", "the same, hybrid", HYBRID),
    goal(
        "walkers-crowd",
        "walkers, in a crowd, bake and refit",
        BAKE_AND_REFIT,
        OF_CHARACTERS,
    ),
    shown("walkers-crowd", "the same, hybrid", HYBRID),
];

/// The rows that goals are compared with.
struct Rows {
    /// Single frames.
    frames: Vec<Record>,
    /// Consecutive ones.
    frame_to_frame: Vec<Record>,
    rays: Vec<Record>,
}

impl Rows {
    fn read(store: &Store) -> Result<Self, Box<dyn Error>> {
        let mut frames: Vec<Record> = store.rows(methods::NAME)?;
        frames.extend(store.rows::<Record>(skinned::NAME)?);
        Ok(Self {
            frames,
            frame_to_frame: store.rows(frame_to_frame::NAME)?,
            rays: store.rows(rays::NAME)?,
        })
    }

    fn table(&self) -> Table {
        let mut table = Table::new([
            "",
            "wanted",
            "goal",
            "reached",
            "reached from frame to frame",
            "at the lower limit",
        ]);
        for goal in &GOALS {
            let frames = scene(&self.frames, goal.scene);
            let consecutive = scene(&self.frame_to_frame, &frame_to_frame::at_60(goal.scene));
            let over = |scene: Option<Scene<'_>>, base: &str| {
                let times = |wanted| {
                    scene.and_then(|scene| Some(scene.best(goal.rivals, wanted)? / scene.ratio(base, wanted)?))
                };
                ratios([ALL, FIRST].map(times))
            };
            table.row([
                goal.title.to_owned(),
                "all / first".to_owned(),
                goal.times
                    .map_or(String::new(), |times| times.map(|times| times.to_string()).join(" / ")),
                over(frames, "morph"),
                over(consecutive, WITNESS),
                over(frames, "rigid-floor"),
            ]);
        }
        let ray = scene(&self.rays, "walkers").and_then(|scene| scene.best(BAKE_AND_REFIT, "1 ray"));
        table.row([
            "one ray at a walker, bake and refit".to_owned(),
            "1 ray".to_owned(),
            OF_A_RAY.to_string(),
            ratios([ray]),
            NOTHING.to_owned(),
            NOTHING.to_owned(),
        ]);
        table
    }

    /// Where the rows are from, and the pages that show them.
    fn origins(&self) -> Vec<(String, &'static str)> {
        let pages = [
            (&self.frames, "frames"),
            (&self.frame_to_frame, "frame to frame"),
            (&self.rays, "rays"),
        ];
        let of_page = |(rows, title): (&Vec<Record>, &'static str)| -> Vec<_> {
            rows.iter().map(|row| (place(&row.measured), title)).collect()
        };
        pages.into_iter().flat_map(of_page).collect()
    }
}

fn page(store: &Store) -> Result<Page, Box<dyn Error>> {
    let rows = Rows::read(store)?;
    let page = Page {
        name: TOPIC.name,
        title: "Goals",
        intro: "What was aimed for, and what the other pages say about it.\n",
        command: "just report",
        data: &[methods::NAME, skinned::NAME, frame_to_frame::NAME, rays::NAME],
        body: format!(
            "## Against other methods\n\n\
             Numbers are how many times as long as ours another method takes.\n\n\
             - *Bake and refit* is the best of the methods that place all vertices and refit all boxes (`bottom-up`, Parry's). The hybrid refits only boxes that\n  \
               a query visits.\n\
             - *From frame to frame*: consecutive frames, 60 a second, with a remembered pair ([frame to frame](frame_to_frame.md)). It helps only first pairs.\n\
             - *At the lower limit*: what our tree would reach if blending cost nothing and all boxes were tight (`rigid-floor`). A goal beyond it cannot be\n  \
               reached with this tree, walk and triangle test.\n\n{}\n\
             ## Others\n\n{}",
            rows.table(),
            series::table(store)?,
        ),
        ..Page::default()
    };
    let origins = [rows.origins(), series::origins(store)?].concat();
    Ok(page.about(origins.iter().map(|(measured, title)| (measured.as_str(), *title))))
}

/// Day, commit and machine of a row, without how often it was measured.
fn place(measured: &str) -> String {
    measured.split(": ").next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::scene_of;

    #[test]
    fn a_goal_is_compared_with_the_best_rival_of_its_kind() {
        let rows = Rows {
            frames: scene_of(
                "walkers-deep",
                &[
                    ("morph", 1.0, 1.0),
                    ("rigid-floor", 0.5, 0.1),
                    ("bottom-up", 4.0, 20.0),
                    ("parry-bvh", 5.0, 12.0),
                    ("hybrid", 3.0, 6.0),
                ],
            ),
            frame_to_frame: scene_of(
                "walkers-deep-at-60",
                &[
                    ("morph", 1.0, 1.0),
                    (WITNESS, 1.0, 0.5),
                    ("bottom-up", 4.0, 14.0),
                    ("hybrid", 2.0, 6.0),
                ],
            ),
            rays: Vec::new(),
        };
        let table = rows.table().to_string();
        let expected = "| walkers, deep in each other, bake and refit | all / first | 5 / 20 | 4.0 / 12 | 4.0 / 28 | 8.0 / 120 |\n\
                        | the same, hybrid | all / first | | 3.0 / 6.0 | 2.0 / 12 | 6.0 / 60 |\n";
        assert!(table.contains(expected), "{table}");
        assert!(
            table.contains("| walkers, in a crowd, bake and refit | all / first | 5 / 20 | - | - | - |"),
            "{table}"
        );
        assert!(
            table.ends_with("| one ray at a walker, bake and refit | 1 ray | 50 | - | - | - |\n"),
            "{table}"
        );
    }
}
