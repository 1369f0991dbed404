//! A real character that plays its clips. Its pushes are checked against vertices that are morphed and skinned here, from the
//! file.

use std::path::{Path, PathBuf};
use std::time::Duration;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::math::Pose;
use bevy_rapier3d::parry::query::PointQuery;
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::player::Player;
use morph_collision_workspace::physics::{self, DT, body};

use crate::log::run_here;
use crate::support::{diagnostics, place, population, run, velocity};

/// A model from outside the repository, if that folder is there.
fn character() -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models/mh_character.glb");
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    path.canonicalize().ok()
}

/// A character, 1.7 high, that plays a clip.
struct Stage {
    app: App,
    player: Player,
}

impl Stage {
    /// `None` if the model is missing.
    fn new(clip: &str) -> Option<Self> {
        Self::in_unit(clip, 1.0)
    }

    /// The same in a world of another length unit.
    fn in_unit(clip: &str, unit: f32) -> Option<Self> {
        let file = character()?;
        let mut app = physics::app_in_unit(file.parent().unwrap(), unit, |_: &mut App| {});
        run_here(&mut app);
        let collider = MorphPhysicsCollider::default();
        let player = Player::spawn(&mut app, &file, clip, 0.1 * unit, collider).expect("the model can be loaded");
        run(&mut app, 5);
        Some(Self { app, player })
    }

    /// The current positions of its vertices, in the file's order.
    fn vertices(&self) -> Vec<DVec3> {
        self.player.vertices(&self.app)
    }

    fn truth(&self) -> TriMesh {
        let vertices = self.vertices().into_iter().map(DVec3::as_vec3).collect();
        TriMesh::new(vertices, self.player.mesh.triangles.clone()).expect("a mesh with triangles")
    }

    /// Plays frames of a clip without any body; returns the positions of all vertices in each.
    fn rehearse(&mut self, frames: usize) -> Vec<Vec<DVec3>> {
        (0..frames)
            .map(|_| {
                run(&mut self.app, 1);
                self.vertices()
            })
            .collect()
    }

    /// Kicks or punches a ball that floats where a vertex is fastest. Returns the velocity of the vertex, and the ball's
    /// afterwards.
    fn hit_a_ball(&mut self, frames: usize, radius: f32, limb: impl Fn(DVec3) -> bool) -> (DVec3, DVec3) {
        let poses = self.rehearse(frames);
        let (mut fastest, mut at) = (0.0, (0, 0));
        for (frame, two) in poses.windows(2).enumerate() {
            for (vertex, (from, to)) in two[0].iter().zip(&two[1]).enumerate() {
                let speed = from.distance(*to) / f64::from(DT);
                // In the middle of a swing and outward, because behind it is the character's own limb.
                if speed > fastest && frame > 4 && limb(*from) {
                    (fastest, at) = (speed, (frame, vertex));
                }
            }
        }
        let (frame, vertex) = at;
        let speed = (poses[frame + 1][vertex] - poses[frame][vertex]) / f64::from(DT);
        // In front of the surface: so far along the vertex's motion that no triangle is near yet.
        let direction = speed.normalize();
        let reach = f64::from(radius) * 1.05;
        let clear = |way: f64| {
            let center = poses[frame][vertex] + direction * way;
            poses[frame].iter().all(|p| p.distance(center) > reach)
        };
        let way = (0..60).map(|i| 0.01 * f64::from(i)).find(|&way| clear(way)).unwrap();
        let center = (poses[frame][vertex] + direction * way).as_vec3();
        // The clip reaches that frame again.
        run(&mut self.app, frame + 1);
        let ball = body(&mut self.app, Collider::ball(radius), center);
        self.app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
        let mut best = Vec3::ZERO;
        for _ in 0..20 {
            run(&mut self.app, 1);
            let now = velocity(&self.app, ball);
            if now.length() > best.length() {
                best = now;
            }
        }
        (speed, best.as_dvec3())
    }
}

#[test]
fn a_waving_hand_throws_a_ball() {
    let Some(mut stage) = Stage::new("wave_and_crouch") else {
        return;
    };
    let (hand, ball) = stage.hit_a_ball(120, 0.08, |_| true);
    println!("the hand at {hand}, the ball at {ball}");
    assert!(hand.length() > 1.0, "{hand}");
    let along = ball.dot(hand.normalize());
    assert!(
        along > 0.6 * hand.length() && along < 2.0 * hand.length(),
        "thrown at {ball} by {hand}"
    );
}

#[test]
fn a_walking_foot_kicks_a_ball() {
    let Some(mut stage) = Stage::new("walk") else {
        return;
    };
    let vertices = stage.vertices();
    let ground = vertices.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let (foot, ball) = stage.hit_a_ball(60, 0.08, |p| p.y < ground + 0.25);
    println!("the foot at {foot}, the ball at {ball}");
    assert!(foot.length() > 0.8, "{foot}");
    let along = ball.dot(foot.normalize());
    assert!(
        along > 0.6 * foot.length() && along < 2.0 * foot.length(),
        "thrown at {ball} by {foot}"
    );
}

#[test]
fn a_tray_on_the_head_goes_down_and_up_as_the_character_crouches() {
    let Some(mut stage) = Stage::new("wave_and_crouch") else {
        return;
    };
    let vertices = stage.vertices();
    let top = vertices.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
    let tray = body(
        &mut stage.app,
        Collider::cuboid(0.6, 0.01, 0.6),
        Vec3::new(top.x as f32, top.y as f32 + 0.012, top.z as f32),
    );
    let upright = LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
    stage.app.world_mut().entity_mut(tray).insert(upright);
    let (mut lowest, mut highest, mut worst, mut deepest) = (f32::INFINITY, f32::NEG_INFINITY, 0.0_f32, 0.0_f32);
    run(&mut stage.app, 10);
    for _ in 0..240 {
        run(&mut stage.app, 1);
        let height = place(&stage.app, tray).y - 0.01;
        (lowest, highest) = (lowest.min(height), highest.max(height));
        // The tray is level, so what counts is the highest vertex.
        let below = stage.vertices().iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max) as f32;
        worst = worst.max(height - below);
        deepest = deepest.max(below - height);
    }
    println!("between {lowest} and {highest}, at most {worst} above and {deepest} below the head's top");
    assert!(highest - lowest > 0.3, "from {lowest} to {highest}");
    assert!(deepest < 1e-2, "it sinks in by {deepest}");
    assert!(worst < 2e-2, "it floats by {worst}");
}

#[test]
fn balls_that_fall_on_it_stay_outside_and_only_what_is_near_them_is_there() {
    let Some(mut stage) = Stage::new("wave_and_crouch") else {
        return;
    };
    run(&mut stage.app, 1);
    let idle = diagnostics(&stage.app);
    assert_eq!((idle.surfaces, idle.moving, idle.parts, idle.blended), (1, 1, 0, 0));
    let radius = 0.04;
    let top = stage.vertices().iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max) as f32;
    let balls: Vec<Entity> = (0..9)
        .map(|i| {
            let (x, z) = (0.1 * (i % 3 - 1) as f32, 0.1 * (i / 3 - 1) as f32);
            body(
                &mut stage.app,
                Collider::ball(radius),
                Vec3::new(x, top + 0.3 + 0.1 * i as f32, z),
            )
        })
        .collect();
    let (mut touched, mut deepest) = (0, 0.0_f32);
    for _ in 0..90 {
        run(&mut stage.app, 1);
        let near = diagnostics(&stage.app);
        assert!(near.parts <= 8 * 9);
        assert_eq!(population(&mut stage.app).1, near.parts as usize);
        let truth = stage.truth();
        for &ball in &balls {
            let distance = truth
                .distance_to_point(&Pose::IDENTITY, place(&stage.app, ball), false)
                .abs();
            touched += usize::from(distance < 1.05 * radius);
            deepest = deepest.max(radius - distance);
        }
    }
    println!("{touched} times touching, at most {deepest} deep");
    assert!(touched > 10, "{touched}");
    assert!(deepest < 0.5 * radius, "a ball is {deepest} inside");
    assert!(
        stage
            .app
            .world()
            .get::<MorphPhysicsCollider>(stage.player.surface)
            .is_some()
    );
}

#[test]
fn a_plate_on_its_head_stays_there_in_every_unit() {
    let frame = 1.0 / 30.0;
    // The file is in decimetres.
    for unit in [0.01, 1.0, 10.0] {
        let Some(mut stage) = Stage::in_unit("walk_and_talk", unit) else {
            return;
        };
        let app = &mut stage.app;
        app.insert_resource(TimestepMode::Fixed { dt: frame, substeps: 1 })
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(frame)));
        run(app, 5);
        let half = Vec3::new(0.6, 0.01, 0.6) * unit;
        let at = stage.player.top(app) + Vec3::Y * 0.012 * unit;
        let plate = body(app, Collider::cuboid(half.x, half.y, half.z), at);
        let upright = LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z;
        app.world_mut().entity_mut(plate).insert(upright);
        let (mut lowest, mut highest) = (f32::MAX, f32::MIN);
        for _ in 0..30 {
            run(app, 3);
            let gap = (place(app, plate).y - half.y - stage.player.top(app).y) / unit;
            (lowest, highest) = (lowest.min(gap), highest.max(gap));
        }
        println!("unit {unit}: gap from {lowest} to {highest}");
        assert!(
            lowest > -0.01 && highest < 0.02,
            "unit {unit}: gap from {lowest} to {highest}"
        );
    }
}
