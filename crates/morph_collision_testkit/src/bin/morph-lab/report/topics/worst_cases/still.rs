//! Bodies at rest.

use std::error::Error;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{
    Body, BuildOptions, ContactQuery, DistanceQuery, MorphBvh, PairQuery, PlacedShape, Pose, Ray, RayQuery, SelfQuery,
    ShapeQuery,
};
use morph_collision_models::generated::random::random_blob;

use super::{Case, LEVEL, MOST, Subjects, bodies, milliseconds, placed};

/// Placements of two bodies.
fn situations() -> Vec<(&'static str, [Affine3A; 2])> {
    let place = |scale: Vec3, at: Vec3| Affine3A::from_scale_rotation_translation(scale, Quat::IDENTITY, at);
    let beside = |scale: Vec3, x: f32| [place(scale, Vec3::X * -x), place(scale, Vec3::X * x)];
    let far = Vec3::new(1e5, -2e4, 5e4);
    vec![
        ("overlapping", beside(Vec3::ONE, 0.5)),
        ("apart by 1e-6 of their size", beside(Vec3::ONE, 1.0)),
        ("coincident", beside(Vec3::ONE, 0.0)),
        ("points at one place", beside(Vec3::ZERO, 0.0)),
        ("points apart", beside(Vec3::ZERO, 0.1)),
        ("in a line", beside(Vec3::X, 0.3)),
        ("in a plane", beside(Vec3::new(1.0, 1.0, 0.0), 0.3)),
        ("1e-20", beside(Vec3::splat(1e-20), 5e-21)),
        ("1e20", beside(Vec3::splat(1e20), 5e19)),
        ("1e37", beside(Vec3::splat(1e37), 5e36)),
        ("mirrored", beside(Vec3::NEG_ONE, 0.5)),
        ("far away", [place(Vec3::ONE, far - 0.5), place(Vec3::ONE, far + 0.5)]),
        (
            "far away and small",
            [
                place(Vec3::splat(1e-2), far - 5e-3),
                place(Vec3::splat(1e-2), far + 5e-3),
            ],
        ),
        (
            "one inside the other",
            [place(Vec3::ONE, Vec3::ZERO), place(Vec3::splat(0.5), Vec3::ZERO)],
        ),
        (
            "a point inside the other",
            [place(Vec3::ONE, Vec3::ZERO), place(Vec3::ZERO, Vec3::ZERO)],
        ),
    ]
}

pub(super) fn measure(rounds: usize, measured: &str) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut subjects = Subjects::new()?;
    let mut cases = Vec::new();
    for (situation, places) in situations() {
        let places = placed(places)?;
        let mut add = |query: &str, work: &mut dyn FnMut([Body<'_>; 2]) -> String| {
            let (milliseconds, answer) = milliseconds(rounds, || {
                let [[a, _], [b, _]] = &mut subjects.poses;
                // Nothing is known from the round before.
                (*a, *b) = (Pose::new(a.bvh().clone()), Pose::new(b.bvh().clone()));
                work(bodies([a, b], &places))
            });
            cases.push(Case {
                situation: situation.to_owned(),
                query: query.to_owned(),
                milliseconds,
                answer,
                measured: measured.to_owned(),
            });
        };
        let mut pairs = PairQuery::new();
        add("any", &mut |[a, b]| yes_or_no(pairs.any(a, b)));
        add("all", &mut |[a, b]| {
            let mut found = Vec::new();
            pairs.up_to(a, b, MOST, &mut found);
            found.len().to_string()
        });
        let mut contacts = ContactQuery::new();
        add("manifold", &mut |[a, b]| {
            yes_or_no(contacts.manifold_up_to(a, b, MOST).is_some())
        });
        let mut distance = DistanceQuery::new();
        add("distance", &mut |[a, b]| match distance.closest(a, b, f64::INFINITY) {
            Ok(Some(closest)) => format!("{:.1e}", closest.distance),
            _ => "none".to_owned(),
        });
        let ball = PlacedShape::ball(DVec3::ZERO, 0.5)?;
        let mut shapes = ShapeQuery::new();
        add("ball", &mut |[a, _]| {
            let mut found = Vec::new();
            match shapes.contacts_up_to(a, &ball, 0.0, MOST, &mut found) {
                Ok(_) => found.len().to_string(),
                Err(error) => error.to_string(),
            }
        });
        let mut cast = ShapeQuery::new();
        add(
            "ball cast",
            &mut |[a, _]| match cast.cast(a, &ball, DVec3::X, f64::INFINITY) {
                Ok(hit) => yes_or_no(hit.is_some()),
                Err(error) => error.to_string(),
            },
        );
        let ray = Ray::new(DVec3::ZERO, DVec3::X, f64::INFINITY)?;
        let mut rays = RayQuery::new();
        add("ray", &mut |[a, _]| yes_or_no(rays.closest(a, &ray).is_some()));
        add("all hits", &mut |[a, _]| {
            let mut hits = Vec::new();
            rays.all(a, &ray, &mut hits);
            hits.len().to_string()
        });
    }
    Ok(cases)
}

/// A mesh whose weights collapse it, compared with itself.
pub(super) fn measure_one(rounds: usize, measured: &str) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut cases = Vec::new();
    for (situation, kept) in [
        ("to a point", Vec3::ZERO),
        ("to a line", Vec3::X),
        ("to a plane", Vec3::new(1.0, 1.0, 0.0)),
    ] {
        let mut mesh = random_blob(1, LEVEL, 0, 0.0);
        let collapse = mesh.positions.iter().map(|position| *position * kept - *position);
        mesh.targets.push(collapse.collect());
        mesh.target_names.push("collapse".to_owned());
        let mut pose = Pose::new(Arc::new(MorphBvh::build(
            Arc::new(mesh.to_model()?),
            &BuildOptions::default(),
        )));
        for weight in [1.0, 1.0 - 1e-6, -1.0] {
            pose.set_weights(&[weight])?;
            let mut query = SelfQuery::new();
            let (milliseconds, answer) = milliseconds(rounds, || {
                let mut pairs = Vec::new();
                query.up_to(&mut pose, MOST, &mut pairs);
                pairs.len().to_string()
            });
            cases.push(Case {
                situation: situation.to_owned(),
                query: format!("weight {weight}"),
                milliseconds,
                answer,
                measured: measured.to_owned(),
            });
        }
    }
    Ok(cases)
}

fn yes_or_no(is: bool) -> String {
    if is { "yes" } else { "no" }.to_owned()
}
