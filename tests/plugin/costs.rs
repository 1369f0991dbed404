//! What a run cost, by stage and by pair.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, diagnostics, move_to, settle, two_cubes};

#[test]
fn the_stages_take_the_whole_time() {
    let (mut app, [_, b]) = two_cubes(0.5);
    app.spawn(MorphRayCaster::default());
    move_to(&mut app, b, 0.6);
    app.update();
    let run = diagnostics(&app);
    let stages = MorphStageTimes::STAGES.map(|stage| run.times.of(stage));
    assert_eq!(stages.iter().sum::<std::time::Duration>(), run.duration);
    let MorphStageTimes {
        weights,
        broad_phase,
        narrow_phase,
        events,
        casters,
        ..
    } = run.times;
    assert!(
        [weights, broad_phase, narrow_phase, events, casters]
            .iter()
            .all(|time| !time.is_zero()),
        "{run:?}"
    );
}

#[test]
fn the_work_of_pairs_is_counted_on_demand() {
    let (mut app, [a, b]) = two_cubes(0.5);
    let ball = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(-0.5, 0.0, 0.0)));
    let far = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(90.0, 0.0, 0.0)));
    settle(&mut app);
    let pairs = |app: &App| app.world().resource::<MorphPairCosts>().pairs().to_vec();
    assert!(pairs(&app).is_empty());
    app.insert_resource(MorphPairCosts::new(9));
    app.update();
    assert!(pairs(&app).is_empty(), "nothing was compared");
    let stretch = |app: &mut App, x: f32| {
        move_to(app, a, x);
        app.update();
    };
    stretch(&mut app, 0.1);
    let costs = pairs(&app);
    assert_eq!(costs.len(), 2, "{costs:?}");
    for pair in &costs {
        let of = [pair.collider1, pair.collider2];
        assert!(
            of.contains(&a) && (of.contains(&b) || of.contains(&ball)) && !of.contains(&far),
            "{costs:?}"
        );
    }
    let all = diagnostics(&app).stats;
    assert_eq!(
        costs.iter().map(|pair| pair.tests).sum::<u64>(),
        all.node_tests + all.triangle_tests
    );
    assert!(costs.is_sorted_by_key(|pair| std::cmp::Reverse(pair.tests)));
    // A continuous pair also takes the work of its motion.
    app.insert(a, MorphCollider::default().with_continuous(true));
    app.insert(ball, MorphColliderDisabled);
    stretch(&mut app, -5.0);
    stretch(&mut app, 5.0);
    let swept = diagnostics(&app).swept_stats;
    let costs = pairs(&app);
    assert!(swept.feature_tests > 0 && costs.len() == 1, "{costs:?}");
    assert!(
        costs[0].tests >= swept.node_tests + swept.feature_tests,
        "{costs:?} of {swept:?}"
    );
    app.world_mut().resource_mut::<MorphPairCosts>().limit = 0;
    app.update();
    assert!(pairs(&app).is_empty());
}
