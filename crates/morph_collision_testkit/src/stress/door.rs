//! Passes bad input to every function that takes numbers.

use std::fmt::Display;
use std::path::Path;

use glam::{Affine3A, DVec3, Quat, Vec3};
use morph_collision::{Aabb, BuildOptions, ConvexRegion, PlacedShape, Ray, Shape, WorldFromModel};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::{Case, skin_door};
use crate::verify::{AnswerSource, Situation, Trees};
use morph_collision_models::scenes::Scene;

/// Number of doors, that is, of functions and arguments to test.
pub const DOORS: u64 = OWN_DOORS + skin_door::DOORS;

/// The doors in this file.
const OWN_DOORS: u64 = 27;

/// Passes bad input to a door, at random places. `trees` are in the case's situation, and stay in it.
///
/// # Errors
/// The bad input was accepted, or the error does not name it.
pub fn knock(door: u64, rng: &mut Pcg64Mcg, case: &Case, trees: &mut Trees) -> Result<(), String> {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][rng.random_range(0..3_usize)];
    // For places where positive infinity is allowed.
    let not_positive = [f32::NAN, f32::NEG_INFINITY][rng.random_range(0..2_usize)];
    let axis = rng.random_range(0..3_usize);
    let with = |value: f32| {
        let mut vector = Vec3::ONE;
        vector[axis] = value;
        vector
    };
    let shape = |shape: Shape| PlacedShape::new(shape, Quat::IDENTITY, Vec3::ZERO);
    let weights = &case.situation.weights[0];
    let target = rng.random_range(0..weights.len().max(1));
    match door % DOORS {
        0 => model(case, |mesh| mesh.positions[7] = with(bad), &["base", "vertex 7"]),
        1 => model(case, |mesh| mesh.positions[7] = with(1e38), &["base", "vertex 7"]),
        2 => {
            let names = format!("target {target}");
            model(case, |mesh| mesh.targets[target][5] = with(bad), &[&names, "vertex 5"])
        }
        3 => model(
            case,
            |mesh| mesh.triangles[3][1] = 999,
            &["triangle 3, corner 1", "999"],
        ),
        4 => model(
            case,
            |mesh| mesh.targets[target].truncate(9),
            &[&format!("target {target}"), "9 vertices"],
        ),
        5 => model(case, |mesh| mesh.triangles.clear(), &["no triangles"]),
        6 | 7 => {
            let mut bad_weights = weights.clone();
            bad_weights[target] = if door % DOORS == 6 { bad } else { 3e38 };
            // If several weights take the sum out of range, the error names one of them. A single weight is
            // named itself.
            refused(trees.poses()[0].set_weights(&bad_weights), &["weight "])
        }
        8 => refused(trees.poses()[0].set_weights(&weights[1..]), &["3 weights", "4 targets"]),
        9 | 10 => {
            let (column, mut entries) = (rng.random_range(0..4_usize), Affine3A::IDENTITY.to_cols_array());
            entries[column * 3 + axis] = bad;
            let place = Affine3A::from_cols_array(&entries);
            let vector = ["x axis", "y axis", "z axis", "translation"][column];
            let names = format!("{vector} of world_from_model: coordinate {axis}");
            if door % DOORS == 9 {
                return refused(WorldFromModel::new(place), &[&names]);
            }
            let situation = Situation {
                places: [place, Affine3A::IDENTITY],
                ..case.situation.clone()
            };
            refused(trees.set(&situation), &[&names])
        }
        11 => refused(
            Ray::new(with(bad).as_dvec3(), DVec3::X, 1.0),
            &["origin", &format!("coordinate {axis}")],
        ),
        12 => refused(Ray::new(DVec3::ZERO, with(bad).as_dvec3(), 1.0), &["direction"]),
        13 => refused(Ray::new(DVec3::ZERO, DVec3::X, not_positive.into()), &["max_t"]),
        14 => refused(
            PlacedShape::ball(with(bad).as_dvec3(), 1.0),
            &["center", &format!("coordinate {axis}")],
        ),
        15 => refused(PlacedShape::ball(DVec3::ZERO, bad.into()), &["radius"]),
        16 => refused(
            ConvexRegion::from_half_spaces(&[(with(bad).as_dvec3(), 1.0)]),
            &["normal"],
        ),
        17 => refused(ConvexRegion::from_half_spaces(&[(DVec3::X, bad.into())]), &["offset"]),
        18 => refused(
            ConvexRegion::from_aabb(&Aabb {
                min: with(bad),
                max: Vec3::ONE,
            }),
            &["min"],
        ),
        19 => refused(shape(Shape::Ball { radius: bad }), &["radius"]),
        20 => {
            let capsule = Shape::Capsule {
                half_length: bad,
                radius: 1.0,
            };
            refused(shape(capsule), &["half_length"])
        }
        21 => refused(
            shape(Shape::Cuboid {
                half_extents: with(bad),
            }),
            &["half_extents"],
        ),
        22 => refused(shape(Shape::HalfSpace { normal: with(bad) }), &["normal"]),
        23 => {
            let capsule = Shape::Capsule {
                half_length: 1.0,
                radius: bad,
            };
            refused(shape(capsule), &["radius"])
        }
        24 => {
            let rotation = Quat::from_xyzw(0.0, bad, 0.0, 1.0);
            let ball = Shape::Ball { radius: 1.0 };
            refused(PlacedShape::new(ball.clone(), rotation, Vec3::ONE), &["rotation"])?;
            refused(PlacedShape::new(ball, Quat::IDENTITY, with(bad)), &["translation"])
        }
        25 => refused(BuildOptions::default().with_leaf_size(0), &["leaf_size", "0"]),
        26 => {
            let scene = |weight: &str| {
                let json = format!(
                    "{{\"bodies\": [{{\"model\": \"a.glb\"}}],\n\"frames\": [[{{\"weights\": [0, {weight}]}}]]}}"
                );
                refused(
                    Scene::parse(json.as_bytes(), Path::new("scene.json")),
                    &["scene.json", "line 2"],
                )
            };
            ["NaN", "Infinity", "1e39", "-1e999"].into_iter().try_for_each(scene)
        }
        door => skin_door::knock(door - OWN_DOORS, rng, bad),
    }
}

/// Checks that the mesh with something broken in it does not become a model.
fn model(
    case: &Case,
    spoil: impl FnOnce(&mut morph_collision_models::mesh::MorphMesh),
    names: &[&str],
) -> Result<(), String> {
    let mut mesh = case.meshes[0].clone();
    spoil(&mut mesh);
    refused(mesh.to_model(), names)
}

pub(super) fn refused<T, E: Display>(result: Result<T, E>, names: &[&str]) -> Result<(), String> {
    let Err(error) = result else {
        return Err(format!("accepted what is bad in {}", names.join(", ")));
    };
    let message = error.to_string();
    match names.iter().find(|name| !message.contains(**name)) {
        Some(name) => Err(format!("\"{message}\" does not name \"{name}\"")),
        None => Ok(()),
    }
}
