//! Colliders with a tolerance. Answers are those of shapes displaced by at most the tolerance, checked by brute force over
//! vertices.

mod changes;
mod motion;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::oracle::intersecting_pairs;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::actors::{Actor, animate, blobs, skinned_blob};
use crate::support::{app, diagnostics, settle};

/// The most frames that a collider may lag behind; in the movements below, none does for longer.
const MEMORY: usize = 60;

/// Colliders whose vertices are remembered frame by frame.
struct Judge {
    actors: Vec<Actor>,
    /// By actor, oldest first; empty while it takes no part in collisions.
    past: Vec<Vec<Vec<DVec3>>>,
    seen: Seen,
}

/// Counts of comparisons, to check that the test covers enough.
#[derive(Debug, Default)]
struct Seen {
    compared: usize,
    touching: usize,
    /// Answers that differ from those of the current shapes.
    other: usize,
    /// The largest distance of a vertex from where collisions may have seen it, relative to the tolerance.
    farthest: f64,
}

fn farthest(before: &[DVec3], now: &[DVec3]) -> f64 {
    let moved = before.iter().zip(now).map(|(a, b)| a.distance(*b));
    moved.fold(0.0, f64::max)
}

impl Judge {
    fn new(actors: Vec<Actor>) -> Self {
        Self {
            past: vec![Vec::new(); actors.len()],
            actors,
            seen: Seen::default(),
        }
    }

    /// Checks the answers of a frame. They must be those of some moments at which no vertex was farther from its current place
    /// than the tolerance.
    fn judge(&mut self, app: &App, context: &str) {
        for (actor, past) in self.actors.iter().zip(&mut self.past) {
            match actor.vertices(app.world()) {
                Some(vertices) => past.push(vertices),
                None => past.clear(),
            }
            past.drain(..past.len().saturating_sub(MEMORY));
        }
        let near: Vec<Vec<&Vec<DVec3>>> = self
            .actors
            .iter()
            .zip(&self.past)
            .map(|(actor, past)| {
                let is_near = |then: &&Vec<DVec3>| {
                    past.last()
                        .is_some_and(|now| farthest(then, now) <= tolerance_of(actor))
                };
                past.iter().rev().filter(is_near).collect()
            })
            .collect();
        let collisions = app.world().resource::<MorphCollisions>();
        for (j, b) in self.actors.iter().enumerate() {
            for (i, a) in self.actors[..j].iter().enumerate() {
                let reported: Vec<(u32, u32)> = collisions.get(a.entity, b.entity).map_or(vec![], |contact| {
                    let pairs = contact
                        .triangles
                        .iter()
                        .map(|pair| match contact.collider1 == a.entity {
                            true => (pair.triangle_a, pair.triangle_b),
                            false => (pair.triangle_b, pair.triangle_a),
                        });
                    let mut pairs: Vec<_> = pairs.collect();
                    pairs.sort_unstable();
                    pairs
                });
                if near[i].is_empty() || near[j].is_empty() {
                    assert!(reported.is_empty(), "{context}: {i} and {j}: one of them is not there");
                    continue;
                }
                let moments = near[i]
                    .iter()
                    .flat_map(|of_a| near[j].iter().map(move |of_b| (*of_a, *of_b)));
                let answer = |(of_a, of_b): (&Vec<DVec3>, &Vec<DVec3>)| {
                    intersecting_pairs(of_a, &a.mesh.triangles, of_b, &b.mesh.triangles) == reported
                };
                let found = moments.clone().find(|&moment| answer(moment));
                let count = moments.count();
                let (of_a, of_b) = found.unwrap_or_else(|| {
                    let reported = reported.len();
                    panic!("{context}: {i} and {j}: none of {count} moments has these {reported} pairs of triangles")
                });
                self.seen.compared += 1;
                self.seen.touching += usize::from(!reported.is_empty());
                for (then, (now, actor)) in [(of_a, (near[i][0], a)), (of_b, (near[j][0], b))] {
                    if tolerance_of(actor) > 0.0 {
                        self.seen.farthest = self.seen.farthest.max(farthest(then, now) / tolerance_of(actor));
                    }
                }
                self.seen.other += usize::from(!answer((near[i][0], near[j][0])));
            }
        }
    }
}

fn tolerance_of(actor: &Actor) -> f64 {
    f64::from(actor.collider.tolerance)
}

fn collider(tolerance: f32) -> MorphCollider {
    MorphCollider::default().with_tolerance(tolerance)
}

#[test]
fn answers_are_exact_for_shapes_displaced_by_no_more_than_their_tolerances() {
    for (seed, tolerances) in [[0.0, 0.02, 0.04, 0.1], [0.05; 4], [0.3; 4]].into_iter().enumerate() {
        let mut app = app();
        let mut rng = Pcg64Mcg::seed_from_u64(seed as u64);
        let actors = blobs(&mut app, 2, &tolerances.map(collider));
        animate(&mut app, &actors, 0, &mut rng);
        settle(&mut app);
        let mut judge = Judge::new(actors);
        judge.judge(&app, &format!("{tolerances:?}, at first"));
        let mut held = 0;
        for frame in 1..150 {
            animate(&mut app, &judge.actors, frame, &mut rng);
            // Some are disabled for a while.
            let gone = judge.actors[frame % 4].entity;
            let mut gone = app.world_mut().entity_mut(gone);
            match rng.random_range(0..12) {
                0 => {
                    gone.insert(MorphColliderDisabled);
                }
                1..5 => {
                    gone.remove::<MorphColliderDisabled>();
                }
                _ => {}
            }
            app.update();
            held += diagnostics(&app).held_colliders;
            judge.judge(&app, &format!("{tolerances:?}, frame {frame}"));
        }
        let seen = judge.seen;
        assert!(seen.compared > 300 && seen.touching > 100, "{tolerances:?}: {seen:?}");
        assert!(seen.other > 30 && held > 100, "{tolerances:?}: {held} held, {seen:?}");
        assert!(seen.farthest > 0.3 && seen.farthest <= 1.0, "{tolerances:?}: {seen:?}");
    }
}

#[test]
fn answers_about_skinned_meshes_are_too() {
    let mut app = app();
    let mut rng = Pcg64Mcg::seed_from_u64(77);
    let mut actors = blobs(&mut app, 2, &[0.05, 0.03].map(collider));
    for (seed, tolerance) in [(5, 0.05), (6, 0.02)] {
        actors.push(skinned_blob(&mut app, (seed, 2), collider(tolerance)));
    }
    animate(&mut app, &actors, 0, &mut rng);
    settle(&mut app);
    let mut judge = Judge::new(actors);
    judge.judge(&app, "at first");
    for frame in 1..150 {
        animate(&mut app, &judge.actors, frame, &mut rng);
        app.update();
        judge.judge(&app, &format!("frame {frame}"));
    }
    let seen = judge.seen;
    assert!(seen.touching > 100 && seen.other > 30, "{seen:?}");
    assert!(seen.farthest > 0.3 && seen.farthest <= 1.0, "{seen:?}");
}
