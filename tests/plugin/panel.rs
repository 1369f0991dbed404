//! The panel of diagnostics, with the components of Bevy's UI and without a renderer.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use crate::log::{Errors, start};
use crate::support::{Edits, add_mesh, assets, cube, diagnostics, move_to, plain_app, settle, spawn};

/// Two cubes that overlap, and far from them two round bodies with many triangles that do, too.
fn with_panel(settings: MorphDiagnosticsUiSettings) -> (App, [Entity; 2]) {
    let mut app = headless(&assets());
    app.add_plugins(MorphDiagnosticsUiPlugin).insert_resource(settings);
    start(&mut app);
    let cube = add_mesh(&mut app, &cube());
    for x in [0.0, 0.5] {
        spawn(&mut app, &cube, x);
    }
    let ball = Sphere::new(1.0).mesh().ico(8).expect("it is small enough");
    let ball = app.world_mut().resource_mut::<Assets<Mesh>>().add(ball);
    let balls = [10.0, 11.0].map(|x| spawn(&mut app, &ball, x));
    app.insert(balls[0], Name::new("Left"));
    app.insert(balls[1], Name::new("Right"));
    settle(&mut app);
    (app, balls)
}

/// The texts, by section: the names and the values of its rows.
fn texts(app: &mut App) -> Vec<Vec<(String, String)>> {
    let world = app.world_mut();
    let mut panels = world.query_filtered::<&Children, With<MorphDiagnosticsUi>>();
    let sections: Vec<Entity> = panels.iter(world).flatten().copied().collect();
    let columns = |section: &Entity| {
        let columns = world.get::<Children>(*section).expect("it has columns").iter();
        let columns = columns.map(|column| {
            world
                .get::<Text>(column)
                .expect("it is a text")
                .lines()
                .map(str::to_owned)
        });
        let [names, values] = columns
            .collect::<Vec<_>>()
            .try_into()
            .map_err(|_| "two columns")
            .unwrap();
        names.zip(values).collect()
    };
    sections.iter().map(columns).collect()
}

fn value(rows: &[(String, String)], name: &str) -> String {
    let row = rows.iter().find(|(of, _)| of == name);
    row.unwrap_or_else(|| panic!("no {name} in {rows:?}")).1.clone()
}

/// Entities of Bevy's UI.
fn nodes(app: &mut App) -> usize {
    app.world_mut().query::<&Node>().iter(app.world()).count()
}

/// Runs for longer than the texts stay.
fn wait(app: &mut App) {
    (0..20).for_each(|_| app.update());
}

#[test]
fn texts_have_the_numbers_of_the_last_run() {
    let (mut app, [left, _]) = with_panel(default());
    wait(&mut app);
    let [counts, times, _] = &texts(&mut app)[..] else {
        panic!("three sections")
    };
    assert_eq!(value(counts, "colliders"), "4");
    assert_eq!(value(counts, "pairs touching"), "2");
    assert_eq!(value(counts, "pairs compared"), "0", "nothing changes");
    let listed = diagnostics(&app).triangle_pairs;
    assert!(listed > 20);
    assert_eq!(value(counts, "triangle pairs"), listed.to_string());
    let names = times.iter().map(|(name, _)| name.as_str());
    let expected = [
        "import",
        "weights",
        "broad phase",
        "narrow phase",
        "events",
        "casters",
        "anchors",
        "all",
    ];
    assert!(names.eq(expected), "{times:?}");
    assert!(times.iter().all(|(_, time)| time.ends_with(" ms")), "{times:?}");
    // Texts are replaced a few times per second: what has changed is not there at once.
    app.insert(left, MorphColliderDisabled);
    app.update();
    assert_eq!(value(&texts(&mut app)[0], "colliders"), "4");
    wait(&mut app);
    assert_eq!(value(&texts(&mut app)[0], "colliders"), "3");
}

#[test]
fn the_costliest_pair_comes_first() {
    let (mut app, [left, right]) = with_panel(MorphDiagnosticsUiSettings { pairs: 3, ..default() });
    let mut cubes = app
        .world_mut()
        .query_filtered::<Entity, (With<MorphCollider>, Without<Name>)>();
    let cube = cubes.iter(app.world()).next().expect("there are cubes");
    let nudge = |app: &mut App, step: usize| {
        // All pairs are compared in each run.
        move_to(app, left, 10.0 + 1e-3 * step as f32);
        move_to(app, cube, 1e-3 * step as f32);
        app.update();
    };
    (0..20).for_each(|step| nudge(&mut app, step));
    let costs = app.world().resource::<MorphPairCosts>().pairs().to_vec();
    let pairs: Vec<_> = costs.iter().map(|pair| [pair.collider1, pair.collider2]).collect();
    assert_eq!(pairs.len(), 2);
    assert!(pairs[0].contains(&left) && pairs[0].contains(&right), "{costs:?}");
    assert!(costs[0].tests > 2 * costs[1].tests && costs[1].tests > 0, "{costs:?}");
    let all = diagnostics(&app).stats;
    let counted: u64 = costs.iter().map(|pair| pair.tests).sum();
    assert!(counted <= all.node_tests + all.triangle_tests, "{counted} of {all:?}");
    let rows = &texts(&mut app)[2];
    assert_eq!(rows.len(), 3, "{rows:?}");
    let mut names: Vec<&str> = rows[1].0.split(", ").collect();
    names.sort_unstable();
    assert_eq!(names, ["Left", "Right"]);
    // One pair alone.
    app.world_mut().resource_mut::<MorphDiagnosticsUiSettings>().pairs = 1;
    nudge(&mut app, 20);
    nudge(&mut app, 21);
    let costs = app.world().resource::<MorphPairCosts>().pairs();
    assert!(costs.len() == 1 && pairs[0].contains(&costs[0].collider1), "{costs:?}");
}

#[test]
fn settings_show_and_hide_it() {
    let off = MorphDiagnosticsUiSettings {
        enabled: false,
        ..default()
    };
    let (mut app, [left, _]) = with_panel(off);
    move_to(&mut app, left, 10.1);
    wait(&mut app);
    assert_eq!(nodes(&mut app), 0);
    assert_eq!(
        *app.world().resource::<MorphPairCosts>(),
        MorphPairCosts::default(),
        "nothing is counted"
    );
    let mut set = |settings, wanted| {
        app.insert_resource::<MorphDiagnosticsUiSettings>(settings);
        app.update();
        assert_eq!(texts(&mut app).len(), wanted, "{settings:?}");
        (nodes(&mut app), app.world().resource::<MorphPairCosts>().limit)
    };
    let all = MorphDiagnosticsUiSettings::default();
    // The panel, and for each section a row and two texts.
    assert_eq!(set(all, 3), (10, 5));
    assert_eq!(set(MorphDiagnosticsUiSettings { times: false, ..all }, 2), (7, 5));
    assert_eq!(set(MorphDiagnosticsUiSettings { pairs: 0, ..all }, 2), (7, 0));
    assert_eq!(set(all, 3), (10, 5));
    assert_eq!(set(off, 0), (0, 0));
}

#[test]
fn without_collision_detection_an_error_says_so() {
    Errors::collect(|errors| {
        let mut app = plain_app();
        app.add_plugins(MorphDiagnosticsUiPlugin);
        start(&mut app);
        wait(&mut app);
        let logged = errors.take();
        assert!(
            logged.len() == 1 && logged[0].contains("MorphDiagnosticsUiPlugin shows nothing"),
            "{logged:?}"
        );
        assert_eq!(nodes(&mut app), 0);
    });
}
