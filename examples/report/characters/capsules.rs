//! What games do about characters today: one capsule per joint, in Rapier.

use std::collections::BTreeSet;

use bevy::app::AnimationSystems;
use bevy::math::{DMat3, DVec3};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextSimulation};
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use super::stage::Stage;

/// How a capsule is fitted to the vertices of its joint.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Fit {
    /// It contains all of them.
    Around,
    /// Its surface is at their average distance from its axis.
    Through,
}

/// A capsule in the space of its joint.
#[derive(Clone, Copy)]
pub(crate) struct Capsule {
    joint: usize,
    ends: [Vec3; 2],
    radius: f32,
}

/// A capsule for each joint that is the strongest joint of some vertices, along the longest direction of these vertices in the
/// bind pose.
pub(crate) fn fitted(mesh: &MorphMesh, fit: Fit) -> Vec<Capsule> {
    let Some(skin) = &mesh.skin else { return Vec::new() };
    let mut points = vec![Vec::new(); skin.joint_count()];
    for (vertex, &position) in mesh.positions.iter().enumerate() {
        let influences = skin
            .sets
            .iter()
            .flat_map(|set| set.joints[vertex].into_iter().zip(set.weights[vertex]));
        if let Some((joint, _)) = influences.max_by(|a, b| a.1.total_cmp(&b.1)) {
            let joint = usize::from(joint);
            let inverse_bind = skin.skeleton.joints[joint].inverse_bind;
            points[joint].push(inverse_bind.transform_point3(position).as_dvec3());
        }
    }
    let of_joint = |(joint, points): (usize, Vec<DVec3>)| (points.len() >= 3).then(|| capsule(joint, &points, fit));
    points.into_iter().enumerate().filter_map(of_joint).collect()
}

fn capsule(joint: usize, points: &[DVec3], fit: Fit) -> Capsule {
    let count = points.len() as f64;
    let center = points.iter().sum::<DVec3>() / count;
    let mut spread = DMat3::ZERO;
    for &point in points {
        let off = point - center;
        spread += DMat3::from_cols(off * off.x, off * off.y, off * off.z);
    }
    // The direction of the largest spread, by power iteration.
    let mut axis = DVec3::new(0.6, 0.5, 0.4);
    for _ in 0..200 {
        axis = (spread * axis).normalize_or(DVec3::Y);
    }
    let along: Vec<f64> = points.iter().map(|&point| (point - center).dot(axis)).collect();
    let off_axis: Vec<f64> = points
        .iter()
        .map(|&point| (point - center).reject_from(axis).length())
        .collect();
    let radius = match fit {
        Fit::Around => off_axis.iter().copied().fold(0.0, f64::max),
        Fit::Through => off_axis.iter().sum::<f64>() / count,
    };
    let radius = radius.max(1e-3);
    // A cap reaches less far away from the axis.
    let reach = |off_axis: f64| (radius * radius - off_axis * off_axis).max(0.0).sqrt();
    let ends = match fit {
        Fit::Around => {
            let caps = along.iter().zip(&off_axis);
            caps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (&t, &off_axis)| {
                (low.min(t + reach(off_axis)), high.max(t - reach(off_axis)))
            })
        }
        Fit::Through => {
            let mut sorted = along.clone();
            sorted.sort_by(f64::total_cmp);
            let share = |share: f64| sorted[(share * (sorted.len() - 1) as f64).round() as usize];
            (share(0.05) + radius, share(0.95) - radius)
        }
    };
    let (low, high) = if ends.0 <= ends.1 {
        ends
    } else {
        let middle = f64::midpoint(ends.0, ends.1);
        (middle, middle)
    };
    Capsule {
        joint,
        ends: [low, high].map(|t| (center + axis * t).as_vec3()),
        radius: radius as f32,
    }
}

/// Adds physics that sees joints where this frame's animation puts them.
pub(crate) fn add_physics(app: &mut App) {
    app.add_plugins(RapierPhysicsPlugin::<NoUserData>::default())
        .insert_resource(TimestepMode::Fixed {
            dt: 1.0 / 60.0,
            substeps: 1,
        })
        .configure_sets(PostUpdate, PhysicsSet::SyncBackend.after(AnimationSystems));
}

/// Attaches capsules to the joints of every character, as sensors of one kinematic body per character.
pub(crate) fn dress(stage: &mut Stage, capsules: &[Capsule]) {
    for &root in &stage.roots {
        let body = (RigidBody::KinematicPositionBased, Sleeping::disabled());
        stage.app.world_mut().entity_mut(root).insert(body);
    }
    for part in &stage.parts {
        let world = stage.app.world_mut();
        let Some(skin) = world.get::<SkinnedMesh>(part.entity).cloned() else {
            continue;
        };
        for &Capsule {
            joint,
            ends: [a, b],
            radius,
        } in capsules
        {
            world.spawn((
                Collider::capsule(a, b, radius),
                Sensor,
                ActiveCollisionTypes::KINEMATIC_KINEMATIC,
                ActiveEvents::COLLISION_EVENTS,
                Transform::default(),
                ChildOf(skin.joints[joint]),
            ));
        }
    }
    for _ in 0..4 {
        stage.app.update();
    }
}

/// The pairs of characters whose capsules intersect, according to Rapier.
pub(crate) fn touching(stage: &mut Stage) -> BTreeSet<(usize, usize)> {
    let world = stage.app.world_mut();
    let mut contexts = world.query::<(&RapierContextSimulation, &RapierContextColliders)>();
    let pairs: Vec<(Entity, Entity)> = contexts
        .iter(world)
        .flat_map(|(simulation, colliders)| simulation.intersection_pairs(colliders).collect::<Vec<_>>())
        .filter_map(|(a, b, intersects)| intersects.then_some((a, b)))
        .collect();
    let characters = |(a, b): (Entity, Entity)| Some((stage.character(a)?, stage.character(b)?));
    let pairs = pairs.into_iter().filter_map(characters);
    pairs
        .map(|(a, b)| (a.min(b), a.max(b)))
        .filter(|(a, b)| a != b)
        .collect()
}

/// The same by the definition of a capsule, to check that Rapier is used correctly. Capsules nearer than `slack` count as
/// intersecting.
pub(crate) fn touching_by_distance(stage: &Stage, capsules: &[Capsule], slack: f64) -> BTreeSet<(usize, usize)> {
    let world = stage.app.world();
    let mut all: Vec<(usize, [DVec3; 2], f64)> = Vec::new();
    for (character, part) in stage.parts.iter().enumerate() {
        let Some(skin) = world.get::<SkinnedMesh>(part.entity) else {
            continue;
        };
        for capsule in capsules {
            let place = world
                .get::<GlobalTransform>(skin.joints[capsule.joint])
                .map(GlobalTransform::affine);
            let place = place.unwrap_or_default();
            let ends = capsule.ends.map(|end| place.transform_point3(end).as_dvec3());
            all.push((character, ends, f64::from(capsule.radius)));
        }
    }
    let mut pairs = BTreeSet::new();
    for (i, (a, ends_a, radius_a)) in all.iter().enumerate() {
        for (b, ends_b, radius_b) in &all[..i] {
            let reach = radius_a + radius_b + slack;
            let far =
                ends_a[0].distance(ends_b[0]) > reach + ends_a[0].distance(ends_a[1]) + ends_b[0].distance(ends_b[1]);
            if a != b && !far && segment_distance(*ends_a, *ends_b) <= reach {
                pairs.insert((*a.min(b), *a.max(b)));
            }
        }
    }
    pairs
}

/// The distance of two segments, at their ends or within both.
fn segment_distance([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let to_segment = |p: DVec3, [a, b]: [DVec3; 2]| {
        let along = b - a;
        let t = if along == DVec3::ZERO {
            0.0
        } else {
            ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
        };
        p.distance(a + along * t)
    };
    let ends = [
        to_segment(a, [c, d]),
        to_segment(b, [c, d]),
        to_segment(c, [a, b]),
        to_segment(d, [a, b]),
    ];
    let nearest = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    let determinant = uu * vv - uv * uv;
    if determinant <= 1e-12 * uu * vv {
        return nearest;
    }
    let (s, t) = ((uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant);
    let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
    if inside {
        nearest.min((w + u * s - v * t).length())
    } else {
        nearest
    }
}
