//! Queries of systems: invalid ones, and many at once.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::system::ReadOnlySystemParam;
use bevy::prelude::*;
use bevy::shape::Aabb3d;
use bevy_morph_collision::prelude::*;

use super::{any, ask, three};
use crate::log::Errors;
use crate::support::Edits;

#[test]
fn what_cannot_be_asked_finds_nothing_and_warns_once() {
    let (mut app, [a, b, _]) = three();
    Errors::collect(|log| {
        for _ in 0..3 {
            let nothing = ask(&mut app, move |s| {
                let nan = Vec3::new(0.0, f32::NAN, 0.0);
                let ball = MorphShape::Ball { radius: -1.0 };
                let turn = Quat::from_xyzw(0.0, 0.0, 0.0, f32::NAN);
                let all = Aabb3d {
                    min: nan.into(),
                    max: nan.into(),
                };
                s.cast_ray(nan, Dir3::X, 9.0, &any()).is_none()
                    && s.ray_hits(Vec3::ZERO, Dir3::X, -1.0, &any()).is_empty()
                    && s.cast_shape(&ball, Vec3::ZERO, Quat::IDENTITY, Dir3::X, 9.0, &any())
                        .is_none()
                    && s.shape_intersections(&MorphShape::default(), Vec3::ZERO, turn, &any())
                        .is_empty()
                    && s.project_point(nan, 9.0, &any()).is_none()
                    && s.point_intersections(nan, &any()).is_empty()
                    && s.aabb_intersections_with_aabb(all, &any()).is_empty()
                    && s.closest_points(a, b, f32::NAN).is_none()
            });
            assert!(nothing);
        }
        let warnings = log.take_warnings();
        let of = |method: &str| {
            warnings
                .iter()
                .filter(|line| line.contains(&format!("::{method}`")))
                .count()
        };
        for method in [
            "cast_ray",
            "ray_hits",
            "cast_shape",
            "shape_intersections",
            "project_point",
            "point_intersections",
            "aabb_intersections_with_aabb",
            "closest_points",
        ] {
            assert_eq!(of(method), 1, "{method}: {warnings:?}");
        }
        // Messages use the names of the method's parameters.
        for (method, problem) in [
            ("cast_ray", "origin: coordinate 1 is NaN"),
            ("ray_hits", "max_distance is -1"),
            ("project_point", "point: coordinate 1 is NaN"),
            ("point_intersections", "point: coordinate 1 is NaN"),
            ("closest_points", "max_distance is NaN"),
        ] {
            let named = |line: &String| line.contains(&format!("::{method}`")) && line.contains(problem);
            assert!(warnings.iter().any(named), "{method}: {warnings:?}");
        }
    });
}

#[test]
fn systems_may_ask_at_the_same_time() {
    fn only_reads<P: ReadOnlySystemParam>() {}
    only_reads::<MorphSpatialQuery>();

    let (mut app, [a, b, _]) = three();
    #[derive(Resource, Default)]
    struct Asked(std::sync::atomic::AtomicU32);
    app.init_resource::<Asked>();
    let ask_often = move |spatial: MorphSpatialQuery, asked: Res<Asked>| {
        let (from, ball) = (Vec3::new(-9.0, 0.1, 0.2), MorphShape::Ball { radius: 20.0 });
        for _ in 0..200 {
            let hit = spatial.cast_ray(from, Dir3::X, 99.0, &any()).unwrap();
            assert_eq!(hit.entity, a);
            let near = spatial.shape_intersections(&ball, Vec3::ZERO, Quat::IDENTITY, &any());
            let apart = spatial
                .closest_points(b, a, 9.0)
                .or(spatial.closest_points(a, b, 9.0))
                .unwrap();
            assert_eq!((near.len(), apart.distance), (3, 2.0));
        }
        asked.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    // Conflicting systems would need a manual order in Bevy; none is needed here.
    let mut schedule = Schedule::default();
    schedule.add_systems((ask_often, ask_often, ask_often));
    schedule.initialize(app.world_mut()).unwrap();
    assert!(schedule.graph().conflicting_systems().is_empty());
    let mut writes = Schedule::default();
    writes.add_systems((ask_often, |mut settings: ResMut<MorphCollisionSettings>| {
        settings.paused = false;
    }));
    writes.initialize(app.world_mut()).unwrap();
    assert!(!writes.graph().conflicting_systems().is_empty(), "it would be noticed");
    for _ in 0..5 {
        schedule.run(app.world_mut());
    }
    assert_eq!(
        app.world()
            .resource::<Asked>()
            .0
            .load(std::sync::atomic::Ordering::Relaxed),
        15
    );

    // Also from many threads of one system.
    let within = ask(&mut app, move |s| {
        std::thread::scope(|scope| {
            let asks: Vec<_> = (0..4)
                .map(|_| {
                    scope.spawn(|| {
                        s.cast_ray(Vec3::new(9.0, 0.1, 0.2), Dir3::NEG_X, 99.0, &any())
                            .map(|hit| hit.distance)
                    })
                })
                .collect();
            asks.into_iter().map(|asked| asked.join().unwrap()).collect::<Vec<_>>()
        })
    });
    assert_eq!(within, [Some(2.5); 4]);
}

#[test]
fn what_was_disabled_is_not_there_before_the_next_run() {
    let (mut app, [a, b, _]) = three();
    let ask_all = move |s: &MorphSpatialQuery| {
        let hit = s.cast_ray(Vec3::new(-9.0, 0.1, 0.2), Dir3::X, 99.0, &any());
        let known = s.bounds(a).is_some() && s.posed_vertex(a, 0).is_some() && s.closest_points(a, b, 99.0).is_some();
        (hit.map(|hit| hit.entity), known)
    };
    assert_eq!(ask(&mut app, ask_all), (Some(a), true));
    app.insert(a, Disabled);
    app.update();
    app.insert(a, Transform::from_xyz(0.0, 50.0, 0.0));
    app.settings().paused = true;
    app.remove::<Disabled>(a);
    app.update();
    // Its earlier place no longer matters.
    assert_eq!(ask(&mut app, ask_all), (Some(b), false));
    app.settings().paused = false;
    app.update();
    assert_eq!(ask(&mut app, ask_all), (Some(b), true));
    assert!(ask(&mut app, move |s| s.bounds(a)).unwrap().min.y > 40.0);
    // A collider that is disabled for less than a run counts as present all the time.
    app.insert(b, Disabled);
    assert!(!ask(&mut app, ask_all).1);
    app.remove::<Disabled>(b);
    assert_eq!(ask(&mut app, ask_all), (Some(b), true));
}
