//! The mouth that eats. Checks what is eaten and what bounces by the distances to teeth, tongue and skin in the
//! file.

use std::collections::HashMap;
use std::time::Duration;

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::oracle::{point_distance, posed_vertices};
use morph_collision_workspace::app::STEP;

use super::programs::mouth_trigger::{Food, RADIUS, Score, game};
use super::{head, play_until, program, weights};

#[test]
fn what_gets_in_is_eaten_and_what_hits_the_skin_bounces() {
    let head = head();
    let jaw = head
        .target_names
        .iter()
        .position(|name| name == "jawOpen")
        .expect("a jaw opens");
    // Teeth and tongue are the last objects in the file.
    let inside: Vec<bool> = head
        .triangles
        .iter()
        .zip(0..)
        .map(|(_, number)| number >= 8894)
        .collect();
    let mut app = program(MorphPlugins, game);
    let mut score = Score::default();
    let mut food = app.world_mut().query::<(Entity, &Food, &Transform)>();
    let mut before: HashMap<Entity, (bool, Vec3)> = HashMap::new();
    // The jaw waits while files load, so that what is thrown meets the same mouth however long that takes.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    play_until(&mut app, |world| {
        world.query::<&MorphColliders>().iter(world).count() > 0
    });
    play_until(&mut app, |world| world.resource::<MorphTrees>().progress().is_done());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    let (mut bounced_while_open, mut eaten_at) = (0, Vec::new());
    for _ in 0..900 {
        app.update();
        let now: HashMap<Entity, (bool, Vec3)> = food
            .iter(app.world())
            .map(|(entity, food, place)| (entity, (food.is_spent, place.translation)))
            .collect();
        let weights = weights(&mut app);
        let mut posed = None;
        for (entity, &(was_spent, at)) in &before {
            let (eaten, bounced) = match now.get(entity) {
                _ if was_spent => continue,
                None => (true, false),
                Some((spent, _)) => (false, *spent),
            };
            if !eaten && !bounced {
                continue;
            }
            // This is where it flew to in this frame.
            let at = now
                .get(entity)
                .map_or(at - Vec3::Z * 3.0 / 60.0, |now| now.1)
                .as_dvec3();
            let posed = posed.get_or_insert_with(|| posed_vertices(&head.positions, &head.targets, &weights));
            let nearest = |wanted: bool| {
                let triangles = head
                    .triangles
                    .iter()
                    .zip(&inside)
                    .filter(|(_, is_inside)| **is_inside == wanted);
                let corners = |triangle: &[u32; 3]| triangle.map(|v| posed[v as usize].as_dvec3());
                let distances = triangles.map(|(triangle, _)| point_distance(at, &corners(triangle)));
                distances.fold(f64::INFINITY, f64::min)
            };
            let (teeth, skin): (f64, f64) = (nearest(true), nearest(false));
            let reach = f64::from(RADIUS) + 1e-4;
            if eaten {
                score.eaten += 1;
                eaten_at.push(weights[jaw]);
                assert!(teeth < reach, "eaten {teeth} from teeth and tongue, at {at}");
            } else {
                score.bounced += 1;
                bounced_while_open += u32::from(weights[jaw] > 0.5);
                assert!(
                    skin < reach && teeth > reach - 2e-4,
                    "bounced {skin} from the skin, {teeth} from the teeth"
                );
                assert!(
                    app.world()
                        .get::<Food>(*entity)
                        .is_some_and(|food| food.velocity.z > -3.0)
                );
            }
        }
        before = now;
    }
    assert_eq!(*app.world().resource::<Score>(), score);
    assert!(score.eaten >= 5 && score.bounced >= 5, "{score:?}");
    assert!(
        eaten_at.iter().all(|&open| open > 0.2),
        "through an open mouth: {eaten_at:?}"
    );
    assert!(bounced_while_open > 0, "a cheek is no mouth");
    // Nothing passed through the head.
    let behind = |(_, _, place): (Entity, &Food, &Transform)| place.translation.z < -0.5;
    assert!(!food.iter(app.world()).any(behind));
}
