//! A hill that heaves as if something under it breathed: a body to walk on.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec3};

use super::{grid, icosphere};
use crate::clip::WeightAnimation;
use crate::mesh::MorphMesh;

/// Each of the icosahedron's 20 triangles is split into four at every level: 5120.
const LEVEL: u32 = 4;

/// The share of the triangles on the top; the others make the flat underside.
const TOP: f64 = 0.75;
/// The footprint is a disc of radius 1, stretched by this factor along `x`.
const LENGTH: f64 = 1.2;
/// The height of the middle.
const HEIGHT: f64 = 0.34;
/// How far the rim is below `y = 0`.
const SUNK: f64 = 0.01;
/// How much deeper the underside is in the middle.
const THICKNESS: f64 = 0.02;
/// The wave's height, its sideways motion, direction and length.
const WAVE_HEIGHT: f64 = 0.055;
const WAVE_SWAY: f64 = 0.03;
const WAVE_DIRECTION: DVec2 = DVec2::new(0.96, 0.28);
const WAVE_LENGTH: f64 = 1.05;
/// How much a breath lifts the middle.
const BREATH: f64 = 0.07;

/// Seconds per loop of the clip "heave": one breath, two waves.
const LOOP: f32 = 8.0;
const WAVES: usize = 2;
/// Keys for each wave.
const KEYS: usize = 16;

/// A closed, gently sloped mound of 5120 triangles and radius about 1, to be put on the ground at `y = 0`.
///
/// - The targets `crest` and `flank` are a wave that runs along it, a quarter of its length apart. With the cosine and the sine
///   of an angle as weights, the wave moves on as the angle grows, and bodies on it go up, forth, down and back.
/// - `breath` lifts the middle.
///
/// The rim stays where it is. The clip "heave" loops through one breath and two waves in 8 s, with weights of -1 to 1.
pub fn heaving_body() -> MorphMesh {
    let (directions, triangles) = icosphere::icosphere(LEVEL);
    let places: Vec<(DVec2, f64)> = directions.iter().map(|&n| unfold(n)).collect();
    let reference = |moved: &dyn Fn(DVec2) -> DVec3| {
        let place = |&(at, depth): &(DVec2, f64)| {
            // Only the top moves, and least near the rim.
            let top = if depth > 0.0 { 0.0 } else { swell(at) };
            let still = DVec3::new(at.x, top * crown(at) - SUNK - depth, at.y);
            grid::snap((still + top * moved(at)) * DVec3::new(LENGTH, 1.0, 1.0))
        };
        places.iter().map(place).collect::<Vec<Vec3>>()
    };
    let wave = |turn: f64| {
        move |at: DVec2| {
            let (sin, cos) = (TAU * (WAVE_DIRECTION.dot(at) / WAVE_LENGTH - turn)).sin_cos();
            let sway = -WAVE_SWAY * sin * WAVE_DIRECTION;
            DVec3::new(sway.x, WAVE_HEIGHT * cos, sway.y)
        }
    };
    let references = [
        reference(&|_| DVec3::ZERO),
        reference(&wave(0.0)),
        reference(&wave(0.25)),
        reference(&|_| BREATH * DVec3::Y),
    ];
    let name = format!("heaving_body_{}", triangles.len());
    let mut mesh = MorphMesh::from_references(name, &references, triangles, &["crest", "flank", "breath"]);
    let keys = || (0..=WAVES * KEYS).map(|key| key as f32 / (WAVES * KEYS) as f32);
    mesh.animations.push(WeightAnimation {
        name: "heave".into(),
        times: keys().map(|cycle| cycle * LOOP).collect(),
        weights: keys().map(|cycle| heave_weights(cycle).to_vec()).collect(),
        ..WeightAnimation::default()
    });
    mesh
}

/// The weights `[crest, flank, breath]` after `cycle` loops of the clip; only the fraction counts.
fn heave_weights(cycle: f32) -> [f32; 3] {
    let (sin, cos) = (f64::from(cycle) * WAVES as f64 * TAU).sin_cos();
    let breath = 0.5 - 0.5 * (f64::from(cycle) * TAU).cos();
    [cos, sin, breath].map(grid::round6)
}

/// Maps a direction to the disc of radius 1, and to a depth, which is 0 on the top. Seen from above, all triangles on the top
/// have about the same size.
fn unfold(n: DVec3) -> (DVec2, f64) {
    // The share of the sphere above it.
    let above = 0.5 * (1.0 - n.y);
    let around = DVec2::new(n.x, n.z).normalize_or_zero();
    if above <= TOP {
        (around * (above / TOP).sqrt(), 0.0)
    } else {
        let radius = ((1.0 - above) / (1.0 - TOP)).max(0.0).sqrt();
        (around * radius, THICKNESS * (1.0 - radius * radius))
    }
}

/// 1 in the middle and 0 at the rim, with slope 0 at both.
fn swell(at: DVec2) -> f64 {
    let inside = (1.0 - at.length_squared()).max(0.0);
    inside * inside
}

/// The height of the top without a rim: a shoulder, a loin, and a dip between them.
fn crown(at: DVec2) -> f64 {
    HEIGHT + 0.06 * at.x + 0.12 * at.x * at.x - 0.12 * at.y * at.y
}
