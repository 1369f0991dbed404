//! When, where and how fast.

use std::cmp::Ordering;
use std::time::Duration;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::motion::{PointMotion, Root, edge_edge, vertex_face};
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::physics::sheet;

use super::judged::first_touch;
use super::make_continuous;
use crate::skins::{add, boned, put, skeleton, spawn_joints, spawn_skinned};
use crate::support::{Edits, Messages, add_mesh, app, cube, set_weight, settle, spawn};

const RADIUS: f32 = 0.2;

fn ball() -> MorphMesh {
    let mut ball = random_blob(9, 1, 0, 0.0);
    ball.positions.iter_mut().for_each(|p| *p *= RADIUS);
    ball
}

/// A mesh at both ends of its way: its triangles and vertices.
struct Way {
    mesh: MorphMesh,
    ends: [Vec<DVec3>; 2],
}

impl Way {
    fn of(mesh: MorphMesh, ends: [(f32, Transform); 2]) -> Self {
        let ends = ends.map(|(weight, place)| {
            let weights = [weight, 0.0];
            let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights[..mesh.targets.len()]);
            world_vertices(&posed, &GlobalTransform::from(place).affine())
        });
        Self { mesh, ends }
    }

    fn motion(&self, vertex: u32) -> PointMotion {
        self.ends
            .each_ref()
            .map(|vertices| vertices[vertex as usize].to_array())
    }

    /// A point of a triangle at a time.
    fn point(&self, triangle: u32, barycentrics: Vec3, time: f64) -> DVec3 {
        let corners = self.mesh.triangles[triangle as usize].map(|corner| {
            let [start, end] = self.ends.each_ref().map(|vertices| vertices[corner as usize]);
            start.lerp(end, time)
        });
        let shares = barycentrics.as_dvec3().to_array();
        (0..3).map(|i| corners[i] * shares[i]).sum()
    }
}

/// All times at which features of two meshes first touch, in exact arithmetic.
fn touches(a: &Way, b: &Way) -> Vec<Root> {
    let mut times = Vec::new();
    let near = |points: &[PointMotion; 4], split: usize| {
        let range = |points: &[PointMotion], axis: usize| {
            let along = points.iter().flatten().map(|point| point[axis]);
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), x| {
                (min.min(x), max.max(x))
            })
        };
        (0..3).all(|axis| {
            let ((min, max), (low, high)) = (range(&points[..split], axis), range(&points[split..], axis));
            min <= high && low <= max
        })
    };
    for (of_vertices, of_faces) in [(a, b), (b, a)] {
        for vertex in 0..of_vertices.mesh.positions.len() as u32 {
            for &[p, q, r] in &of_faces.mesh.triangles {
                let [p, q, r] = [p, q, r].map(|corner| of_faces.motion(corner));
                let points = [of_vertices.motion(vertex), p, q, r];
                if near(&points, 1) {
                    times.extend(vertex_face(points));
                }
            }
        }
    }
    let edges = |way: &Way| {
        let of = |&[p, q, r]: &[u32; 3]| [[p, q], [q, r], [r, p]];
        let all: Vec<[PointMotion; 2]> = way
            .mesh
            .triangles
            .iter()
            .flat_map(of)
            .map(|edge| edge.map(|end| way.motion(end)))
            .collect();
        all
    };
    let edges_b = edges(b);
    for [p, q] in edges(a) {
        for &[r, s] in &edges_b {
            if near(&[p, q, r, s], 2) {
                times.extend(edge_edge([p, q, r, s]));
            }
        }
    }
    times
}

#[test]
fn a_fast_ball_falls_through_a_morphing_sheet_at_30_frames_per_second() {
    let mut app = app();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1) / 30));
    let [of_sheet, of_ball] = [sheet(8), ball()].map(|mesh| (add_mesh(&mut app, &mesh), mesh));
    let sheet = spawn(&mut app, &of_sheet.0, 0.0);
    let ball = spawn(&mut app, &of_ball.0, 0.0);
    make_continuous(&mut app, ball, true);
    // Not level with an edge of the sheet, and turning. The weight moves the sheet by up to 0.2 in a frame.
    let place = |frame: usize| {
        let turn = Quat::from_rotation_x(0.4 * frame as f32);
        Transform::from_xyz(0.3, 5.2 - 2.0 * frame as f32, 0.1 * frame as f32).with_rotation(turn)
    };
    let weight = |frame: usize| 0.5 * (0.4 * frame as f32).sin();
    let pose = |app: &mut App, frame: usize| {
        let weights = vec![weight(frame), 0.0];
        let weights = bevy::mesh::morph::MeshMorphWeights::Value { weights };
        app.insert(sheet, weights);
        put(app, ball, place(frame));
    };
    pose(&mut app, 0);
    settle(&mut app);
    let mut messages = Messages::default();
    messages.read(&app);
    let mut hits = 0;
    for frame in 1..6 {
        pose(&mut app, frame);
        app.update();
        let (starts, ends) = messages.read(&app);
        let frames = [frame - 1, frame];
        let still = Transform::IDENTITY;
        let way_of_sheet = Way::of(of_sheet.1.clone(), frames.map(|frame| (weight(frame), still)));
        let way_of_ball = Way::of(of_ball.1.clone(), frames.map(|frame| (0.0, place(frame))));
        let times = touches(&way_of_sheet, &way_of_ball);
        assert_eq!(
            (starts.is_empty(), ends.is_empty()),
            (times.is_empty(), times.is_empty())
        );
        let Some(start) = starts.first() else { continue };
        hits += 1;
        let impact = start.impact.unwrap();
        // In exact arithmetic, nothing touches before the interval, and something does in it.
        assert!(times.iter().all(|time| time.cmp_f64(impact.earliest) != Ordering::Less));
        assert!(
            times
                .iter()
                .any(|time| time.cmp_f64(impact.latest) != Ordering::Greater)
        );
        assert!(impact.latest - impact.earliest <= 1e-6 && impact.earliest > 0.0 && impact.latest < 1.0);

        let ways = if start.collider1 == sheet {
            [&way_of_sheet, &way_of_ball]
        } else {
            [&way_of_ball, &way_of_sheet]
        };
        let triangles = [impact.triangles.triangle_a, impact.triangles.triangle_b];
        for side in 0..2 {
            let point = ways[side].point(triangles[side], impact.barycentrics[side], impact.earliest);
            assert!(point.distance(impact.point.as_dvec3()) < 1e-5, "{point} of {impact:?}");
        }
        // The ball comes from above, and the sheet moves up or down.
        let out = if start.collider1 == ball { Vec3::Y } else { Vec3::NEG_Y };
        assert!(impact.normal.distance(out) < 1e-4, "{impact:?}");
        let of_sheet = (weight(frame) - weight(frame - 1)) * 30.0;
        let fall = impact.velocity.dot(out);
        // It also turns by 0.4 in a frame, so its surface moves by up to 0.08 besides.
        assert!((fall + 60.0 + of_sheet).abs() < 0.09 * 30.0, "{fall}, {of_sheet}");
    }
    assert_eq!(hits, 1);
}

/// An arm from the shoulder at the origin to `x = 1.3`.
fn arm() -> MorphMesh {
    let mut arm = cube();
    for p in &mut arm.positions {
        *p = *p * Vec3::new(1.2, 0.1, 0.1) + Vec3::X * 0.7;
    }
    arm
}

#[test]
fn a_slap_of_a_skinned_hand_is_felt_by_a_morphing_cheek() {
    let turn = |degrees: f32| Transform::from_rotation(Quat::from_rotation_y(degrees.to_radians()));
    // A cheek in the way of the arm, and it puffs up. The arm's straight way leads closer to the shoulder than a turn does.
    let mut cheek = ball();
    cheek.targets = vec![cheek.positions.clone()];
    cheek.target_names = vec!["puff".into()];
    let at = Transform::from_xyz(0.7, 0.0, 0.0);
    for is_continuous in [true, false] {
        let mut app = app();
        let mesh = add(&mut app, boned(&arm(), |_| 0));
        let joints = spawn_joints(&mut app, [Vec3::ZERO]);
        let skin = skeleton(&mut app, &joints);
        let hand = spawn_skinned(&mut app, &mesh, skin);
        make_continuous(&mut app, hand, is_continuous);
        put(&mut app, joints[0], turn(-50.0));
        let mesh = add_mesh(&mut app, &cheek);
        let face = spawn(&mut app, &mesh, 0.7);
        set_weight(&mut app, face, 0.0);
        settle(&mut app);
        let mut messages = Messages::default();
        messages.read(&app);
        put(&mut app, joints[0], turn(50.0));
        set_weight(&mut app, face, 0.3);
        app.update();
        let (starts, ends) = messages.read(&app);
        if !is_continuous {
            assert!(starts.is_empty() && ends.is_empty());
            continue;
        }
        let ([start], [_]) = (&starts[..], &ends[..]) else {
            panic!("{starts:?} {ends:?}")
        };
        let impact = start.impact.unwrap();
        let of_arm = Way::of(arm(), [-50.0, 50.0].map(|degrees| (0.0, turn(degrees))));
        let of_face = Way::of(cheek.clone(), [(0.0, at), (0.3, at)]);
        let touch = first_touch(
            &of_arm.ends,
            &of_arm.mesh.triangles,
            &of_face.ends,
            &of_face.mesh.triangles,
        )
        .unwrap();
        assert!(
            impact.earliest <= touch.latest && touch.earliest <= impact.latest,
            "{touch:?}, but {impact:?}"
        );
        // The arm swings from +Z to -Z.
        assert!(
            impact.earliest > 0.1 && impact.latest < 0.5 && impact.point.z > 0.0,
            "{impact:?}"
        );
    }
}
