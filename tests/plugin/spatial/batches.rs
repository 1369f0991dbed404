//! Many questions at one moment, compared with one at a time.

use bevy::math::Isometry3d;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{any, ask, three};
use crate::support::Edits;

/// Low-discrepancy steps in a box around the cubes.
fn point(number: usize) -> Vec3 {
    let share = |stride: f64| (2.0 * (number as f64 * stride).fract() - 1.0) as f32;
    Vec3::new(3.0, 0.0, 0.0) + Vec3::new(5.0, 1.5, 1.5) * Vec3::new(share(0.819_173), share(0.671_044), share(0.549_7))
}

fn points(count: usize) -> Vec<Vec3> {
    (0..count).map(point).collect()
}

/// So many that they are spread over threads, and so few that they are not.
const COUNTS: [usize; 3] = [3000, 100, 0];

#[test]
fn many_rays_hit_what_each_hits() {
    let (mut app, [_, b, _]) = three();
    app.spawn((
        MorphShape::Ball { radius: 0.7 },
        MorphCollider::default(),
        Transform::from_xyz(1.5, 0.0, 0.0),
    ));
    app.update();
    for count in COUNTS {
        let (batch, single) = ask(&mut app, move |s| {
            let ray = |(from, to): (Vec3, Vec3)| Ray3d::new(from, Dir3::new(to - from).unwrap_or(Dir3::X));
            let mut rays: Vec<_> = points(count)
                .into_iter()
                .zip(points(count + 7).split_off(7))
                .map(ray)
                .collect();
            if let Some(ray) = rays.get_mut(11) {
                ray.origin.x = f32::NAN;
            }
            // Whatever is in the list is replaced.
            let mut hits = vec![None; 5];
            let filter = any().with_excluded_entities([b]).with_only_front();
            s.cast_rays(&rays, 4.0, &filter, &mut hits);
            let single = rays
                .iter()
                .map(|ray| s.cast_ray(ray.origin, ray.direction, 4.0, &filter));
            (hits, single.collect::<Vec<_>>())
        });
        assert_eq!(batch, single);
        let hits = batch.iter().flatten().count();
        assert!(count == 0 || hits > count / 20 && hits < count, "{hits} of {count}");
    }
}

#[test]
fn many_points_are_projected_as_each_is() {
    let (mut app, _) = three();
    app.spawn((
        MorphShape::Ball { radius: 0.7 },
        MorphCollider::default(),
        Transform::from_xyz(1.5, 0.0, 0.0),
    ));
    app.update();
    for count in COUNTS {
        let (batch, single) = ask(&mut app, move |s| {
            let mut points = points(count);
            if let Some(point) = points.get_mut(11) {
                point.y = f32::INFINITY;
            }
            let mut near = vec![None; 5];
            s.project_points(&points, 0.6, &any(), &mut near);
            let single = points.iter().map(|point| s.project_point(*point, 0.6, &any()));
            (near, single.collect::<Vec<_>>())
        });
        assert_eq!(batch, single);
        let found = batch.iter().flatten().count();
        assert!(count == 0 || found > count / 20 && found < count, "{found} of {count}");
    }
}

#[test]
fn many_shapes_intersect_what_each_intersects() {
    let (mut app, [a, b, c]) = three();
    for count in COUNTS {
        let (batch, single) = ask(&mut app, move |s| {
            let shape = |(number, point): (usize, Vec3)| {
                let shape = match number % 3 {
                    0 => MorphShape::Ball { radius: -1.0 },
                    1 => MorphShape::Ball { radius: 0.3 },
                    _ => MorphShape::Cuboid {
                        half_extents: Vec3::new(2.0, 0.1, 0.2),
                    },
                };
                (shape, Isometry3d::new(point, Quat::from_rotation_y(number as f32)))
            };
            let shapes: Vec<_> = points(count).into_iter().enumerate().map(shape).collect();
            let mut met = vec![Vec::new(); 5];
            s.intersections_with_shapes(&shapes, &any(), &mut met);
            let single = shapes
                .iter()
                .map(|(shape, place)| s.shape_intersections(shape, place.translation.into(), place.rotation, &any()));
            (met, single.collect::<Vec<_>>())
        });
        assert_eq!(batch, single);
        let met: Vec<_> = batch.into_iter().flatten().collect();
        assert!(count == 0 || [a, b, c].iter().all(|cube| met.contains(cube)));
    }
}
