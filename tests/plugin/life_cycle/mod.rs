//! Random lives of colliders: whatever happens to them, the reported pairs are those of the oracle.
//!
//! - `zoo`: an app with a few small meshes and the entities in it.
//! - `operations`: changes to the zoo.
//! - `truth`: the expected reports, from components and brute force alone.
//! - `story`: the actual reports: messages, entity events, lists.
//! - `bodies`: the reports about bodies.

mod bodies;
mod operations;
mod story;
mod truth;
mod zoo;

use morph_collision_testkit::oracle::intersecting_pairs;

use self::bodies::BodyStory;
use self::operations::{operate, spawn};
use self::story::Story;
use self::truth::Truth;
use self::zoo::Zoo;

const SEEDS: u64 = 20;
const OPERATIONS: u32 = 200;

/// Counts of events in one life, to check that the test covers enough.
#[derive(Default, Debug)]
struct Counts {
    frames: u32,
    compared_pairs: usize,
    touching_pairs: usize,
    listed_triangle_pairs: usize,
    starts: usize,
    ends: usize,
    starts_of_many: usize,
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.frames += other.frames;
        self.compared_pairs += other.compared_pairs;
        self.touching_pairs += other.touching_pairs;
        self.listed_triangle_pairs += other.listed_triangle_pairs;
        self.starts += other.starts;
        self.ends += other.ends;
        self.starts_of_many += other.starts_of_many;
    }
}

/// Runs one life and compares after every frame.
fn live(seed: u64) -> Counts {
    let mut zoo = Zoo::new(seed);
    let (mut truth, mut story) = (Truth::default(), Story::new(&mut zoo.app));
    let mut bodies = BodyStory::new(&mut zoo.app);
    let mut counts = Counts::default();
    for _ in 0..8 {
        spawn(&mut zoo);
    }
    let mut step = 0;
    while step < OPERATIONS {
        let mut done = Vec::new();
        let mut rebuilds = false;
        for _ in 0..zoo.up_to(3) {
            let operation = operate(&mut zoo);
            rebuilds |= operation.rebuilds;
            done.push(operation.name);
            step += 1;
        }
        let context = format!("seed {seed}, operation {step}: {}", done.join(", "));
        if rebuilds || zoo.has_trees_of_its_own() {
            // Trees are built in the background, so it is not known when each one is done.
            zoo.settle(|app| {
                story.read(app, &context);
                bodies.read(app, &context);
            });
        }
        zoo.app.update();
        story.read(&mut zoo.app, &context);
        bodies.read(&mut zoo.app, &context);
        truth.update(&mut zoo);
        counts.frames += 1;
        counts.compared_pairs += truth.compared;
        counts.touching_pairs += truth.touching.len();
        counts.listed_triangle_pairs += truth.check(&zoo.app, &context);
    }

    zoo.despawn_everything();
    story.read(&mut zoo.app, "the end");
    bodies.read(&mut zoo.app, "the end");
    assert_eq!(story.touching(), 0, "seed {seed}: everything is gone");
    assert_eq!(story.starts, story.ends, "seed {seed}");
    (counts.starts, counts.ends) = (story.starts, story.ends);
    counts.starts_of_many = bodies.starts_of_many;
    counts
}

#[test]
fn reported_pairs_are_those_of_the_oracle_whatever_happens_to_colliders() {
    let mut counts = Counts::default();
    for seed in 0..SEEDS {
        counts += live(seed);
    }
    println!("{counts:?}");
    assert!(counts.frames > 1000 && counts.compared_pairs > 20_000, "{counts:?}");
    assert!(counts.touching_pairs > 4_000 && counts.starts > 1_000, "{counts:?}");
    assert!(counts.starts_of_many > 200, "{counts:?}");
    assert!(counts.listed_triangle_pairs > 20_000, "{counts:?}");
}
