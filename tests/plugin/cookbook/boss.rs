//! The boss in armour: dents, broken plates, and one sound for each volley.

use std::collections::HashSet;

use bevy::ecs::message::MessageCursor;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::program;
use super::programs::boss_armour::{Boss, DENT, Part, Volley, game};

/// A part as a player sees it: the hits that it can still take, the depth of its dent, and whether it is hidden and takes no part
/// in collisions.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    health: u32,
    dent: f32,
    gone: [bool; 2],
}

/// The flesh, and the plates from left to right.
fn parts(app: &mut App) -> Vec<Seen> {
    let mut parts = app.world_mut().query::<(
        &Transform,
        &Part,
        Option<&MeshMorphWeights>,
        Option<&Visibility>,
        Has<MorphColliderDisabled>,
    )>();
    let mut parts: Vec<_> = parts.iter(app.world()).collect();
    let order = |place: &Transform| (place.translation.z, place.translation.x);
    parts.sort_by(|a, b| order(a.0).partial_cmp(&order(b.0)).expect("finite places"));
    let seen =
        |(_, part, weights, visibility, is_off): (_, &Part, Option<&MeshMorphWeights>, Option<&Visibility>, bool)| {
            Seen {
                health: part.0,
                dent: match weights {
                    Some(MeshMorphWeights::Value { weights }) => weights[0],
                    _ => 0.0,
                },
                gone: [visibility == Some(&Visibility::Hidden), is_off],
            }
        };
    parts.into_iter().map(seen).collect()
}

#[test]
fn plates_are_dented_and_break_and_the_boss_cries_once_a_volley() {
    let mut app = program(MorphPlugins, game);
    let mut bodies = MessageCursor::<MorphBodyCollisionStart>::default();
    let (mut volleys, mut heard) = (HashSet::new(), Vec::new());
    let mut volley = app.world_mut().query_filtered::<Entity, With<Volley>>();
    let mut stuck = app
        .world_mut()
        .query_filtered::<(&GlobalTransform, &MorphSurfaceAnchor), With<MorphShape>>();
    app.update();
    let mut bosses = app.world_mut().query_filtered::<Entity, With<Boss>>();
    let boss = bosses.single(app.world()).expect("there is one boss");
    let mut states = vec![parts(&mut app)];
    while states
        .last()
        .is_some_and(|parts| parts.iter().any(|part| part.health > 0))
    {
        app.update();
        volleys.extend(volley.iter(app.world()));
        assert!(volleys.len() < 20, "the boss falls: {states:?}");
        for start in bodies.read(app.world().resource()) {
            assert!(start.body1 == boss || start.body2 == boss);
            heard.push(if start.body1 == boss { start.body2 } else { start.body1 });
        }
        let state = parts(&mut app);
        if states.last() != Some(&state) {
            states.push(state);
        }
        // Entities that stick to a plate are in its middle, which the target moves back by the weight.
        for (place, anchor) in stuck.iter(app.world()) {
            if let Some(MeshMorphWeights::Value { weights }) = app.world().get(anchor.collider) {
                let (z, dent) = (place.translation().z, DENT * weights[0]);
                assert!(
                    dent > 0.0 && z < -0.75 * dent && z > -1.01 * dent,
                    "{z}, dented by {dent}"
                );
            }
        }
    }
    let plate = |health: u32, dent: f32| Seen {
        health,
        dent,
        gone: [false; 2],
    };
    let flesh = plate(5, 0.0);
    assert_eq!(states[0], [flesh.clone(), plate(2, 0.0), plate(3, 0.0), plate(4, 0.0)]);
    let dented = [flesh, plate(1, 0.5), plate(2, 1.0 / 3.0), plate(3, 0.25)];
    assert!(
        states.iter().any(|state| *state == dented),
        "the first volley dents all: {states:?}"
    );
    for state in &states {
        assert!(state.iter().all(|part| part.gone == [part.health == 0; 2]), "{state:?}");
        let is_bare = state[1..].iter().any(|plate| plate.health == 0);
        assert!(is_bare || state[0].health == 5, "armour protects: {state:?}");
    }
    // Two, three and four hits break a plate, and the volley that breaks one disappears with it. So the flesh is hit by the whole
    // fifth volley and by the sixth.
    assert_eq!(volleys.len(), 6);
    let once: HashSet<Entity> = heard.iter().copied().collect();
    assert_eq!(heard.len(), once.len(), "one sound for a volley");
    assert_eq!(once, volleys, "and for every volley");
    assert_eq!(app.world().get::<Boss>(boss).map(|boss| boss.0), Some(6));
}
