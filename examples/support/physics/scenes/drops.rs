//! Bodies that fall into a waving bowl.

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::sheet;

/// The kind of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ball.
    Ball,
    /// A cuboid.
    Cuboid,
    /// An upright capsule.
    Capsule,
}

/// A body that is about to fall.
#[derive(Clone, Copy, Debug)]
pub struct Drop {
    /// Its shape.
    pub kind: Kind,
    /// Radius of a ball, half the longest edge of a cuboid, half the segment of a capsule.
    pub size: f32,
    /// Its position.
    pub at: Vec3,
    /// Its velocity.
    pub linear: Vec3,
    /// Its angular velocity.
    pub angular: Vec3,
}

impl Drop {
    /// What [`Engine::body`](super::engine::Engine::body) needs of its size.
    #[must_use]
    pub fn half(&self) -> Vec3 {
        match self.kind {
            Kind::Ball | Kind::Cuboid => self.size * Vec3::new(1.0, 0.7, 0.5),
            Kind::Capsule => self.size * Vec3::new(1.0, 0.5, 0.5),
        }
    }
}

/// A waving bowl of 24 by 24.
#[must_use]
pub fn bowl() -> MorphMesh {
    let mut mesh = sheet(48);
    for vertex in &mut mesh.positions {
        *vertex *= 3.0;
        vertex.y = 0.03 * (vertex.x * vertex.x + vertex.z * vertex.z);
    }
    let wave = |wave: &Wave| mesh.positions.iter().map(|&p| Vec3::Y * height(wave, p)).collect();
    mesh.targets = WAVES.iter().map(wave).collect();
    mesh
}

/// Direction and phase of a wave.
type Wave = (Vec2, f32);

const WAVES: [Wave; 2] = [(Vec2::new(1.0, 0.2), 0.0), (Vec2::new(-0.3, 0.9), 1.0)];

fn height((direction, phase): &Wave, at: Vec3) -> f32 {
    0.3 * (direction.dot(at.xz()) + phase).sin()
}

/// The bowl's weights at a time.
#[must_use]
pub fn waves(time: f32) -> [f32; 2] {
    [(3.0 * time).sin(), (2.3 * time).cos()]
}

/// How far a point is above the bowl, roughly.
#[must_use]
pub fn above(at: Vec3, weights: &[f32; 2]) -> f32 {
    let waves: f32 = WAVES
        .iter()
        .zip(weights)
        .map(|(wave, weight)| weight * height(wave, at))
        .sum();
    at.y - 0.03 * at.xz().length_squared() - waves
}

/// The bodies of a batch, at some multiple of their usual speed; the same batch number gives the same bodies.
#[must_use]
pub fn batch_of_drops(batch: u64, count: u64, speed: f32) -> Vec<Drop> {
    let mut rng = Pcg64Mcg::seed_from_u64(batch);
    let kinds = [Kind::Ball, Kind::Cuboid, Kind::Capsule];
    let drop = |kind| {
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        Drop {
            at: Vec3::new(within(6.0), 5.0 + within(2.0), within(6.0)),
            // The speed after a fall of some metres.
            linear: speed * Vec3::new(within(3.0), -6.0 + within(4.0), within(3.0)),
            angular: Vec3::new(within(5.0), within(5.0), within(5.0)),
            size: 0.25 + within(0.15),
            kind,
        }
    };
    kinds.into_iter().cycle().take(count as usize).map(drop).collect()
}

/// How many of the fallen bodies fell through, and how many left over the rim.
pub fn fates(places: impl Iterator<Item = Vec3>) -> (u64, u64) {
    places.fold((0, 0), |(through, left), at| {
        if at.x.abs().max(at.z.abs()) > 11.5 {
            (through, left + 1)
        } else {
            (through + u64::from(at.y < -1.0), left)
        }
    })
}
