//! Batches on any number of threads, compared with one query at a time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::scenes::{self, Scene};
use morph_collision::batch::{BatchQuery, PairTask, ThreadWorkers, Wanted, Workers};
use morph_collision::{Body, BuildOptions, PairMemory, PairQuery, Pose, QueryStats, TrianglePair, WorldFromModel};

struct Bodies {
    poses: Vec<Pose>,
    places: Vec<WorldFromModel>,
}

impl Bodies {
    /// Bodies with empty caches: nothing is blended yet.
    fn new(scene: &Scene) -> Self {
        let (poses, places) = scenes::poses(scene, &BuildOptions::default());
        Self { poses, places }
    }

    /// Bodies with full caches: every box and every vertex is blended.
    fn full(scene: &Scene) -> Self {
        let mut bodies = Self::new(scene);
        for pose in &mut bodies.poses {
            pose.visit_nodes(|_| true);
            pose.source_positions(&mut Vec::new());
        }
        bodies
    }

    /// Moves the bodies to their state in another scene.
    fn pose(&mut self, scene: &Scene) {
        for ((_, weights, place), (pose, placed)) in
            scene.bodies.iter().zip(self.poses.iter_mut().zip(&mut self.places))
        {
            pose.set_weights(weights).unwrap();
            *placed = WorldFromModel::new(*place).unwrap();
        }
    }

    fn tasks<'m>(&self, wanted: Wanted) -> Vec<PairTask<'m>> {
        let count = self.poses.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        pairs.map(|(a, b)| PairTask::new(a, b, wanted)).collect()
    }

    fn one_by_one(&mut self, tasks: &[PairTask<'_>]) -> Vec<Vec<TrianglePair>> {
        let mut query = PairQuery::new();
        let answer = |task: &PairTask<'_>| {
            let [a, b] = self.poses.get_disjoint_mut([task.a, task.b]).unwrap();
            let (a, b) = (Body::new(a, &self.places[task.a]), Body::new(b, &self.places[task.b]));
            let mut found = Vec::new();
            match task.wanted {
                Wanted::All => {
                    query.all(a, b, &mut found);
                }
                Wanted::UpTo(limit) => {
                    query.up_to(a, b, limit, &mut found);
                }
                Wanted::First => found.extend(query.first(a, b)),
            }
            found
        };
        tasks.iter().map(answer).collect()
    }

    fn batch(
        &mut self,
        query: &mut BatchQuery,
        tasks: &mut [PairTask<'_>],
        workers: &dyn Workers,
    ) -> Vec<Vec<TrianglePair>> {
        self.batch_counted(query, tasks, workers).0
    }

    fn batch_counted(
        &mut self,
        query: &mut BatchQuery,
        tasks: &mut [PairTask<'_>],
        workers: &dyn Workers,
    ) -> (Vec<Vec<TrianglePair>>, QueryStats) {
        let bodies = self.poses.iter_mut().zip(&self.places);
        let mut bodies: Vec<_> = bodies.map(|(pose, place)| Body::new(pose, place)).collect();
        let answers = query.run(&mut bodies, tasks, workers);
        (answers.iter().map(<[TrianglePair]>::to_vec).collect(), answers.stats())
    }
}

/// Workers that run even the smallest batches.
struct Eager<W>(W);

impl<W: Workers> Workers for Eager<W> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        self.0.run(work);
    }

    fn wake_up(&self) -> Duration {
        Duration::ZERO
    }
}

fn threads(count: usize) -> Eager<ThreadWorkers> {
    Eager(ThreadWorkers::new(count))
}

#[cfg(feature = "rayon")]
fn rayon() -> Option<&'static dyn Workers> {
    Some(&Eager(morph_collision::batch::RayonWorkers))
}

#[cfg(not(feature = "rayon"))]
fn rayon() -> Option<&'static dyn Workers> {
    None
}

/// Counts how often other workers are needed.
struct Counting {
    runs: AtomicUsize,
    wake_up: Duration,
}

impl Workers for Counting {
    fn count(&self) -> usize {
        2
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        self.runs.fetch_add(1, Ordering::Relaxed);
        (0..2).for_each(work);
    }

    fn wake_up(&self) -> Duration {
        self.wake_up
    }
}

/// Makes the calls one after the other, as the trait allows.
struct OneAfterTheOther;

impl Workers for OneAfterTheOther {
    fn count(&self) -> usize {
        3
    }

    fn run(&self, work: &(dyn Fn(usize) + Sync)) {
        (0..3).for_each(work);
    }

    fn wake_up(&self) -> Duration {
        Duration::ZERO
    }
}

#[test]
fn other_workers_are_woken_up_only_for_batches_that_take_longer() {
    let (deep, beside) = (scenes::pass_through(200), scenes::pass_through(1));
    let many = scenes::dolphins(200);
    // How many of three batches run on other workers, each after one for which nothing was known.
    let runs = |scene: &Scene, tasks: &[(usize, usize)], wanted, microseconds| {
        let mut bodies = Bodies::new(scene);
        let mut tasks: Vec<_> = tasks.iter().map(|&(a, b)| PairTask::new(a, b, wanted)).collect();
        let expected = bodies.one_by_one(&tasks);
        let workers = Counting {
            runs: AtomicUsize::new(0),
            wake_up: Duration::from_micros(microseconds),
        };
        let mut query = BatchQuery::new();
        for _ in 0..4 {
            assert_eq!(bodies.batch(&mut query, &mut tasks, &workers), expected);
        }
        workers.runs.into_inner()
    };
    let one = [(0, 1)];
    // Two large bodies: the first batch expects much, and the next ones what the first one counted.
    assert_eq!(runs(&deep, &one, Wanted::All, 0), 4);
    assert_eq!(runs(&deep, &one, Wanted::All, 10), 4);
    assert!(runs(&beside, &one, Wanted::All, 5) <= 1, "they are apart");
    assert_eq!(runs(&deep, &one, Wanted::First, 0), 0, "a single task is not cut");
    // Many pairs, and many pairs with a common body, which cannot run at the same time.
    let all: Vec<_> = (0..12).flat_map(|a| (a + 1..12).map(move |b| (a, b))).collect();
    let star: Vec<_> = (1..12).map(|b| (0, b)).collect();
    for wanted in [Wanted::All, Wanted::First] {
        assert_eq!(runs(&many, &all, wanted, 5), 4);
        assert_eq!(runs(&many, &all, wanted, 1000), 0);
        assert_eq!(runs(&many, &star, wanted, 0), 0);
    }
}

#[test]
fn any_number_of_threads_finds_what_one_query_at_a_time_finds_in_the_same_order() {
    let mut touching = 0;
    // Many bodies, and two large bodies whose pair is cut into parts.
    for scene in [
        scenes::dolphins(200),
        scenes::pass_through(200),
        scenes::pass_through(45),
    ] {
        for wanted in [Wanted::All, Wanted::First] {
            let mut bodies = Bodies::new(&scene);
            let mut tasks = bodies.tasks(wanted);
            let expected = bodies.one_by_one(&tasks);
            touching += expected.iter().map(Vec::len).sum::<usize>();
            let mut query = BatchQuery::new();
            let (two, three, eight) = (threads(2), threads(3), threads(8));
            let one = threads(1);
            let mut all: Vec<&dyn Workers> = vec![&one, &two, &three, &eight, &OneAfterTheOther];
            all.extend(rayon());
            for workers in all {
                for mut bodies in [Bodies::new(&scene), Bodies::full(&scene)] {
                    let found = bodies.batch(&mut query, &mut tasks, workers);
                    assert_eq!(
                        found,
                        expected,
                        "{}, {wanted:?}, {} threads",
                        scene.name,
                        workers.count()
                    );
                    assert_eq!(bodies.batch(&mut query, &mut tasks, workers), expected);
                }
            }
        }
    }
    assert!(touching > 1000, "{touching}");
}

#[test]
fn each_task_tells_its_work() {
    // Whole pairs, and one that is cut into parts, whose cutting is not part of a task.
    for (scene, is_cut) in [(scenes::dolphins(200), false), (scenes::pass_through(200), true)] {
        for workers in [1, 2, 3] {
            let mut bodies = Bodies::new(&scene);
            let mut tasks = bodies.tasks(Wanted::All);
            let mut works = vec![QueryStats::default(); tasks.len()];
            for (task, work) in tasks.iter_mut().zip(&mut works) {
                task.stats = Some(work);
            }
            let (_, all) = bodies.batch_counted(&mut BatchQuery::new(), &mut tasks, &threads(workers));
            let sum = works.iter().fold(QueryStats::default(), |sum, &work| sum + work);
            assert_eq!(sum.triangle_tests, all.triangle_tests, "{workers} threads");
            if is_cut && workers > 1 {
                assert!(2 * sum.node_tests > all.node_tests && sum.node_tests < all.node_tests);
            } else {
                assert_eq!(sum, all, "{workers} threads");
            }
        }
    }
}

#[test]
fn caches_that_are_full_are_read_and_not_filled_again() {
    // So many tasks that no pair is cut into parts; parts would have caches of their own.
    for scene in [scenes::dolphins(200), scenes::dolphins(230)] {
        for wanted in [Wanted::All, Wanted::First] {
            for workers in [1, 2, 3] {
                let (mut fresh, mut full) = (Bodies::new(&scene), Bodies::full(&scene));
                let (mut tasks, mut query) = (fresh.tasks(wanted), BatchQuery::new());
                assert!(tasks.len() > 2 * workers);
                let mut run = |bodies: &mut Bodies| bodies.batch_counted(&mut query, &mut tasks, &threads(workers));
                let (expected, work) = run(&mut fresh);
                assert!(work.nodes_blended > 100, "{work:?}");
                for bodies in [&mut full, &mut fresh] {
                    let (found, again) = run(bodies);
                    assert_eq!(found, expected);
                    assert_eq!(again.nodes_blended, 0, "{wanted:?}, {workers} threads");
                    assert_eq!(again.node_tests, work.node_tests);
                }
            }
        }
    }
}

/// Parts of a large pair use caches of the workers, which stay valid as long as the tree and the weights stay the same.
#[test]
fn parts_of_a_large_pair_keep_what_is_blended_and_follow_new_weights() {
    let scene = scenes::pass_through(200);
    let mut bodies = Bodies::new(&scene);
    let mut tasks = bodies.tasks(Wanted::All);
    let mut query = BatchQuery::new();
    // The first worker does all the work, so the counts are always the same.
    let mut run = |bodies: &mut Bodies| bodies.batch_counted(&mut query, &mut tasks, &OneAfterTheOther);
    let (found, first) = run(&mut bodies);
    let (same, again) = run(&mut bodies);
    let mut fresh = Bodies::new(&scene);
    let [a, b] = fresh.poses.get_disjoint_mut([0, 1]).unwrap();
    let mut alone = PairQuery::new();
    alone.all(
        Body::new(a, &fresh.places[0]),
        Body::new(b, &fresh.places[1]),
        &mut Vec::new(),
    );
    assert_eq!(
        first.vertices_blended,
        alone.stats().vertices_blended,
        "parts share what they place"
    );
    assert!(!found[0].is_empty() && first.nodes_blended > 500, "{first:?}");
    assert_eq!(same, found);
    assert_eq!(again.nodes_blended, 0, "the worker has them all");
    let mut before = found;
    for step in [210, 45, 200] {
        bodies.pose(&scenes::pass_through(step));
        let (found, _) = run(&mut bodies);
        assert_ne!(found, before, "step {step} changes nothing");
        assert_eq!(found, bodies.one_by_one(&bodies.tasks(Wanted::All)), "step {step}");
        before = found;
    }
    // The copies first follow refitted poses, then other refitted poses, then lazy poses again.
    for (step, is_refitted) in [(200, true), (210, true), (200, false), (200, true), (45, false)] {
        bodies.pose(&scenes::pass_through(step));
        if is_refitted {
            bodies.poses.iter_mut().for_each(Pose::refit);
        }
        let (found, _) = run(&mut bodies);
        assert_eq!(
            found,
            bodies.one_by_one(&bodies.tasks(Wanted::All)),
            "step {step}, refitted: {is_refitted}"
        );
    }
}

#[test]
fn tight_volumes_change_no_answer() {
    let mut bodies = Bodies::new(&scenes::pass_through(230));
    let mut tasks = bodies.tasks(Wanted::All);
    let sorted = |found: Vec<Vec<TrianglePair>>| {
        let mut pairs = found.concat();
        pairs.sort_unstable();
        pairs
    };
    let expected = sorted(bodies.one_by_one(&tasks));
    let (loose, _) = work(&mut bodies, &mut tasks);
    for pose in &mut bodies.poses {
        pose.refit();
    }
    let (tight, found) = work(&mut bodies, &mut tasks);
    assert_eq!(sorted(found), expected);
    assert!(tight < loose, "{tight} node tests, {loose} before");
    // Set other weights and then the same ones again: this discards the tight boxes.
    for pose in &mut bodies.poses {
        let weights = pose.weights().to_vec();
        pose.set_weights(&vec![0.0; weights.len()]).unwrap();
        pose.set_weights(&weights).unwrap();
    }
    assert_eq!(work(&mut bodies, &mut tasks).0, loose);
}

fn work(bodies: &mut Bodies, tasks: &mut [PairTask<'_>]) -> (u64, Vec<Vec<TrianglePair>>) {
    let each = bodies.poses.iter_mut().zip(&bodies.places);
    let mut placed: Vec<_> = each.map(|(pose, place)| Body::new(pose, place)).collect();
    let mut query = BatchQuery::new();
    let answers = query.run(&mut placed, tasks, &threads(2));
    (
        answers.stats().node_tests,
        answers.iter().map(<[TrianglePair]>::to_vec).collect(),
    )
}

#[test]
fn tasks_that_make_no_sense_find_nothing_and_the_others_are_done() {
    let mut bodies = Bodies::new(&scenes::pass_through(200));
    let wanted = Wanted::All;
    let mut tasks = [(0, 0), (0, 1), (1, 7), (7, 8)].map(|(a, b)| PairTask::new(a, b, wanted));
    let expected = bodies.one_by_one(&tasks[1..2]);
    for workers in [1, 2, 5] {
        let found = bodies.batch(&mut BatchQuery::new(), &mut tasks, &threads(workers));
        assert_eq!(found[1], expected[0]);
        assert!(found[0].is_empty() && found[2].is_empty() && found[3].is_empty());
    }
    let mut query = BatchQuery::new();
    let answers = query.run(&mut [], &mut tasks, &ThreadWorkers::new(1));
    assert_eq!(answers.iter().count(), 4);
    assert!(answers.get(1).is_empty() && answers.get(99).is_empty());
}

#[test]
fn memories_are_used_and_change_no_answer() {
    let mut memories: Vec<PairMemory> = Vec::new();
    let mut query = BatchQuery::new();
    let (mut touching, mut tests, mut tests_remembering) = (0, 0, 0);
    let mut bodies = Bodies::new(&scenes::dolphins(200));
    for frame in 200..230 {
        bodies.pose(&scenes::dolphins(frame));
        let mut tasks = bodies.tasks(Wanted::First);
        let plain = bodies.one_by_one(&tasks);
        tests += work(&mut bodies, &mut tasks).0;
        memories.resize_with(tasks.len(), PairMemory::new);
        for (task, memory) in tasks.iter_mut().zip(&mut memories) {
            task.memory = Some(memory);
        }
        let each = bodies.poses.iter_mut().zip(&bodies.places);
        let mut placed: Vec<_> = each.map(|(pose, place)| Body::new(pose, place)).collect();
        let answers = query.run(&mut placed, &mut tasks, &threads(3));
        tests_remembering += answers.stats().node_tests;
        for (found, plain) in answers.iter().zip(&plain) {
            assert_eq!(found.is_empty(), plain.is_empty());
            touching += plain.len();
        }
    }
    assert!(touching > 10, "{touching}");
    assert!(tests_remembering < tests, "{tests_remembering} of {tests} node tests");
}
