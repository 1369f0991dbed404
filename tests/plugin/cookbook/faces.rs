//! The face whose zones have names. Every shot is checked by brute force over the file's triangles.

use std::collections::{BTreeMap, HashSet};

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::posed_vertices;

use super::programs::face_zones::{Shot, game};
use super::{head, play_until, program, weights};

/// For each triangle, the smallest vertex in its connected piece.
fn pieces(head: &MorphMesh) -> Vec<u32> {
    let mut piece: Vec<u32> = (0..head.positions.len() as u32).collect();
    loop {
        let before = piece.clone();
        for triangle in &head.triangles {
            let least = triangle
                .map(|v| piece[v as usize])
                .into_iter()
                .min()
                .unwrap_or_default();
            triangle.iter().for_each(|&v| piece[v as usize] = least);
        }
        if piece == before {
            return head
                .triangles
                .iter()
                .map(|triangle| piece[triangle[0] as usize])
                .collect();
        }
    }
}

/// How far a target moves a triangle's corners, summed.
fn reach(head: &MorphMesh, target: usize, triangle: usize) -> f32 {
    let Some(moves) = head.targets.get(target).filter(|moves| !moves.is_empty()) else {
        return 0.0;
    };
    head.triangles[triangle]
        .iter()
        .map(|&v| moves[v as usize].length())
        .sum()
}

/// The name of each triangle. Pieces are named by what moves them as a whole, skin by what moves it
/// most.
fn names(head: &MorphMesh) -> Vec<String> {
    let pieces = pieces(head);
    let mut triangles: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (triangle, &piece) in pieces.iter().enumerate() {
        triangles.entry(piece).or_default().push(triangle);
    }
    let skin = *triangles
        .iter()
        .max_by_key(|(_, all)| all.len())
        .expect("it has triangles")
        .0;
    let target = |name: &str| head.target_names.iter().position(|n| n == name).expect("an ARKit name");
    let mean = |piece: u32, name: &str| {
        let all = &triangles[&piece];
        all.iter().map(|&t| reach(head, target(name), t)).sum::<f32>() / all.len() as f32
    };
    let part = |piece: u32| {
        let looks = ["Left", "Right"].map(|side| mean(piece, &format!("eyeLookIn{side}")));
        match looks {
            [left, _] if left > 0.05 => "left eyeball",
            [_, right] if right > 0.05 => "right eyeball",
            _ if mean(piece, "tongueOut") > 0.05 => "tongue",
            _ if mean(piece, "jawOpen") > 0.05 => "lower teeth",
            _ => "upper teeth",
        }
    };
    let zone = |triangle: usize| {
        let targets = 0..head.targets.len();
        let strongest = targets.max_by(|&a, &b| reach(head, a, triangle).total_cmp(&reach(head, b, triangle)));
        let strongest = strongest.expect("it has targets");
        let name = head.target_names[strongest].as_str();
        let zones = ["brow", "eye", "cheek", "nose", "mouth", "jaw"];
        let known = zones.into_iter().find(|zone| name.starts_with(zone));
        let side = [("Left", " left"), ("Right", " right")]
            .into_iter()
            .find(|side| name.ends_with(side.0));
        let side = side.map_or("", |side| side.1);
        match known {
            Some(zone) if reach(head, strongest, triangle) > 0.03 => format!("{zone}{side}"),
            _ => "head".into(),
        }
    };
    let name = |(triangle, &piece): (usize, &u32)| {
        if piece == skin {
            zone(triangle)
        } else {
            part(piece).into()
        }
    };
    pieces.iter().enumerate().map(name).collect()
}

/// The names of the triangles that a line along -Z may hit first: several if it hits an edge.
fn seen<'a>(x: f64, y: f64, vertices: &[Vec3], head: &MorphMesh, names: &'a [String]) -> HashSet<&'a str> {
    let mut hits: Vec<(f64, &str)> = Vec::new();
    for (triangle, name) in head.triangles.iter().zip(names) {
        let [a, b, c] = triangle.map(|v| vertices[v as usize].as_dvec3());
        let edge = |p: DVec3, q: DVec3| (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
        let (u, v, w) = (edge(b, c), edge(c, a), edge(a, b));
        let area = u + v + w;
        let slack = -1e-6 * area.abs();
        if area != 0.0 && [u, v, w].iter().all(|&part| part * area.signum() >= slack) {
            hits.push(((u * a.z + v * b.z + w * c.z) / area, name));
        }
    }
    let nearest = hits.iter().map(|hit| hit.0).fold(f64::NEG_INFINITY, f64::max);
    hits.iter()
        .filter(|hit| hit.0 > nearest - 1e-5)
        .map(|hit| hit.1)
        .collect()
}

#[test]
fn every_place_of_a_talking_face_has_its_name() {
    let head = head();
    let names = names(&head);
    let mut app = program(MorphPlugins, game);
    play_until(&mut app, |world| {
        world.query::<&MorphColliders>().iter(world).count() > 0 && world.resource::<MorphTrees>().progress().is_done()
    });
    app.update();
    let mut pins = app.world_mut().query::<(Entity, &MorphSurfaceAnchor, &Name)>();
    let mut told: HashSet<String> = HashSet::new();
    let mut misses = 0;
    for frame in 0..140 {
        // A query sees the face of the frame before.
        let vertices = posed_vertices(&head.positions, &head.targets, &weights(&mut app));
        // Teeth are visible only while the jaw is down, so every other frame aims there.
        let x = if frame % 2 == 0 {
            0.049
        } else {
            0.1 * (frame / 2 % 14) as f32 - 0.651
        };
        let lowest = 5.903 + 0.025 * (frame / 2 % 4) as f32;
        let rows: Vec<f32> = (0..27).map(|row| lowest + 0.1 * row as f32).collect();
        let shot = |y: &f32| Shot(Ray3d::new(Vec3::new(x, *y, 10.0), Dir3::NEG_Z));
        let shots: Vec<Shot> = rows.iter().map(shot).collect();
        app.world_mut().write_message_batch(shots);
        app.update();
        // The place on the face of each pin at that time.
        let mut found: Vec<(Entity, Vec3, String)> = pins
            .iter(app.world())
            .map(|(pin, anchor, name)| {
                let corners = head.triangles[anchor.triangle as usize].map(|v| vertices[v as usize]);
                let weights = anchor.barycentrics.to_array();
                let place = corners
                    .iter()
                    .zip(weights)
                    .map(|(&corner, weight)| corner * weight)
                    .sum();
                (pin, place, name.to_string())
            })
            .collect();
        for y in rows {
            let expected = seen(x.into(), y.into(), &vertices, &head, &names);
            let is_here = |(_, place, _): &(Entity, Vec3, String)| place.xy().distance(Vec2::new(x, y)) < 1e-4;
            let pin = found.iter().position(is_here).map(|pin| found.remove(pin));
            assert_eq!(pin.is_none(), expected.is_empty(), "({x}, {y}): a pin for each hit");
            let Some((pin, _, name)) = pin else {
                misses += 1;
                continue;
            };
            assert!(
                expected.contains(name.as_str()),
                "({x}, {y}) is {expected:?}, not {name}"
            );
            told.insert(name);
            app.world_mut().despawn(pin);
        }
        assert!(found.is_empty(), "and none for misses: {found:?}");
    }
    assert!(misses > 0, "some go past the head");
    let wanted = [
        "brow left",
        "brow right",
        "left eyeball",
        "right eyeball",
        "eye left",
        "cheek right",
        "nose left",
        "mouth",
        "jaw",
        "head",
        "upper teeth",
        "lower teeth",
    ];
    let unheard: Vec<_> = wanted.into_iter().filter(|name| !told.contains(*name)).collect();
    assert!(unheard.is_empty(), "{unheard:?} of {told:?}");
}
