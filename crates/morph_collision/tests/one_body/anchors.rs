//! Anchors stay at their point of the surface as the shape and the transform change.

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{Body, Ray, RayQuery, ShapeQuery, SurfaceAnchor, WorldFromModel};

use crate::bodies;
use crate::reference::at;

#[test]
fn an_anchor_from_a_hit_or_a_projection_is_at_its_point_and_follows_it() {
    for case in bodies::generated().into_iter().take(4) {
        let world_from_model = case.world_from_model();
        let mut pose = case.poses().swap_remove(0);
        let center = world_from_model.transform_point(Vec3::ZERO);
        for direction in [DVec3::X, DVec3::new(-1.0, 0.5, 0.2), DVec3::NEG_Z] {
            let ray = Ray::new(center, direction, f64::INFINITY).unwrap();
            let Some(hit) = RayQuery::new().closest(Body::new(&mut pose, &world_from_model), &ray) else {
                continue;
            };
            let closest = ShapeQuery::new()
                .closest_point(
                    Body::new(&mut pose, &world_from_model),
                    center + 10.0 * direction,
                    f64::INFINITY,
                )
                .unwrap()
                .unwrap();
            for (anchor, point) in [
                (SurfaceAnchor::from(&hit), hit.point),
                (SurfaceAnchor::from(&closest), closest.point),
            ] {
                let here = anchor.point(Body::new(&mut pose, &world_from_model)).unwrap();
                assert!(
                    (here - point).length() < 1e-12 * (1.0 + point.length()),
                    "{}",
                    case.name
                );

                let mut moved = case.clone();
                moved.weights.iter_mut().for_each(|weight| *weight = 0.5 - *weight);
                moved.world_from_model =
                    Affine3A::from_rotation_translation(Quat::from_rotation_x(1.0), Vec3::Y) * case.world_from_model;
                let corners = moved.world_triangles()[anchor.triangle as usize];
                let elsewhere = moved.world_from_model();
                pose.set_weights(&moved.weights).unwrap();
                let there = anchor.point(Body::new(&mut pose, &elsewhere)).unwrap();
                assert!((there - at(anchor.barycentrics, &corners)).length() < 1e-12 * (1.0 + there.length()));
                let frame = anchor.frame(Body::new(&mut pose, &elsewhere)).unwrap();
                let [a, b, c] = corners;
                let axes = glam::DMat3::from_cols(frame.tangent, frame.bitangent, frame.normal);
                assert!((axes.transpose() * axes).abs_diff_eq(glam::DMat3::IDENTITY, 1e-12));
                assert!(frame.normal.dot((b - a).cross(c - a)) > 0.0 && frame.tangent.dot(b - a) > 0.0);
                assert!((axes.determinant() - 1.0).abs() < 1e-12);
                assert_eq!(frame.point, there);
                pose.set_weights(&case.weights).unwrap();
            }
        }
    }
}

#[test]
fn an_anchor_on_no_triangle_is_nowhere_and_one_without_area_has_no_frame() {
    let mesh = morph_collision_models::generated::degenerate::zero_area(2, 6);
    let case = bodies::Case::new("zero area", mesh, vec![0.0], Affine3A::IDENTITY);
    let mut pose = case.poses().swap_remove(0);
    let world_from_model = WorldFromModel::IDENTITY;
    let anchor = |triangle| SurfaceAnchor {
        triangle,
        barycentrics: [1.0, 0.0, 0.0],
    };
    assert_eq!(anchor(6).point(Body::new(&mut pose, &world_from_model)), None);
    assert!(anchor(5).point(Body::new(&mut pose, &world_from_model)).is_some());
    assert_eq!(anchor(5).frame(Body::new(&mut pose, &world_from_model)), None);
}
