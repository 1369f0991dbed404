//! Random motion, compared with brute force over all vertices, faces and edges.

use bevy::ecs::message::MessageCursor;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::morph_collision::motion::{MovingPoint, TimeOfImpact, edge_edge_impact, vertex_face_impact};
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::oracle::intersecting_pairs;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::actors::{Actor, blobs, scatter, skinned_blob};
use crate::support::{Edits, app, settle, touches};

/// A mesh on its way.
struct Way<'a> {
    triangles: &'a [[u32; 3]],
    ends: [&'a [DVec3]; 2],
}

impl Way<'_> {
    fn point(&self, vertex: u32) -> MovingPoint {
        let [start, end] = self.ends.map(|vertices| vertices[vertex as usize]);
        MovingPoint { start, end }
    }

    fn edges(&self) -> Vec<[u32; 2]> {
        let of = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]);
        let mut edges: Vec<_> = self.triangles.iter().flat_map(of).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

/// The box around points during the motion.
fn swept<const N: usize>(points: &[MovingPoint; N]) -> (DVec3, DVec3) {
    let ends = points.iter().flat_map(|point| [point.start, point.end]);
    ends.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| {
        (min.min(p), max.max(p))
    })
}

fn boxes_are_apart((min, max): (DVec3, DVec3), (low, high): (DVec3, DVec3)) -> bool {
    min.cmpgt(high).any() || low.cmpgt(max).any()
}

fn apart<const N: usize, const M: usize>(a: &[MovingPoint; N], b: &[MovingPoint; M]) -> bool {
    boxes_are_apart(swept(a), swept(b))
}

/// The box around all points of a mesh on its way.
fn hull(ends: &[Vec<DVec3>; 2]) -> (DVec3, DVec3) {
    let all = ends.iter().flatten();
    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &p| {
        (min.min(p), max.max(p))
    })
}

/// When two meshes first touch on their way: over all pairs of features, as precisely as `f64` can tell.
pub(super) fn first_touch(
    a: &[Vec<DVec3>; 2],
    of_a: &[[u32; 3]],
    b: &[Vec<DVec3>; 2],
    of_b: &[[u32; 3]],
) -> Option<TimeOfImpact> {
    if boxes_are_apart(hull(a), hull(b)) {
        return None;
    }
    let a = Way {
        triangles: of_a,
        ends: a.each_ref().map(Vec::as_slice),
    };
    let b = Way {
        triangles: of_b,
        ends: b.each_ref().map(Vec::as_slice),
    };
    let mut times = Vec::new();
    for (vertices, faces) in [(&a, &b), (&b, &a)] {
        let mut used: Vec<u32> = vertices.triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        for face in faces
            .triangles
            .iter()
            .map(|face| face.map(|corner| faces.point(corner)))
        {
            for vertex in used.iter().map(|&vertex| vertices.point(vertex)) {
                if !apart(&[vertex], &face) {
                    times.extend(vertex_face_impact(vertex, face, 0.0));
                }
            }
        }
    }
    let edges_b: Vec<_> = b.edges().into_iter().map(|edge| edge.map(|end| b.point(end))).collect();
    for edge_a in a.edges().into_iter().map(|edge| edge.map(|end| a.point(end))) {
        for edge_b in &edges_b {
            if !apart(&edge_a, edge_b) {
                times.extend(edge_edge_impact(edge_a, *edge_b, 0.0));
            }
        }
    }
    times.into_iter().min_by(|x, y| x.latest.total_cmp(&y.latest))
}

/// Counts of what happened, to check that the test covers enough.
#[derive(Debug, Default)]
struct Seen {
    starts: usize,
    impacts: usize,
    passes: usize,
    ends: usize,
}

/// Moves actors for some frames, at a low frame rate, and judges every event.
fn judge(app: &mut App, actors: &[Actor], frames: usize, seed: u64) -> Seen {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut cursors = (MessageCursor::default(), MessageCursor::default());
    let mut seen = Seen::default();
    // `None` for an actor that took no part.
    let mut before: Vec<Option<Vec<DVec3>>> = vec![None; actors.len()];
    let mut touched: Vec<Vec<bool>> = actors
        .iter()
        .map(|b| actors.iter().map(|a| touches(app, a.entity, b.entity)).collect())
        .collect();
    cursors
        .0
        .read(app.world().resource::<Messages<MorphCollisionStart>>())
        .count();
    cursors
        .1
        .read(app.world().resource::<Messages<MorphCollisionEnd>>())
        .count();
    let mut was_paused = true;
    for frame in 0..frames {
        scatter(app, actors, &mut rng);
        let teleported = rng.random_range(0..3 * actors.len());
        if let Some(actor) = actors.get(teleported) {
            app.insert(actor.entity, MorphTeleported);
        }
        let chosen = &actors[frame % actors.len()];
        match rng.random_range(0..12) {
            0 => {
                app.insert(chosen.entity, MorphColliderDisabled);
            }
            1..5 => {
                app.remove::<MorphColliderDisabled>(chosen.entity);
            }
            _ => {}
        }
        let paused = rng.random_bool(0.04);
        app.settings().paused = paused;
        app.update();
        let starts: Vec<MorphCollisionStart> = cursors.0.read(app.world().resource()).copied().collect();
        let ends: Vec<MorphCollisionEnd> = cursors.1.read(app.world().resource()).copied().collect();
        if paused {
            assert!(starts.is_empty() && ends.is_empty());
            was_paused = true;
            continue;
        }
        let now: Vec<_> = actors.iter().map(|actor| actor.vertices(app.world())).collect();
        for (j, b) in actors.iter().enumerate() {
            for (i, a) in actors[..j].iter().enumerate() {
                let context = format!("seed {seed}, frame {frame}, {i} and {j}");
                let is_one = |one: Entity, other: Entity| {
                    [one, other] == [a.entity, b.entity] || [other, one] == [a.entity, b.entity]
                };
                let mut starts = starts.iter().filter(|start| is_one(start.collider1, start.collider2));
                let ends = ends.iter().filter(|end| is_one(end.collider1, end.collider2)).count();
                let was = touched[j][i];
                let is = match (&now[i], &now[j]) {
                    (Some(of_a), Some(of_b)) => {
                        !intersecting_pairs(of_a, &a.mesh.triangles, of_b, &b.mesh.triangles).is_empty()
                    }
                    _ => false,
                };
                touched[j][i] = is;
                let stayed = ![i, j].contains(&teleported) && !was_paused;
                let is_swept = (a.collider.continuous || b.collider.continuous) && !was && stayed;
                let ways = |k: usize| Some([before[k].clone()?, now[k].clone()?]);
                let hit = match (ways(i), ways(j)) {
                    (Some(of_a), Some(of_b)) if is_swept => {
                        first_touch(&of_a, &a.mesh.triangles, &of_b, &b.mesh.triangles)
                    }
                    _ => None,
                };
                let start = starts.next();
                assert!(starts.next().is_none(), "{context}: two starts");
                assert_eq!(start.is_some(), !was && (is || hit.is_some()), "{context}: {hit:?}");
                let passes = !was && !is && hit.is_some();
                assert_eq!(ends, usize::from(was && !is || passes), "{context}: {hit:?}");
                let impact = start.and_then(|start| start.impact);
                assert_eq!(impact.is_some(), hit.is_some(), "{context}: {hit:?}");
                if let (Some(impact), Some(hit)) = (impact, hit) {
                    assert!(
                        impact.earliest <= hit.latest && hit.earliest <= impact.latest,
                        "{context}: {hit:?}, but {impact:?}"
                    );
                    assert!(impact.latest - impact.earliest <= 1e-6, "{context}: {impact:?}");
                }
                seen.starts += usize::from(start.is_some());
                seen.ends += ends;
                seen.impacts += usize::from(impact.is_some());
                seen.passes += usize::from(passes);
            }
        }
        (before, was_paused) = (now, false);
    }
    seen
}

fn continuous(is: bool) -> MorphCollider {
    MorphCollider::default().with_continuous(is)
}

#[test]
fn every_contact_on_the_way_is_reported_and_no_other() {
    for seed in 0..2 {
        let mut app = app();
        let actors = blobs(&mut app, 1, &[true, false, false, false].map(continuous));
        settle(&mut app);
        let seen = judge(&mut app, &actors, 80, seed);
        assert!(seen.starts > 30 && seen.impacts > 20 && seen.passes > 10, "{seen:?}");
        assert!(
            seen.starts > seen.impacts + 5,
            "some are not compared on their way: {seen:?}"
        );
    }
}

#[test]
fn those_of_skinned_meshes_are_too() {
    let mut app = app();
    let mut actors = blobs(&mut app, 1, &[true, false].map(continuous));
    for (seed, is) in [(5, true), (6, false)] {
        actors.push(skinned_blob(&mut app, (seed, 1), continuous(is)));
    }
    settle(&mut app);
    let seen = judge(&mut app, &actors, 80, 7);
    assert!(seen.starts > 30 && seen.impacts > 20 && seen.passes > 10, "{seen:?}");
}
