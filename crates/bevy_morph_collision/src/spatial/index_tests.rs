//! Tests of the tree over all colliders.

use super::super::rays::BoxEntry;
use super::*;

type Colliders = Vec<(Entity, Aabb)>;

fn entity(i: u32) -> Entity {
    Entity::from_raw_u32(i).unwrap()
}

fn noise(i: u32, k: u32) -> f32 {
    let bits = (i.wrapping_mul(2_654_435_761) ^ k.wrapping_mul(974_634_641)).wrapping_mul(2_246_822_519);
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Boxes of size 1 at constant density, however many there are.
fn scattered(count: u32, shift: f32) -> Colliders {
    let side = (count as f32).cbrt() * 4.0;
    let at = |i: u32| Vec3::new(noise(i, 1), noise(i, 2), noise(i, 3)) * side;
    let one = |i: u32| {
        let min = at(i) + shift * (Vec3::new(noise(i, 4), noise(i, 5), noise(i, 6)) - 0.5);
        let max = min + 1.0;
        (entity(i), Aabb { min, max })
    };
    (0..count).map(one).collect()
}

/// What a walk finds near a point, and how many boxes it visited.
fn near(index: &ColliderIndex, point: Vec3, within: f32) -> (Vec<usize>, usize) {
    let (mut found, mut boxes) = (Vec::new(), 0);
    let away = |bounds: &Aabb| (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO).length();
    index.walk(
        &mut Queue::new(),
        within,
        |bounds| {
            boxes += 1;
            Some(away(bounds))
        },
        |index| {
            found.push(index);
            within
        },
    );
    found.sort_unstable();
    (found, boxes)
}

fn expected(colliders: &Colliders, point: Vec3, within: f32) -> Vec<usize> {
    let away = |bounds: &Aabb| (bounds.min - point).max(point - bounds.max).max(Vec3::ZERO).length();
    let near = colliders
        .iter()
        .enumerate()
        .filter(|(_, (_, bounds))| away(bounds) <= within);
    near.map(|(index, _)| index).collect()
}

#[test]
fn finds_what_a_look_at_all_boxes_finds_while_colliders_move_come_and_go() {
    let mut index = ColliderIndex::default();
    for frame in 0..60_u32 {
        let mut colliders = scattered(300, frame as f32 * 0.4);
        // Some are missing, others may be infinite.
        colliders
            .retain(|(entity, _)| !(entity.index_u32() + frame).is_multiple_of(7) && entity.index_u32() > 3 * frame);
        if frame % 3 == 1 {
            colliders[20].1 = Aabb {
                min: Vec3::NEG_INFINITY,
                max: Vec3::INFINITY,
            };
        }
        index.update(colliders.iter().copied());
        for i in 0..20 {
            let point = Vec3::new(noise(i, 7), noise(i, 8), noise(i, 9)) * 27.0;
            for within in [0.0, 2.0, 9.0, f32::INFINITY] {
                assert_eq!(
                    near(&index, point, within).0,
                    expected(&colliders, point, within),
                    "frame {frame}"
                );
            }
        }
    }
    index.update(Vec::new().into_iter());
    assert_eq!(near(&index, Vec3::ZERO, f32::INFINITY).0, [0_usize; 0]);
}

#[test]
fn the_nearest_come_first_and_a_lower_limit_ends_the_walk() {
    let mut index = ColliderIndex::default();
    let colliders = scattered(500, 0.0);
    index.update(colliders.iter().copied());
    let away = |bounds: &Aabb| (bounds.min - 9.0).max(9.0 - bounds.max).max(Vec3::ZERO).length();
    let mut visited = Vec::new();
    index.walk(
        &mut Queue::new(),
        f32::INFINITY,
        |bounds| Some(away(bounds)),
        |index| {
            visited.push(away(&colliders[index].1));
            if visited.len() < 10 { f32::INFINITY } else { visited[9] }
        },
    );
    assert!(
        visited.is_sorted() && visited.len() >= 10 && visited.len() < 20,
        "{visited:?}"
    );
}

#[test]
fn boxes_looked_at_grow_slower_than_colliders() {
    let (mut points, mut rays) = (Vec::new(), Vec::new());
    for count in [100, 1_000, 10_000] {
        let mut index = ColliderIndex::default();
        let colliders = scattered(count, 0.0);
        index.update(colliders.iter().copied());
        let side = (count as f32).cbrt() * 4.0;
        let point = |i: u32| Vec3::new(noise(i, 7), noise(i, 8), noise(i, 9)) * side;
        points.push((0..200).map(|i| near(&index, point(i), 1.0).1).sum::<usize>() / 200);
        // As if every box were full.
        let mut looks = 0;
        for i in 0..200 {
            let direction = Dir3::new(point(i + 200) - point(i)).unwrap();
            let ray = BoxEntry::new(point(i), direction, f32::INFINITY);
            let entry = |bounds: &Aabb| ray.distance(bounds);
            index.walk(
                &mut Queue::new(),
                f32::INFINITY,
                |bounds| {
                    looks += 1;
                    entry(bounds)
                },
                |index| entry(&colliders[index].1).unwrap(),
            );
        }
        rays.push(looks / 200);
    }
    println!("boxes looked at among 100, 1,000 and 10,000: {points:?} near a point, {rays:?} along a ray");
    for counts in [points, rays] {
        assert!(
            counts[1] < 4 * counts[0] && counts[2] < 2 * counts[1] && counts[2] < 300,
            "{counts:?}"
        );
    }
}

#[test]
fn rays_enter_boxes_that_they_only_touch() {
    let unit = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    for (origin, direction, expected) in [
        // Along a face, along an edge, and past them.
        (Vec3::new(-2.0, 1.0, 0.5), Dir3::X, Some(2.0)),
        (Vec3::new(-2.0, 1.0, 0.0), Dir3::X, Some(2.0)),
        (Vec3::new(-2.0, 1.01, 0.5), Dir3::X, None),
        (Vec3::new(3.0, 0.0, 0.0), Dir3::NEG_X, Some(2.0)),
        (Vec3::new(3.0, 0.5, -0.01), Dir3::NEG_X, None),
        // From within, and away from it.
        (Vec3::splat(0.5), Dir3::NEG_Y, Some(0.0)),
        (Vec3::new(-2.0, 0.5, 0.5), Dir3::NEG_X, None),
    ] {
        for max_distance in [10.0, f32::INFINITY] {
            let entered = BoxEntry::new(origin, direction, max_distance).distance(&unit);
            let is_right = match (entered, expected) {
                (Some(entered), Some(expected)) => (expected - 1e-4..=expected).contains(&entered),
                (entered, expected) => entered == expected,
            };
            assert!(is_right, "{origin} {direction:?}: {entered:?}, {expected:?}");
        }
        assert_eq!(
            BoxEntry::new(origin, direction, 1.0).distance(&unit).is_some(),
            expected == Some(0.0)
        );
    }
}

#[test]
fn many_that_are_equal_are_no_trouble() {
    let mut index = ColliderIndex::default();
    let bounds = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ZERO,
    };
    let all: Colliders = (0..3_000).map(|i| (entity(i), bounds)).collect();
    for _ in 0..3 {
        index.update(all.iter().copied());
        assert_eq!(near(&index, Vec3::ZERO, 0.0).0.len(), 3_000);
    }
}

#[test]
fn colliders_that_come_after_the_first_question_are_in_the_tree() {
    let (mut index, mut all) = (ColliderIndex::default(), scattered(100, 0.0));
    index.update(all.iter().copied());
    // Ten in each run.
    for one in scattered(2_000, 0.0).into_iter().skip(100) {
        all.push(one);
        if all.len().is_multiple_of(10) {
            index.update(all.iter().copied());
        }
    }
    let boxes = |index: &ColliderIndex| (0..200).map(|i| near(index, all[i * 10].1.min, 1.0).1).sum::<usize>() / 200;
    let grown = boxes(&index);
    assert!(grown < 150, "{grown} boxes");
    // Move them from far apart into a heap.
    let mut fresh = ColliderIndex::default();
    for (i, (_, bounds)) in (0..).zip(&mut all) {
        let min = Vec3::new(noise(i, 11), noise(i, 12), noise(i, 13)) * 20.0;
        *bounds = Aabb { min, max: min + 0.5 };
    }
    index.update(all.iter().copied());
    fresh.update(all.iter().copied());
    let boxes = |index: &ColliderIndex| (0..200).map(|i| near(index, all[i * 10].1.min, 0.1).1).sum::<usize>() / 200;
    assert!(
        boxes(&index) <= boxes(&fresh) + 60,
        "{} {}",
        boxes(&index),
        boxes(&fresh)
    );
}
