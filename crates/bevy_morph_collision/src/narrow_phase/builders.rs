//! Builds contacts on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use morph_collision::QueryStats;
use morph_collision::batch::Workers;

use super::comparison::{Comparison, Job, Outcome, Pair};
use super::contact_queries::ContactQueries;
use super::motion::{SHARED_STEPS, STEPS_PER_PAIR, SweptResult};
use super::starts::RunView;
use crate::contacts::MorphContact;
use crate::state::{PairWork, tests};

/// With fewer costly contacts than this, all are built on the calling thread. Waking a thread takes as long as a dozen pairs that do not
/// touch.
const MIN_COSTLY: usize = 16;

/// One [`Builder`] per thread, kept for their memory.
#[derive(Default)]
pub(super) struct Builders {
    builders: Vec<Mutex<Builder>>,
}

#[derive(Default)]
struct Builder {
    queries: ContactQueries,
    stats: QueryStats,
    swept: QueryStats,
    pairs: PairWork,
    outcomes: Vec<(Pair, Outcome)>,
    postponed: Vec<Postponed>,
}

/// A pair that needs more work than each pair may take, to find out how its contact began. `swept` is what was found out so far.
struct Postponed {
    comparison: Comparison,
    contact: Option<MorphContact>,
    swept: SweptResult,
}

/// The work of a run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Work {
    pub(super) stats: QueryStats,
    /// The part of it that was spent on pairs on their way.
    pub(super) swept: QueryStats,
    /// The pairs whose work was cut short.
    pub(super) limited_pairs: u64,
    /// The work of each pair, in any order, if it is counted.
    pub(super) pairs: PairWork,
}

impl Builders {
    /// Builds the contacts of all jobs and appends the outcomes, in any order. Returns the work done.
    ///
    /// Threads take all successive jobs with the same first collider at once, so they rarely wait for each other's poses. The contacts of
    /// one mesh with many others are built one after the other, because each of them uses its pose.
    pub(super) fn run(
        &mut self,
        workers: &impl Workers,
        view: RunView<'_>,
        jobs: &mut [Job],
        outcomes: &mut Vec<(Pair, Outcome)>,
    ) -> Work {
        let costly = jobs.iter().filter(|job| job.is_costly()).count();
        let blocks: Vec<Mutex<&mut [Job]>> = jobs
            .chunk_by_mut(|one, other| one.comparison.indices.0 == other.comparison.indices.0)
            .map(Mutex::new)
            .collect();
        let threads = if costly < MIN_COSTLY || blocks.len() < 2 {
            1
        } else {
            workers.count().max(1)
        };
        self.builders
            .resize_with(threads.max(self.builders.len()), Mutex::default);
        for builder in &mut self.builders {
            // They are empty, unless a run ended with a panic.
            let builder = builder.get_mut().unwrap_or_else(PoisonError::into_inner);
            builder.stats = QueryStats::default();
            builder.swept = QueryStats::default();
            builder.pairs.clear();
            builder.outcomes.clear();
            builder.postponed.clear();
        }
        let (builders, next) = (&self.builders, AtomicUsize::new(0));
        let work = |thread: usize| {
            let mut builder = builders[thread].lock().unwrap_or_else(PoisonError::into_inner);
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                for job in &mut **block.lock().unwrap_or_else(PoisonError::into_inner) {
                    builder.build(view, job);
                }
            }
        };
        if threads == 1 {
            work(0);
        } else {
            workers.run(&work);
        }
        let (mut work, mut postponed) = (Work::default(), Vec::new());
        for builder in &mut self.builders {
            let builder = builder.get_mut().unwrap_or_else(PoisonError::into_inner);
            work.stats += std::mem::take(&mut builder.stats);
            work.swept += std::mem::take(&mut builder.swept);
            work.pairs.append(&mut builder.pairs);
            outcomes.append(&mut builder.outcomes);
            postponed.append(&mut builder.postponed);
        }
        self.decide(view, postponed, outcomes, &mut work);
        work.stats += work.swept;
        work
    }

    /// Looks at postponed pairs again. They share a limit of work, whatever the number of threads.
    fn decide(
        &mut self,
        view: RunView<'_>,
        mut postponed: Vec<Postponed>,
        outcomes: &mut Vec<(Pair, Outcome)>,
        work: &mut Work,
    ) {
        let Some(builder) = self.builders.first_mut() else {
            return;
        };
        let queries = &mut builder.get_mut().unwrap_or_else(PoisonError::into_inner).queries;
        postponed.sort_unstable_by_key(|postponed| postponed.comparison.pair);
        let (mut left, mut pairs) = (SHARED_STEPS, postponed.len() as u64);
        for Postponed {
            comparison,
            contact,
            mut swept,
        } in postponed
        {
            let share = left / pairs;
            pairs -= 1;
            if share > STEPS_PER_PAIR {
                let before = tests(&work.swept);
                swept = queries.swept(view, comparison, share, &mut work.swept);
                if view.counts_pairs {
                    work.pairs.push((comparison.pair, tests(&work.swept) - before));
                }
                left = left.saturating_sub(queries.motion.steps());
            }
            work.limited_pairs += u64::from(matches!(swept, SweptResult::Undecided(_)));
            outcomes.push((comparison.pair, Outcome::new(view, comparison, contact, swept)));
        }
    }
}

impl Outcome {
    fn new(view: RunView<'_>, comparison: Comparison, contact: Option<MorphContact>, swept: SweptResult) -> Self {
        let impact = match swept {
            SweptResult::Apart => None,
            SweptResult::Touching(impact) | SweptResult::Undecided(impact) => Some(impact),
        };
        match (contact, impact) {
            (Some(contact), impact) => Self::Touching(MorphContact { impact, ..contact }),
            (None, Some(impact)) => Self::Passed(MorphContact::passed(comparison, view.pair(comparison), impact)),
            (None, None) => Self::Apart,
        }
    }
}

impl Builder {
    fn build(&mut self, view: RunView<'_>, job: &mut Job) {
        let (comparison, queries) = (job.comparison, &mut self.queries);
        let before = view.counts_pairs.then(|| tests(&self.stats) + tests(&self.swept));
        let contact = queries.contact(view, comparison, &mut job.known, &mut self.stats);
        let swept = if comparison.is_swept {
            queries.swept(view, comparison, STEPS_PER_PAIR, &mut self.swept)
        } else {
            SweptResult::Apart
        };
        if let Some(before) = before {
            let pair_tests = tests(&self.stats) + tests(&self.swept) - before;
            self.pairs.push((comparison.pair, pair_tests));
        }
        if let SweptResult::Undecided(_) = swept {
            self.postponed.push(Postponed {
                comparison,
                contact,
                swept,
            });
        } else {
            let outcome = Outcome::new(view, comparison, contact, swept);
            self.outcomes.push((comparison.pair, outcome));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use bevy::math::{Affine3A, Quat, Vec3};
    use bevy::prelude::Entity;
    use morph_collision::batch::ThreadWorkers;
    use morph_collision::{
        BuildOptions, MorphBvh, MorphModel, PlacedShape, Pose, PoseSnapshot, TrianglePair, WorldFromModel,
    };

    use super::super::comparison::BatchResult;
    use super::super::participant::PlacedCollider;
    use super::super::starts::Starts;
    use super::*;
    use crate::broad_phase::SweptPairs;
    use crate::components::MorphCollisionMode;
    use crate::state::{Form, LockedPose, Placement};

    /// Tetrahedra that overlap their neighbours in a row, and a ball at every second one.
    fn row(length: usize, offset: fn(usize) -> Vec3) -> (Vec<Placement>, Vec<Option<LockedPose>>) {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let model = MorphModel::from_displacements::<[Vec3; 0]>(&corners, &faces, &[]).unwrap();
        let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        let form_at = |i: usize| {
            let x = 0.3 * i as f32;
            if i % 3 == 2 {
                return Form::Shape(PlacedShape::ball(Vec3::new(x, 0.1, 0.2).as_dvec3(), 0.4).unwrap());
            }
            let turned = Quat::from_rotation_z(0.7 * i as f32);
            let place = Affine3A::from_rotation_translation(turned, Vec3::X * x + offset(i));
            Form::Mesh(WorldFromModel::new(place).unwrap())
        };
        let mut entities: Vec<Entity> = (0..length as u32).filter_map(Entity::from_raw_u32).collect();
        entities.sort_unstable();
        let placement = |i: usize| Placement {
            form: form_at(i),
            body: entities[i],
            mode: MorphCollisionMode::Contacts,
            layers: crate::components::MorphCollisionLayers::default(),
            margin: 0.2,
            continuous: false,
            bounds: morph_collision::Aabb {
                min: Vec3::NEG_INFINITY,
                max: Vec3::INFINITY,
            },
        };
        let placements: Vec<Placement> = (0..length).map(placement).collect();
        let pose = |placement: &Placement| match placement.form {
            Form::Mesh(_) => Some(LockedPose::new(Pose::new(bvh.clone()))),
            Form::Shape(_) => None,
        };
        let poses = placements.iter().map(pose).collect();
        (placements, poses)
    }

    fn contacts(workers: &impl Workers) -> (Vec<(Pair, Outcome)>, QueryStats) {
        let (placements, mut poses) = row(30, |_| Vec3::ZERO);
        let mut before = vec![PoseSnapshot::default(); placements.len()];
        for (before, pose) in before.iter_mut().zip(&mut poses) {
            if let Some(pose) = pose {
                before.take(pose.get_mut());
            }
        }
        let placed: Vec<PlacedCollider> = placements
            .iter()
            .zip(poses.iter_mut().zip(&before))
            .map(|(placement, (pose, before))| PlacedCollider {
                entity: placement.body,
                changed: true,
                placement,
                pose: pose.as_mut(),
                before,
            })
            .collect();
        let mut jobs = Vec::new();
        for (a, b) in (0..30).flat_map(|a| (a + 1..30.min(a + 9)).map(move |b| (a, b))) {
            let has_shape = [a, b].iter().any(|&i| placed[i].pose.is_none());
            let meets = |x, y| {
                let triangle = |i: usize, number| placed[i].mesh().unwrap().body().triangle(number).unwrap();
                morph_collision::triangles_intersect(&triangle(a, x), &triangle(b, y))
            };
            let all = (0..4).flat_map(|x| (0..4).map(move |y| (x, y)));
            let known = if has_shape {
                BatchResult::NotAsked
            } else {
                BatchResult::Triangles {
                    triangles: all
                        .filter(|&(x, y)| meets(x, y))
                        .map(|(triangle_a, triangle_b)| TrianglePair { triangle_a, triangle_b })
                        .collect(),
                    is_truncated: false,
                }
            };
            if [a, b].iter().all(|&i| placed[i].pose.is_none()) {
                continue;
            }
            let comparison = Comparison {
                pair: (placed[a].entity, placed[b].entity),
                indices: (a, b),
                mode: MorphCollisionMode::Contacts,
                is_swept: !has_shape,
            };
            jobs.push(Job { comparison, known });
        }
        assert!(jobs.len() > 4 * MIN_COSTLY);
        let mut outcomes = Vec::new();
        // Some come from above, over and through their neighbours.
        let mut swept = SweptPairs::default();
        let was = |i: usize| {
            let x = if i % 5 == 1 { -3.0 } else { 0.0 };
            Vec3::new(x, 0.0, if i.is_multiple_of(2) { 2.0 } else { 0.0 })
        };
        let (was, _) = row(30, was);
        let was: Vec<_> = was
            .iter()
            .map(|placement| (placement.body, placement.clone()))
            .collect();
        swept.remember(&was);
        let mut starts = Starts::default();
        starts.prepare(&jobs, &placed, &swept);
        let view = RunView {
            colliders: &placed,
            starts: &starts,
            seconds: 0.0,
            limit: usize::MAX,
            counts_pairs: true,
        };
        let work = Builders::default().run(workers, view, &mut jobs, &mut outcomes);
        outcomes.sort_by_key(|(pair, _)| *pair);
        assert_eq!(outcomes.len(), jobs.len());
        (outcomes, work.stats)
    }

    #[test]
    fn contacts_do_not_depend_on_the_number_of_threads() {
        let (alone, stats) = contacts(&ThreadWorkers::new(1));
        let touching: Vec<_> = alone
            .iter()
            .filter_map(|(_, outcome)| match outcome {
                Outcome::Touching(contact) => Some(contact),
                _ => None,
            })
            .collect();
        assert!(touching.len() > 40 && touching.iter().any(|contact| !contact.points.is_empty()));
        assert!(touching.iter().any(|contact| contact.impact.is_some()));
        let passed = |(_, outcome): &&(Pair, Outcome)| matches!(outcome, Outcome::Passed(_));
        assert!(alone.iter().filter(passed).count() > 2);
        for threads in [2, 4, 8] {
            let (together, stats_together) = contacts(&ThreadWorkers::new(threads));
            assert_eq!(together, alone, "{threads} threads");
            assert_eq!(stats_together.triangle_tests, stats.triangle_tests);
        }
    }
}
