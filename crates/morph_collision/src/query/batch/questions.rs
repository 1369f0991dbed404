//! Many questions of one kind: their order, and their way to workers and back.

use std::mem;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::lock::locked;
use super::workers::Workers;

/// Sorts questions so that those close to each other are asked one after the other, and spreads them over workers.
///
/// [`RayQuery`](crate::RayQuery) and [`ShapeQuery`](crate::ShapeQuery) use it for many questions about one body
/// ([`RayQuery::closest_batch`](crate::RayQuery::closest_batch) and others). Use it yourself for your own kind of questions, for example
/// about many bodies at once. Keep it and use it again: it reuses its memory.
///
/// Answers come back in the order of the questions. Each question must have one answer, whoever is asked and whatever was asked before.
///
/// ```
/// use glam::DVec3;
/// use morph_collision::batch::{QuestionBatch, ThreadWorkers};
///
/// // The squares of numbers, as if they were far apart in space.
/// let numbers = [5.0, -3.0, 4.0, -2.0];
/// let mut batch = QuestionBatch::new();
/// batch.sort_points(numbers.iter().map(|&x| DVec3::new(x, 0.0, 0.0)));
/// assert_eq!(batch.order(), [1, 3, 2, 0]);
///
/// let mut squares = vec![0.0; 4];
/// batch.answer(2, &ThreadWorkers::new(2), &mut squares, |_worker, chunks, found| {
///     for &question in chunks.flatten() {
///         found.push((question, numbers[question as usize].powi(2)));
///     }
/// });
/// assert_eq!(squares, [25.0, 9.0, 16.0, 4.0]);
/// ```
#[derive(Debug, Default)]
pub struct QuestionBatch {
    order: Vec<u32>,
    keys: Vec<(u64, u32)>,
}

/// The number of questions that a worker takes at once.
const CHUNK: usize = 64;

impl QuestionBatch {
    /// Creates an empty batch. It allocates on first use.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes questions at some points and sorts them along a space-filling (Morton) curve. Questions at the same point keep their order.
    ///
    /// Points that are not finite do no harm. There may be at most `u32::MAX` questions.
    pub fn sort_points(&mut self, points: impl Iterator<Item = DVec3> + Clone) {
        let grid = Grid::around(points.clone());
        self.sort(points.map(|point| grid.key(point)));
    }

    /// Takes questions about rays, each an origin and a direction, and sorts them along a Morton curve through the space of both. Origins
    /// and directions count alike. Otherwise like [`QuestionBatch::sort_points`].
    pub fn sort_rays(&mut self, rays: impl Iterator<Item = [DVec3; 2]> + Clone) {
        let [origins, directions] = [0, 1].map(|vector| Grid::around(rays.clone().map(|ray| ray[vector])));
        self.sort(rays.map(|[origin, direction]| {
            // 30 bits each, alternating.
            spread_by_two(origins.key(origin)) | spread_by_two(directions.key(direction)) << 1
        }));
    }

    fn sort(&mut self, keys: impl Iterator<Item = u64>) {
        self.keys.clear();
        self.keys.extend(keys.zip(0..));
        self.keys.sort_unstable();
        self.order.clear();
        self.order.extend(self.keys.iter().map(|(_, question)| *question));
    }

    /// The questions in the order in which to ask them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Removes `count` questions from the order, evenly spread over it, and returns them. With fewer questions, removes all.
    ///
    /// Ask them first, to see how much work the others are.
    pub fn take_sample(&mut self, count: usize) -> Vec<u32> {
        let stride = (self.order.len() / count.max(1)).max(1);
        let all = mem::take(&mut self.order);
        let is_sample = |index: usize| count > 0 && index.is_multiple_of(stride) && index / stride < count;
        let sample = all.iter().enumerate().filter(|(index, _)| is_sample(*index));
        let sample = sample.map(|(_, question)| *question).collect();
        self.order = all;
        let mut index = 0;
        self.order.retain(|_| {
            index += 1;
            !is_sample(index - 1)
        });
        sample
    }

    /// Answers the questions on the first `parts` workers. Replaces those elements of `answers` that have these questions' indices.
    ///
    /// Calls `work` with the worker's index, an iterator over chunks of questions, and a list for the worker's answers, each with its
    /// question. Each worker begins with its own part of the order, and helps others when it has finished. If `parts` is 1, everything
    /// happens on the calling thread.
    ///
    /// # Panics
    /// If an answer's question is out of range of `answers`.
    pub fn answer<A: Send>(
        &self,
        parts: usize,
        workers: &dyn Workers,
        answers: &mut [A],
        work: impl Fn(usize, QuestionChunks<'_>, &mut Vec<(u32, A)>) + Sync,
    ) {
        let (parts, all) = (parts.max(1), &self.order);
        let taken: Vec<_> = (0..parts)
            .map(|part| AtomicUsize::new(part * all.len() / parts))
            .collect();
        let found: Vec<_> = (0..parts).map(|_| Mutex::new(Vec::new())).collect();
        let work = |worker: usize| {
            if let Some(found) = found.get(worker) {
                let chunks = QuestionChunks {
                    questions: all,
                    taken: &taken,
                    first: worker,
                    finished: 0,
                };
                work(worker, chunks, &mut locked(found));
            }
        };
        if parts == 1 {
            work(0);
        } else {
            workers.run(&work);
        }
        for found in &found {
            for (question, answer) in locked(found).drain(..) {
                answers[question as usize] = answer;
            }
        }
    }
}

/// The questions that one worker of a [`QuestionBatch`] is given, a chunk at a time.
#[derive(Debug)]
pub struct QuestionChunks<'a> {
    questions: &'a [u32],
    /// For each part, where its remaining questions start.
    taken: &'a [AtomicUsize],
    /// The worker's own part.
    first: usize,
    /// The number of parts in which nothing is left.
    finished: usize,
}

impl<'a> Iterator for QuestionChunks<'a> {
    type Item = &'a [u32];

    fn next(&mut self) -> Option<&'a [u32]> {
        let parts = self.taken.len();
        while self.finished < parts {
            let part = (self.first + self.finished) % parts;
            let end = (part + 1) * self.questions.len() / parts;
            let start = self.taken[part].fetch_add(CHUNK, Ordering::Relaxed);
            if start < end {
                return Some(&self.questions[start..(start + CHUNK).min(end)]);
            }
            self.finished += 1;
        }
        None
    }
}

/// A grid of 1024^3 cubes around some vectors.
struct Grid {
    min: DVec3,
    per_unit: f64,
}

/// The last cell along an axis.
const LAST: f64 = 1023.0;

impl Grid {
    fn around(vectors: impl Iterator<Item = DVec3>) -> Self {
        let finite = vectors.filter(|vector| vector.is_finite());
        let (min, max) = finite.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), vector| {
            (min.min(vector), max.max(vector))
        });
        Self {
            min,
            // Not finite if there is no extent; all vectors are then in the first or the last cell.
            per_unit: LAST / (max - min).max_element(),
        }
    }

    /// A vector's place on the Morton curve through the grid, 30 bits.
    fn key(&self, vector: DVec3) -> u64 {
        // A NaN becomes the last cell.
        let [x, y, z] = ((vector - self.min) * self.per_unit).min(DVec3::splat(LAST)).to_array();
        spread_by_three(x as u64) | spread_by_three(y as u64) << 1 | spread_by_three(z as u64) << 2
    }
}

/// Moves bit `i` of a number below 2^10 to bit `3 i`.
fn spread_by_three(number: u64) -> u64 {
    let number = (number | number << 16) & 0x0300_00ff;
    let number = (number | number << 8) & 0x0300_f00f;
    let number = (number | number << 4) & 0x030c_30c3;
    (number | number << 2) & 0x0924_9249
}

/// Moves bit `i` of a number below 2^32 to bit `2 i`.
fn spread_by_two(number: u64) -> u64 {
    let number = (number | number << 16) & 0x0000_ffff_0000_ffff;
    let number = (number | number << 8) & 0x00ff_00ff_00ff_00ff;
    let number = (number | number << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    let number = (number | number << 2) & 0x3333_3333_3333_3333;
    (number | number << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::batch::ThreadWorkers;

    /// Some points in a cube, and some that are not finite.
    fn points() -> Vec<DVec3> {
        let share = |n: u32, stride: f64| (f64::from(n) * stride).fract();
        let inside = |n| DVec3::new(share(n, 0.618_034), share(n, 0.754_878), share(n, 0.569_840));
        let mut points: Vec<_> = (0..1000).map(inside).collect();
        points.extend([DVec3::NAN, DVec3::INFINITY, DVec3::NEG_INFINITY]);
        points
    }

    #[test]
    fn neighbours_in_the_order_are_neighbours_in_space() {
        let points = points();
        let mut batch = QuestionBatch::new();
        batch.sort_points(points.iter().copied());
        let order = batch.order().to_vec();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..points.len() as u32));
        let length = |order: &mut dyn Iterator<Item = DVec3>| {
            let finite: Vec<_> = order.filter(|point| point.is_finite()).collect();
            finite.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>()
        };
        let sorted = length(&mut order.iter().map(|&index| points[index as usize]));
        assert!(sorted < 0.3 * length(&mut points.iter().copied()), "{sorted}");
    }

    #[test]
    fn origins_and_directions_count() {
        // Two origins, and two directions that alternate.
        let places = (0..8).map(|n| {
            [
                DVec3::X * f64::from(n / 4),
                if n % 2 == 0 { DVec3::Z } else { DVec3::NEG_Z },
            ]
        });
        let mut batch = QuestionBatch::new();
        batch.sort_rays(places);
        assert_eq!(batch.order(), [1, 3, 5, 7, 0, 2, 4, 6]);
    }

    #[test]
    fn bits_are_spread() {
        for bit in 0..32 {
            assert_eq!(spread_by_two(1 << bit), 1 << (2 * bit));
            assert!(bit >= 10 || spread_by_three(1 << bit) == 1 << (3 * bit), "{bit}");
        }
        assert_eq!(spread_by_three(0x3ff), 0x0924_9249);
        assert_eq!(spread_by_two(0xffff_ffff), 0x5555_5555_5555_5555);
    }

    #[test]
    fn a_sample_is_spread_and_taken_out() {
        let mut batch = QuestionBatch::new();
        batch.sort_points((0..10).map(|n| DVec3::splat(f64::from(n))));
        assert_eq!(batch.take_sample(3), [0, 3, 6]);
        assert_eq!(batch.order(), [1, 2, 4, 5, 7, 8, 9]);
        assert!(batch.take_sample(0).is_empty());
        assert_eq!(batch.take_sample(100), [1, 2, 4, 5, 7, 8, 9]);
        assert!(batch.order().is_empty());
    }

    #[test]
    fn every_question_is_answered_once_by_any_number_of_workers() {
        struct OnlyFirst;
        impl Workers for OnlyFirst {
            fn count(&self) -> usize {
                3
            }

            fn run(&self, work: &(dyn Fn(usize) + Sync)) {
                // One after the other: the first one does everything.
                (0..3).for_each(work);
            }
        }
        let mut batch = QuestionBatch::new();
        for count in [0_u32, 1, 63, 64, 65, 1000] {
            batch.sort_points((0..count).map(|n| DVec3::X * f64::from(n % 7)));
            for parts in [0, 1, 2, 3, 8] {
                let threads = ThreadWorkers::new(parts);
                for workers in [&threads as &dyn Workers, &OnlyFirst] {
                    let mut answers = vec![0; count as usize];
                    batch.answer(parts.min(workers.count()), workers, &mut answers, |_, chunks, found| {
                        for chunk in chunks {
                            assert!(!chunk.is_empty() && chunk.len() <= CHUNK);
                            found.extend(chunk.iter().map(|&question| (question, question + 1)));
                        }
                    });
                    assert!(answers.into_iter().eq(1..=count), "{count} {parts}");
                }
            }
        }
    }
}
