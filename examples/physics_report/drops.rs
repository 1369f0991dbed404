//! Bodies that fall into a waving bowl: how many fall through, and how.

use std::fmt::Write as _;
use std::path::Path;

use bevy::prelude::*;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::geometry::Collider as RapierCollider;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::physics::drops::{Drop, Kind, above, batch_of_drops, bowl, fates, waves};
use morph_collision_workspace::physics::{DT, Method, Surface, app, body, settle, state};
use morph_collision_workspace::tables::progress;

/// Drops bodies that do not collide with each other into the bowl, and counts how many fall through.
pub(super) fn table(quick: bool) -> String {
    let mesh = bowl();
    let batches = if quick { 4 } else { 100 };
    let per_batch = 100;
    let speeds = [1.0, 2.0, 5.0, 20.0];
    let progress = progress(batches * 4 * speeds.len() as u64);
    let mut table = String::from(
        "| method | CCD | speed | drops | fell through | left over the rim |\n|---|---|--:|--:|--:|--:|\n",
    );
    for ccd in [false, true] {
        for method in [Method::Ours, Method::NewMesh] {
            for speed in speeds {
                let (mut through, mut left) = (0, 0);
                for batch in 0..batches {
                    let drops = batch_of_drops(batch, per_batch, speed);
                    let fell = fall(method, &mesh, ccd, &drops, |_, _, _| {});
                    through += fell.0;
                    left += fell.1;
                    progress.inc(1);
                }
                let on = if ccd { "on" } else { "off" };
                let (name, drops) = (method.name(), batches * per_batch);
                let _infallible = writeln!(table, "| {name} | {on} | {speed} | {drops} | {through} | {left} |");
            }
        }
    }
    progress.finish_and_clear();
    table
}

/// Drops bodies and counts their fates. `see` is called after each step, with the bodies and the bowl's weights.
fn fall(
    method: Method,
    mesh: &MorphMesh,
    ccd: bool,
    drops: &[Drop],
    mut see: impl FnMut(&mut App, &[Entity], &[f32; 2]),
) -> (u64, u64) {
    let mut app = app(Path::new("."));
    let mut surface = Surface::spawn(&mut app, method, mesh, Vec3::ZERO, &mut None);
    settle(&mut app);
    let mut bodies = Vec::new();
    for drop in drops {
        let size = drop.size;
        let collider = match drop.kind {
            Kind::Ball => Collider::ball(size),
            Kind::Cuboid => Collider::cuboid(size, 0.7 * size, 0.5 * size),
            Kind::Capsule => Collider::capsule_y(size, 0.5 * size),
        };
        let body = body(&mut app, collider, drop.at);
        // They collide only with the surface.
        let groups = CollisionGroups::new(Group::GROUP_1, Group::ALL ^ Group::GROUP_1);
        let mut entity = app.world_mut().entity_mut(body);
        let velocity = Velocity {
            linear: drop.linear,
            angular: drop.angular,
        };
        entity.insert((velocity, groups));
        if ccd {
            entity.insert(Ccd::enabled());
        }
        bodies.push(body);
    }
    for step in 0..240 {
        let weights = waves(step as f32 * DT);
        surface.pose(&mut app, &weights);
        app.update();
        see(&mut app, &bodies, &weights);
    }
    fates(bodies.iter().map(|&body| state(&app, body).0))
}

/// Drops a batch, or one body of it, and prints the last steps of the bodies that fall through, until their centres are below the
/// surface: how far above it they are, their velocities, and the contacts that Rapier's solver had.
pub(super) fn trace(method: Method, batch: u64, (ccd, speed): (bool, f32), alone: Option<usize>) {
    let drops = batch_of_drops(batch, 100, speed);
    let first = alone.unwrap_or(0);
    let drops = match alone {
        Some(one) => drops.get(one..=one).unwrap_or_default(),
        None => &drops,
    };
    let mut traces = vec![String::new(); drops.len()];
    let mut places = Vec::new();
    fall(method, &bowl(), ccd, drops, |app, bodies, weights| {
        places.clear();
        for (&body, trace) in bodies.iter().zip(&mut traces) {
            let place = state(app, body).0;
            places.push(place);
            if above(place, weights) < 2.0 && place.y > -1.0 {
                line(app, body, above(place, weights), trace);
            }
        }
    });
    let (through, left) = fates(places.iter().copied());
    println!("batch {batch}: {through} fell through, {left} left over the rim");
    for ((i, (drop, trace)), &place) in (first..).zip(drops.iter().zip(&traces)).zip(&places) {
        if fates([place].into_iter()).0 > 0 {
            println!("batch {batch}, body {i}: {drop:?}");
            let lines: Vec<&str> = trace.lines().collect();
            let below = lines.iter().rposition(|line| !line.starts_with('-')).unwrap_or(0);
            for line in &lines[below.saturating_sub(20)..lines.len().min(below + 5)] {
                println!("    {line}");
            }
        }
    }
}

/// Appends what is known of a body after a step.
fn line(app: &mut App, body: Entity, above: f32, into: &mut String) {
    let mut contexts = app
        .world_mut()
        .query::<(&RapierContextSimulation, &RapierContextColliders, &RapierRigidBodySet)>();
    let Ok((simulation, colliders, bodies)) = contexts.single(app.world()) else {
        return;
    };
    let handle = bodies.entity2body().get(&body).copied();
    let (Some(found), Some(&collider)) = (
        handle.and_then(|handle| bodies.bodies.get(handle)),
        colliders.entity2collider().get(&body),
    ) else {
        return;
    };
    let place = found.translation();
    let _infallible = write!(
        into,
        "{above:+.3} at {place:.2} v {:.2} w {:.1} |",
        found.linvel(),
        found.angvel()
    );
    for pair in simulation.narrow_phase.contact_pairs_with(collider) {
        let flip = if pair.collider1 == collider { -1.0 } else { 1.0 };
        let other = if flip > 0.0 { pair.collider1 } else { pair.collider2 };
        let part = colliders.colliders.get(other).and_then(RapierCollider::parent);
        let part = part.and_then(|part| bodies.bodies.get(part));
        let velocity = part.map(|part| part.velocity_at_point(place)).unwrap_or_default();
        let _infallible = write!(into, " [u {velocity:.2}");
        for manifold in pair.solver_manifolds() {
            let points = &manifold.points;
            let nearest = points.iter().map(|point| point.dist).fold(f32::INFINITY, f32::min);
            let impulse: f32 = points.iter().map(|point| point.data.impulse).sum();
            if !points.is_empty() {
                let normal = flip * manifold.data.normal;
                let solved = manifold.data.solver_contacts.len();
                let _infallible = write!(into, " ({nearest:+.3} {normal:.2} {solved} {impulse:.3})");
            }
        }
        into.push(']');
    }
    into.push('\n');
}
